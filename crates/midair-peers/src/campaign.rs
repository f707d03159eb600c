//! How many random set-ups a test looks at: few in every run, hundreds where `cargo xtask campaign` asks for them.

/// The environment variable that says how many.
pub const COUNT: &str = "MIDAIR_CAMPAIGN";

/// The environment variable that says the first one's number: the same number is the same set-up.
pub const FIRST: &str = "MIDAIR_CAMPAIGN_FIRST";

/// What one of the two says; `None` where it is not set.
///
/// # Panics
/// Where it is no number.
pub fn number(name: &str) -> Option<u64> {
    let value = std::env::var(name).ok()?;
    Some(value.parse().unwrap_or_else(|_| panic!("{name} is not a number: {value}")))
}
