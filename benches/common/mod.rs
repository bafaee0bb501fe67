//! Where the ten real scenes are.
#![allow(dead_code, reason = "each bench uses a part of it")]

use std::path::{Path, PathBuf};

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
