//! Memory that this process has taken and may still take, as Linux tells it.

use std::fs;
use std::path::Path;

/// Peak resident memory of this process, MB; NaN where the system does not tell.
pub fn peak_mb() -> f64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    kib(&status, "VmHWM:").map_or(f64::NAN, |bytes| bytes / 1e6)
}

/// Bytes free for this process; `None` where the system does not tell: the least of what the machine has, what every control group around the process leaves it, and what
/// `ulimit -v` leaves it.
pub fn free_bytes() -> Option<f64> {
    let read = |path: &str| fs::read_to_string(path).unwrap_or_default();
    let (memory, limits, status) = (read("/proc/meminfo"), read("/proc/self/limits"), read("/proc/self/status"));
    let of_groups = groups(&read("/proc/self/cgroup")).into_iter().map(|folder| {
        let file = |name: &str| fs::read_to_string(Path::new(&folder).join(name)).unwrap_or_default();
        of_group(&file("memory.max"), &file("memory.current"), &file("memory.stat"))
    });
    let all = of_groups.chain([of_machine(&memory), of_process(&limits, &status)]);
    all.flatten().min_by(f64::total_cmp)
}

/// `MemAvailable` of `/proc/meminfo`.
pub fn of_machine(meminfo: &str) -> Option<f64> {
    kib(meminfo, "MemAvailable:")
}

/// What a control group leaves: its `memory.max` less `memory.current`, of which caches of files can be given back.
pub fn of_group(max: &str, current: &str, stat: &str) -> Option<f64> {
    let [max, current] = [max, current].map(|text| text.trim().parse::<f64>().ok());
    let caches = stat.lines().find_map(|line| line.strip_prefix("inactive_file ")?.trim().parse::<f64>().ok());
    Some((max? - current.unwrap_or(0.0) + caches.unwrap_or(0.0)).max(0.0))
}

/// What `ulimit -v` leaves: `Max address space` of `/proc/self/limits` less `VmSize` of `/proc/self/status`.
pub fn of_process(limits: &str, status: &str) -> Option<f64> {
    let most =
        limits.lines().find_map(|line| line.strip_prefix("Max address space")?.split_whitespace().next()?.parse::<f64>().ok());
    Some((most? - kib(status, "VmSize:").unwrap_or(0.0)).max(0.0))
}

/// Folders of the control group of a process and of all around it, of a `/proc/self/cgroup` of version 2.
fn groups(cgroup: &str) -> Vec<String> {
    let own = cgroup.lines().find_map(|line| line.strip_prefix("0::")).unwrap_or("/");
    let parts: Vec<&str> = own.split('/').filter(|part| !part.is_empty()).collect();
    (0..=parts.len()).map(|count| format!("/sys/fs/cgroup/{}", parts[..count].join("/"))).collect()
}

fn kib(text: &str, key: &str) -> Option<f64> {
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    line.split_whitespace().next()?.parse::<f64>().ok().map(|kib| 1024.0 * kib)
}
