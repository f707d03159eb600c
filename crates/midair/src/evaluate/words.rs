//! Numbers as people read them.

/// A share as a percentage that does not round a few away or to all.
pub fn percent(share: f64) -> String {
    let value = 100.0 * share;
    if share > 0.0 && value < 0.05 {
        "< 0.1 %".to_owned()
    } else if share < 1.0 && value >= 99.95 {
        "> 99.9 %".to_owned()
    } else {
        format!("{value:.1} %")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentages_do_not_hide_the_few() {
        let shown = [0.0, 1e-6, 0.5, 1.0 - 1e-6, 1.0].map(percent);
        assert_eq!(shown, ["0.0 %", "< 0.1 %", "50.0 %", "> 99.9 %", "100.0 %"]);
    }
}
