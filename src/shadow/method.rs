//! From names to memories.

use std::fmt;

use clap::ValueEnum;

/// The memories that stand before a backend, and none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, ValueEnum)]
pub enum Method {
    /// The backend alone.
    #[default]
    Trace,
    /// Each light tests its last occluder first (Haines & Greenberg 1986).
    ObjectCache,
    /// Then the voxel it was in (Pearce & Jevans 1991).
    VoxelCache,
    /// A voxel cache for each path of reflections and refractions (Pearce & Jevans 1991).
    CacheTree,
    /// The same, passed over by rays far from the one that was blocked.
    CacheTreeTolerance,
    /// A voxel cache that keeps no occluder, but moves it to the front of its voxel (Woo).
    Woo,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Trace,
        Self::ObjectCache,
        Self::VoxelCache,
        Self::CacheTree,
        Self::CacheTreeTolerance,
        Self::Woo,
    ];

    /// The name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Trace => "trace",
            Self::ObjectCache => "object-cache",
            Self::VoxelCache => "voxel-cache",
            Self::CacheTree => "cache-tree",
            Self::CacheTreeTolerance => "cache-tree-tolerance",
            Self::Woo => "woo",
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
