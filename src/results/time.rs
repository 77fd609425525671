//! Moments as results write them.

/// Now, RFC 3339 in UTC to the second: `2026-11-25T19:01:55Z`.
pub fn now() -> String {
    humantime::format_rfc3339_seconds(std::time::SystemTime::now()).to_string()
}
