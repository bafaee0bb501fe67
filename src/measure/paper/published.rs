//! What the paper's Table 2 says.

use serde::Serialize;

/// A column of Table 2. Rates and gains in per cent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Published {
    /// The built-in scene that rebuilds it.
    pub scene: &'static str,
    /// The paper's name for it.
    pub title: &'static str,
    /// Triangles.
    pub triangles: u64,
    /// Lights that cast shadows.
    pub lights: u64,
    /// Rays of all kinds.
    pub rays: u64,
    /// Of the queries for which the remembered object was tested, those that it blocked.
    pub object_rate: f64,
    /// Of the queries for which the object failed and the voxel was tested, those that it blocked.
    pub voxel_rate: f64,
    /// Fewer cycles of the entire process with a voxel cache than with an object cache.
    pub voxel_gain: f64,
    /// Fewer cycles of the entire process with a cache tree than with a voxel cache.
    pub tree_gain: f64,
}

/// Table 2.
pub const TABLE: [Published; 4] = [
    Published {
        scene: "jittered-sparse",
        title: "64,000 jittered polygons (0.2) (sparse)",
        triangles: 551_408,
        lights: 15,
        rays: 11_324_318,
        object_rate: 50.7,
        voxel_rate: 23.4,
        voxel_gain: 1.04,
        tree_gain: -0.003,
    },
    Published {
        scene: "jittered-dense",
        title: "64,000 jittered polygons (1.0) (dense)",
        triangles: 551_408,
        lights: 15,
        rays: 8_427_904,
        object_rate: 90.9,
        voxel_rate: 39.3,
        voxel_gain: 3.6,
        tree_gain: -0.000_02,
    },
    Published {
        scene: "drum",
        title: "Spanky the Drum",
        triangles: 59_692,
        lights: 6,
        rays: 2_230_193,
        object_rate: 47.8,
        voxel_rate: 76.9,
        voxel_gain: 5.53,
        tree_gain: 2.7,
    },
    Published {
        scene: "chair-room",
        title: "Chair Room",
        triangles: 40_937,
        lights: 4,
        rays: 19_269_028,
        object_rate: 2.5,
        voxel_rate: 2.76,
        voxel_gain: 3.62,
        tree_gain: 7.27,
    },
];

/// What §10 says of a tree that goes so many bounces deep.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Storage {
    /// Bounces.
    pub bounces: u32,
    /// Nodes of the whole tree.
    pub nodes: usize,
    /// Their bytes here.
    pub bytes: usize,
    /// What the paper says that they take.
    pub claim: &'static str,
}

/// §10: trees of 5 and of 10 bounces, with nodes of so many bytes.
#[must_use]
pub fn storage(node_bytes: usize) -> [Storage; 2] {
    [(5, "less than 1 kilobyte"), (10, "32 kilobytes")].map(|(bounces, claim)| {
        let nodes = (2 << bounces) - 1;
        Storage { bounces, nodes, bytes: nodes * node_bytes, claim }
    })
}
