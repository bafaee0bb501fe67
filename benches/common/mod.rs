//! What several benches need: the real scenes, lights to add, the queries of a picture.
#![allow(dead_code, reason = "each bench uses a part of it")]

pub mod by_place;
pub mod contest;
pub mod lights;
pub mod runs;

use std::path::{Path, PathBuf};

use umbra::scene::default_budget;
use umbra::shadow::{Combination, Plan};

/// The ten of them, the simplest first.
pub const REAL_SCENES: [&str; 10] = [
    "CornellBox-Original.obj",
    "bunny.obj",
    "office.obj",
    "staircase.glb",
    "sponza.glb",
    "satellite.glb",
    "jungle.glb",
    "delft.obj",
    "tower_bridge.glb",
    "bigtujunga.glb",
];

/// The folder that they are looked for in: `UMBRA_SCENES`, or `../shared/scenes`.
pub fn folder() -> PathBuf {
    std::env::var_os("UMBRA_SCENES").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes"),
        PathBuf::from,
    )
}

/// A method with all the memory that it wants, within a quarter of the machine; else it takes no more than Embree would.
pub fn roomy(combination: Combination) -> Plan {
    Plan { budget: Some(default_budget()), ..combination.into() }
}

/// Where a scene is that may be given by the name of a real one, as a file, or by a built-in name.
pub fn path_of(name: &str) -> PathBuf {
    let real = folder().join(name);
    if real.is_file() { real } else { PathBuf::from(name) }
}

/// The middle one; of an even number the upper of the two.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Nanoseconds in two digits or more.
pub fn short(nanoseconds: f64) -> String {
    if nanoseconds < 10.0 { format!("{nanoseconds:.1}") } else { format!("{nanoseconds:.0}") }
}
