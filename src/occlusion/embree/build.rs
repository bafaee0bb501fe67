//! From triangles and options to a scene in Embree.

use std::num::NonZeroU32;
use std::ops::Range;
use std::sync::Arc;

use embree_ffi::{BuildQuality, Device, DeviceConfig, SceneBuilder, SceneOptions};

use super::{Cells, Embree, OPAQUE, TRANSPARENT};
use crate::geometry::lanes::Arithmetic;
use crate::geometry::{TriangleId, Triangles};
use crate::occlusion::embree_bounds::at_least;
use crate::occlusion::transparent::is_transparent_apart;

pub use embree_ffi::Isa;

/// How much work goes into Embree's structure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, clap::ValueEnum)]
pub enum Quality {
    /// Along Morton's curve, quickly built.
    Low,
    /// Surface area heuristic.
    #[default]
    Medium,
    /// Spatial splits, in default mode only.
    High,
}

/// Rays that Embree is asked about at once, where many are to be answered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum PacketWidth {
    /// `rtcOccluded1`: what Embree's bounds are stated for.
    #[default]
    One,
    /// `rtcOccluded4`
    Four,
    /// `rtcOccluded8`
    Eight,
    /// `rtcOccluded16`
    Sixteen,
}

/// How Embree is to be used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EmbreeOptions {
    /// Build quality.
    pub quality: Quality,
    /// Kernels to use; the best of this CPU if none are named.
    pub isa: Option<Isa>,
    /// Packets for [`Occlusion::occluded_many`](crate::occlusion::Occlusion::occluded_many).
    pub width: PacketWidth,
    /// Whether packets are traced as coherent.
    pub coherent: bool,
}

impl EmbreeOptions {
    /// The arithmetic of the kernels.
    #[must_use]
    pub fn arithmetic(&self) -> Arithmetic {
        match self.isa {
            None => Arithmetic::of_this_cpu(),
            Some(Isa::Sse2 | Isa::Sse42 | Isa::Avx) => Arithmetic::Sse,
            Some(Isa::Avx2) => Arithmetic::Avx2,
            Some(Isa::Avx512) => Arithmetic::Avx512,
        }
    }
}

impl Embree {
    /// Builds Embree's structure over the triangles, which it reads where they lie, with the threads of the current pool.
    ///
    /// # Errors
    /// If Embree cannot be loaded, the CPU lacks the kernels, or memory does not suffice.
    pub fn new(
        triangles: Arc<Triangles>,
        robust: bool,
        options: EmbreeOptions,
    ) -> Result<Self, embree_ffi::Error> {
        let mut config = DeviceConfig::default().threads(rayon::current_num_threads());
        if let Some(isa) = options.isa {
            config = config.isa(isa);
        }
        let device = Device::new(config)?;
        let quality = match options.quality {
            Quality::Low => BuildQuality::Low,
            Quality::Medium => BuildQuality::Medium,
            Quality::High => BuildQuality::High,
        };
        let scene_options = SceneOptions::default().quality(quality).robust(robust);
        let opaque = triangles.opaque_count();
        let mut kinds = vec![(0..opaque, OPAQUE), (opaque..triangles.len() as u32, TRANSPARENT)];
        kinds.retain(|(range, _)| !range.is_empty());
        let mut indices = 0;
        let mut commit = |kinds: &[(Range<TriangleId>, NonZeroU32)]| {
            let mut builder = SceneBuilder::new(&device, scene_options)?;
            for (range, mask) in kinds {
                let corners = &triangles.corners()[range.start as usize..range.end as usize];
                // SAFETY: nothing changes triangles that are shared, and a clone of the Arc keeps them.
                unsafe { builder.add_in_place(corners, *mask, triangles.clone())? };
                indices += corners.len() * size_of::<[u32; 3]>();
            }
            builder.commit()
        };
        let scene = commit(&kinds)?;
        check_width(&scene, options.width)?;
        let transparent = if is_transparent_apart(&triangles) {
            Some(Arc::new(commit(&kinds[1..])?))
        } else {
            None
        };
        let firsts = kinds.iter().map(|(range, _)| range.start).collect();
        // What Embree reports includes the indices of corners; its structure is the rest.
        let bytes = device.memory_used().saturating_sub(indices);
        let (scene, cells) = (Arc::new(scene), Arc::new(Cells::new(triangles.clone())));
        let at_least = at_least(&triangles, cells.clone(), robust, options.arithmetic()).into();
        Ok(Self { triangles, scene, transparent, firsts, options, bytes, cells, at_least })
    }
}

/// Whether the scene's kernels have packets of that width.
pub(super) fn check_width(
    scene: &embree_ffi::Scene,
    width: PacketWidth,
) -> Result<(), embree_ffi::Error> {
    let coherence = embree_ffi::Coherence::default();
    match width {
        PacketWidth::One => Ok(()),
        PacketWidth::Four => scene.packets::<4>(coherence).map(drop),
        PacketWidth::Eight => scene.packets::<8>(coherence).map(drop),
        PacketWidth::Sixteen => scene.packets::<16>(coherence).map(drop),
    }
}
