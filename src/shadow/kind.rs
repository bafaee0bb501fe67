//! From names to verdicts.

use std::fmt;
use std::sync::Arc;

use serde::Serialize;

use super::light_buffer::LightBuffer;
use super::shadow_polygons::ShadowPolygons;
use super::shaft::Shafts;
use super::voxel_occlusion::VoxelOcclusion;
use super::{Budget, Verdict};
use crate::occlusion::Occlusion;
use crate::scene::Scene;

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
    pub(super) fn prepare<'a>(
        self,
        scene: &Scene,
        _backend: &'a dyn Occlusion,
        budget: &Arc<Budget>,
    ) -> Box<dyn Verdict + 'a> {
        match self {
            Self::Shaft => Box::new(Shafts::new(scene, budget)),
            Self::LightBuffer => Box::new(LightBuffer::new(scene, budget.clone())),
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
