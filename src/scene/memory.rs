//! What memory there is: whether a scene of so many triangles fits, asked before it is made, and how much
//! of it may be spent on what is prepared for the scene.

use std::fs;

use glam::{Vec3, Vec3A};

use super::DraftTriangle;

/// Bytes that one triangle takes while a draft becomes a scene: the draft, the padded corners, the
/// normals, and as much again for what a backend builds over it.
const BYTES_PER_TRIANGLE: u64 =
    2 * (size_of::<DraftTriangle>() + size_of::<[Vec3A; 3]>() + size_of::<[Vec3; 3]>()) as u64;

/// What a machine that does not say how much memory it has is taken to have free.
const UNKNOWN_MEMORY: u64 = 8 << 30;

/// Says what is wrong with so many triangles, if they will not fit.
pub(super) fn check(triangles: u64) -> Result<(), String> {
    within(triangles, available())
}

fn within(triangles: u64, available: u64) -> Result<(), String> {
    if triangles > u64::from(u32::MAX) {
        return Err(format!("{triangles} triangles are too many; umbra holds {}", u32::MAX));
    }
    let needed = triangles * BYTES_PER_TRIANGLE;
    if needed <= available {
        return Ok(());
    }
    let gibibytes = |bytes: u64| bytes as f64 / f64::from(1 << 30);
    Err(format!(
        "{triangles} triangles need about {:.1} GiB and {:.1} GiB are free",
        gibibytes(needed),
        gibibytes(available)
    ))
}

/// Bytes that can be had: what the system has to give, or less where a control group limits it.
fn available() -> u64 {
    let free = system("MemAvailable:").unwrap_or(UNKNOWN_MEMORY);
    group_limit().map_or(free, |limit| {
        let used = number("/sys/fs/cgroup/memory.current").unwrap_or(0);
        let parts = fs::read_to_string("/sys/fs/cgroup/memory.stat").unwrap_or_default();
        free.min(left(limit, used, &parts))
    })
}

/// What a control group leaves of its limit. Among what it uses are files that were read once: the system keeps them only as long
/// as nobody wants their room.
fn left(limit: u64, used: u64, parts: &str) -> u64 {
    let given_back = number_after(parts, "inactive_file ").unwrap_or(0);
    limit.saturating_sub(used.saturating_sub(given_back))
}

/// Bytes that prepared structures may take where nothing else is asked for: a quarter of the machine's, or
/// of what a control group leaves of it.
#[must_use]
pub fn default_budget() -> u64 {
    let all = system("MemTotal:").unwrap_or(UNKNOWN_MEMORY);
    group_limit().map_or(all, |group| group.min(all)) / 4
}

/// Bytes that the system gives under this name.
fn system(name: &str) -> Option<u64> {
    let text = fs::read_to_string("/proc/meminfo").ok()?;
    number_after(&text, name).map(|kibibytes| kibibytes << 10)
}

/// The number that follows a name at the beginning of a line.
fn number_after(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace().next()?.parse().ok()
}

/// Bytes that the control group may use, if there is a limit.
fn group_limit() -> Option<u64> {
    number("/sys/fs/cgroup/memory.max")
}

fn number(path: &str) -> Option<u64> {
    fs::read_to_string(path).ok()?.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_that_does_not_fit_is_refused_with_the_estimate() {
        assert!(within(1000, 1 << 30).is_ok());
        let refusal = within(100_000_000, 1 << 30).unwrap_err();
        assert!(refusal.contains("100000000 triangles") && refusal.contains("GiB"), "{refusal}");
        assert!(within(1 << 32, u64::MAX).is_err());
    }

    #[test]
    fn files_that_were_read_once_take_no_room_from_a_scene() {
        let parts = "anon 10\nfile 80\ninactive_anon 3\ninactive_file 70\nactive_file 10\n";
        assert_eq!(left(100, 90, parts), 80);
        assert_eq!(left(100, 90, ""), 10);
        assert_eq!(left(100, 120, "inactive_file 5"), 0);
        assert_eq!(left(100, 60, "inactive_file 70"), 100);
    }
}
