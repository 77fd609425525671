//! Memory of the process, read from `/proc`; NaN where the system does not tell.

/// Peak resident memory, MB.
pub fn peak_mb() -> f64 {
    status_mb("VmHWM:")
}

/// Present resident memory, MB.
pub fn resident_mb() -> f64 {
    status_mb("VmRSS:")
}

fn status_mb(key: &str) -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix(key));
    line.and_then(|rest| rest.split_whitespace().next()?.parse::<f64>().ok()).map_or(f64::NAN, |kib| kib * 1024.0 / 1e6)
}
