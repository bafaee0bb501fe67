//! From triangles and options to a scene in Embree.

use std::collections::HashMap;
use std::num::NonZeroU32;
use std::ops::Range;
use std::sync::Arc;

use embree_ffi::{BuildQuality, Device, DeviceConfig, Mesh, SceneBuilder, SceneOptions};
use glam::Vec3;

use super::{Cells, Embree, OPAQUE, TRANSPARENT};
use crate::geometry::lanes::Arithmetic;
use crate::geometry::{TriangleId, Triangles};
use crate::occlusion::embree_bounds::at_least;
use crate::occlusion::transparent::is_transparent_apart;

pub use embree_ffi::Isa;

/// How much work goes into Embree's structure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, clap::ValueEnum)]
pub enum Quality {
    /// A tree of trees, quickly built.
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
    /// Copies the triangles into Embree and builds its structure.
    ///
    /// # Errors
    /// If Embree cannot be loaded, the CPU lacks the kernels, or memory does not suffice.
    pub fn new(
        triangles: Arc<Triangles>,
        robust: bool,
        options: EmbreeOptions,
    ) -> Result<Self, embree_ffi::Error> {
        let config =
            options.isa.map_or_else(DeviceConfig::default, |isa| DeviceConfig::default().isa(isa));
        let device = Device::new(config)?;
        let quality = match options.quality {
            Quality::Low => BuildQuality::Low,
            Quality::Medium => BuildQuality::Medium,
            Quality::High => BuildQuality::High,
        };
        let scene_options = SceneOptions::default().quality(quality).robust(robust);
        let opaque = triangles.opaque_count();
        let kinds = [(0..opaque, OPAQUE), (opaque..triangles.len() as u32, TRANSPARENT)];
        let meshes: Vec<SharedVertices> = kinds
            .into_iter()
            .filter(|(range, _)| !range.is_empty())
            .map(|(range, mask)| SharedVertices::new(&triangles, range, mask))
            .collect();
        let mut copied = 0;
        let mut commit = |meshes: &[SharedVertices]| {
            let mut builder = SceneBuilder::new(&device, scene_options)?;
            for mesh in meshes {
                builder.add(mesh.mesh())?;
                copied += mesh.bytes();
            }
            builder.commit()
        };
        let scene = commit(&meshes)?;
        check_width(&scene, options.width)?;
        let transparent = if is_transparent_apart(&triangles) {
            Some(Arc::new(commit(&meshes[1..])?))
        } else {
            None
        };
        let firsts = meshes.iter().map(|mesh| mesh.first).collect();
        // What Embree reports includes the copies of vertices and indices; its structure is the rest.
        let bytes = device.memory_used().saturating_sub(copied);
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

/// Triangles whose equal corners are joined: Embree's own refer to vertices.
struct SharedVertices {
    first: TriangleId,
    mask: NonZeroU32,
    vertices: Vec<[f32; 3]>,
    indices: Vec<[u32; 3]>,
}

impl SharedVertices {
    fn new(triangles: &Triangles, range: Range<TriangleId>, mask: NonZeroU32) -> Self {
        let first = range.start;
        let mut vertices = Vec::new();
        let mut known: HashMap<[u32; 3], u32> = HashMap::new();
        let mut index = |corner: Vec3| {
            *known.entry(corner.to_array().map(f32::to_bits)).or_insert_with(|| {
                vertices.push(corner.to_array());
                vertices.len() as u32 - 1
            })
        };
        let indices = range.map(|id| triangles.get(id).map(&mut index)).collect();
        Self { first, mask, vertices, indices }
    }

    fn mesh(&self) -> Mesh<'_> {
        Mesh::new(&self.vertices, &self.indices).with_mask(self.mask)
    }

    fn bytes(&self) -> usize {
        size_of_val(&*self.vertices) + size_of_val(&*self.indices)
    }
}
