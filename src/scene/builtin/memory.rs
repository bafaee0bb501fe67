//! Whether a scene of so many triangles fits into memory, asked before it is made.

use std::fs;

use crate::geometry::Triangle;
use crate::scene::{DraftTriangle, SceneError};

/// Bytes that one triangle takes while a draft becomes a scene: the draft, the checked copy that is
/// sorted (with room for the sort), and the same again for what a backend builds over it.
const BYTES_PER_TRIANGLE: u64 = (size_of::<DraftTriangle>()
    + 3 * (size_of::<Triangle>() + size_of::<DraftTriangle>()) / 2
    + 2 * size_of::<Triangle>()) as u64;

/// What a machine that does not say how much memory it has is taken to have free.
const UNKNOWN_MEMORY: u64 = 8 << 30;

/// Refuses what will not fit.
pub(super) fn check(name: &str, triangles: u64) -> Result<(), SceneError> {
    within(name, triangles, available())
}

fn within(name: &str, triangles: u64, available: u64) -> Result<(), SceneError> {
    let needed = triangles.saturating_mul(BYTES_PER_TRIANGLE);
    if triangles <= u64::from(u32::MAX) && needed <= available {
        return Ok(());
    }
    let gibibytes = |bytes: u64| bytes as f64 / f64::from(1 << 30);
    Err(SceneError::TooLarge {
        name: name.to_owned(),
        problem: format!(
            "{triangles} triangles need about {:.1} GiB and {:.1} GiB are free; take a smaller tessellation",
            gibibytes(needed),
            gibibytes(available)
        ),
    })
}

/// Bytes that can be had: what the system has to give, or less where a control group limits it.
fn available() -> u64 {
    let free = fs::read_to_string("/proc/meminfo").ok().and_then(|text| {
        let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
        line.split_whitespace().next()?.parse::<u64>().ok().map(|kibibytes| kibibytes << 10)
    });
    let number = |path: &str| fs::read_to_string(path).ok()?.trim().parse::<u64>().ok();
    let group = number("/sys/fs/cgroup/memory.max")
        .map(|limit| limit.saturating_sub(number("/sys/fs/cgroup/memory.current").unwrap_or(0)));
    let free = free.unwrap_or(UNKNOWN_MEMORY);
    group.map_or(free, |group| group.min(free))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_that_does_not_fit_is_refused_with_the_estimate() {
        assert!(within("drum", 1000, 1 << 30).is_ok());
        let refusal = within("drum", 100_000_000, 1 << 30).unwrap_err().to_string();
        assert!(refusal.contains("100000000 triangles") && refusal.contains("GiB"), "{refusal}");
    }
}
