//! From names to verdicts.

use std::fmt;

use serde::Serialize;

use super::Verdict;
use super::shadow_polygons::ShadowPolygons;
use super::shaft::Shafts;
use super::stock::Stock;
use super::voxel_occlusion::VoxelOcclusion;

/// The verdicts, in the order in which they are asked: cheap ones first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum VerdictKind {
    /// Queries to one light answered together (Haines & Wallace 1991).
    Shaft,
    /// A cube of candidate lists around each light (Haines & Greenberg 1986).
    LightBuffer,
    /// Voxels that all light reaches, or none (Woo & Amanatides 1990).
    VoxelOcclusion,
    /// Shadow volumes, counted (Crow 1977; Eo & Kyung 1989).
    ShadowPolygons,
}

impl VerdictKind {
    /// How many there are.
    pub const COUNT: usize = 4;

    /// All of them.
    pub const ALL: [Self; Self::COUNT] =
        [Self::Shaft, Self::LightBuffer, Self::VoxelOcclusion, Self::ShadowPolygons];

    /// Its place in [`Self::ALL`].
    #[must_use]
    pub fn index(self) -> usize {
        self as usize
    }

    /// The name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Shaft => "shaft",
            Self::LightBuffer => "light-buffer",
            Self::VoxelOcclusion => "voxel-occlusion",
            Self::ShadowPolygons => "shadow-polygons",
        }
    }

    /// Makes it ready for a scene before a backend, within the memory that is left.
    pub(super) fn prepare(self, stock: &Stock<'_>) -> Box<dyn Verdict> {
        let Stock { scene, budget, .. } = stock;
        match self {
            Self::Shaft => Box::new(Shafts::new(stock)),
            Self::LightBuffer => Box::new(stock.light_buffer()),
            Self::VoxelOcclusion => Box::new(VoxelOcclusion::new(scene, budget)),
            Self::ShadowPolygons => Box::new(ShadowPolygons::new(scene, budget)),
        }
    }
}

impl fmt::Display for VerdictKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
