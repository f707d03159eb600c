//! Means for people.

use midair::evaluate::paper::{PUBLISHED_DISPLACEMENT, PUBLISHED_QUALITY, Scores};

/// Means for people, the paper's beside them if it is the paper's set-ups.
pub fn lines(told: &serde_json::Value, paper: bool) -> String {
    let surface = |value: &serde_json::Value| value["surface"].as_str().unwrap_or("").to_owned();
    let beside = if paper { "paper: with, without" } else { "" };
    let mut lines = format!(
        "{:24}{:>14}{:>10}{beside:>22}\n",
        "mean displacement, px", "compensated", "without"
    );
    for one in told["shapes"].as_array().into_iter().flatten() {
        let name = surface(one);
        let published = PUBLISHED_DISPLACEMENT.iter().find(|p| name.starts_with(p.surface));
        let published = published.filter(|_| paper);
        let paper =
            published.map(|p| format!("{:.2}, {:.2}", p.with, p.without)).unwrap_or_default();
        let pair = |of: &serde_json::Value| (show(&of["with"], 2), show(&of["without"], 2));
        let count = |of: &serde_json::Value| of.as_u64().unwrap_or(0);
        let azimuths = one["views"].as_array().map_or(0, Vec::len);
        let (with, without) = pair(&one["mean"]);
        lines += &format!(
            "  {name:22}{with:>14}{without:>10}{paper:>22}  calculated, {azimuths} azimuths, the same {} intersections at each\n",
            count(&one["intersections"])
        );
        let measured = &one["measured"];
        let ((with, without), there) = (pair(&measured["mean"]), pair(&measured["exact_there"]));
        lines += &format!(
            "  {:22}{with:>14}{without:>10}{:>22}  measured, {} of {azimuths} azimuths, the same {} intersections at each (calculated for them: {}, {})\n",
            "",
            "",
            count(&measured["azimuths"]),
            count(&measured["intersections"]),
            there.0,
            there.1
        );
    }
    for (key, title) in [
        ("ssim", "SSIM"),
        ("lpips", "LPIPS (less is better)"),
        ("blurred_ssim", "SSIM after a blur"),
    ] {
        lines += &format!("{title:24}{:>14}{:>10}{:>22}{:>14}\n", "", "", "", "noise alone");
        for one in told["means"].as_array().into_iter().flatten() {
            let name = surface(one);
            let of = &one["mean"][key];
            let published = PUBLISHED_QUALITY.iter().find(|p| name.starts_with(p.surface));
            let paper = published.filter(|_| paper).map(|p| {
                let pick = |s: &Scores| match key {
                    "ssim" => s.ssim,
                    "lpips" => s.lpips.unwrap_or(f64::NAN),
                    _ => s.blurred_ssim,
                };
                format!("{:.3}, {:.3}", pick(&p.with), pick(&p.without))
            });
            let [with, without, floor] =
                ["with", "without", "floor"].map(|condition| show(&of[condition], 3));
            let paper = paper.unwrap_or_default();
            lines += &format!("  {name:22}{with:>14}{without:>10}{paper:>22}{floor:>14}\n");
        }
    }
    lines + &ways(told)
}

/// The ways to fill the display, if they were compared.
fn ways(told: &serde_json::Value) -> String {
    let mut lines = String::new();
    for one in told["ways"].as_array().into_iter().flatten() {
        let name = format!("ways, {}", one["surface"].as_str().unwrap_or(""));
        lines += &format!("{name:38}{:>14}{:>10}{:>10}\n", "displaced, px", "SSIM", "time, s");
        for way in one["ways"].as_array().into_iter().flatten() {
            let name = way["name"].as_str().unwrap_or("");
            let [displaced, ssim, seconds] = [("displacement", 3), ("ssim", 4), ("seconds", 3)]
                .map(|(key, decimals)| show(&way[key], decimals));
            lines += &format!("  {name:36}{displaced:>14}{ssim:>10}{seconds:>10}\n");
        }
    }
    lines
}

fn show(value: &serde_json::Value, decimals: usize) -> String {
    match value.as_f64() {
        Some(value) => format!("{value:.decimals$}"),
        None => "-".to_owned(),
    }
}
