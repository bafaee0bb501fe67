//! Intel Embree 4 as a backend.
//!
//! Embree decides by its own arithmetic: [`Test::Pluecker`](super::Test::Pluecker) stands for its robust
//! mode, [`Test::Moller`](super::Test::Moller) for its default one. It shows no leaves, so the occluder's
//! identity comes from an argument filter, and its *cell* is that of a companion grid, found by the hit
//! point; that grid is built when a memory first needs cells, and not otherwise (`cells`). What a memory
//! in front of Embree tests is the lower bound of Embree's own answer (`geometry::intersect::embree`), so
//! that it never says "blocked" where Embree would not.
//!
//! Each opaque and transparent triangle lies in a geometry of its own kind with a mask of its own; the transparent ones, where they are the
//! lesser part, in a second scene too, as a ray masked for them comes to all that is opaque on its way.

mod build;
mod cells;
mod packets;

use std::num::NonZeroU32;
use std::sync::Arc;

use embree_ffi::{Hit, Ray as EmbreeRay, Scene, Verdict};

use super::nearest::distance;
use super::{Cell, LeftOut, Nearest, Occluder, Occlusion, Tally};
use crate::geometry::{Ray, TriangleId, Triangles};

use cells::Cells;

pub use build::{EmbreeOptions, Isa, PacketWidth, Quality};

/// Rays with this mask see opaque triangles only.
const OPAQUE: NonZeroU32 = NonZeroU32::new(1).unwrap();
/// Rays with this mask see transparent triangles only.
const TRANSPARENT: NonZeroU32 = NonZeroU32::new(2).unwrap();

/// A scene in Embree.
pub struct Embree {
    triangles: Arc<Triangles>,
    scene: Arc<Scene>,
    /// The transparent triangles alone, where they are the lesser part: through the scene, rays would come to all that is opaque.
    transparent: Option<Arc<Scene>>,
    /// First triangle of each geometry.
    firsts: Vec<TriangleId>,
    options: EmbreeOptions,
    bytes: usize,
    cells: Arc<Cells>,
    /// The lower bound of Embree's answer, which walks through the cells.
    at_least: Arc<dyn Occlusion>,
}

impl Embree {
    /// The same scene, asked in packets of another width.
    ///
    /// # Errors
    /// If the kernels have no packets of that width.
    pub fn with_packets(
        &self,
        width: PacketWidth,
        coherent: bool,
    ) -> Result<Self, embree_ffi::Error> {
        build::check_width(&self.scene, width)?;
        Ok(Self {
            triangles: self.triangles.clone(),
            scene: self.scene.clone(),
            transparent: self.transparent.clone(),
            firsts: self.firsts.clone(),
            options: EmbreeOptions { width, coherent, ..self.options },
            cells: self.cells.clone(),
            at_least: self.at_least.clone(),
            ..*self
        })
    }

    fn ray(ray: &Ray, mask: NonZeroU32) -> EmbreeRay {
        EmbreeRay::new(ray.origin.to_array(), ray.direction.to_array())
            .with_interval(0.0, ray.end)
            .with_mask(mask)
    }

    fn triangle(&self, hit: &Hit) -> TriangleId {
        self.firsts[hit.geometry as usize] + hit.primitive
    }

    /// Counts a query; whether the ray can be answered.
    fn admit(ray: &Ray, tally: &mut Tally) -> bool {
        let valid = ray.is_valid();
        tally.traversals += u64::from(valid);
        tally.invalid_rays += u64::from(!valid);
        valid
    }
}

impl Occlusion for Embree {
    fn occluder(&self, ray: &Ray, tally: &mut Tally) -> Option<Occluder> {
        if !Self::admit(ray, tally) {
            return None;
        }
        let hit = self.scene.occluder(&Self::ray(ray, OPAQUE))?;
        let triangle = self.triangle(&hit);
        let cell = self.cells.at(triangle, ray.at(f64::from(hit.t)));
        Some(Occluder { triangle, cell })
    }

    fn occluded(&self, ray: &Ray, tally: &mut Tally) -> bool {
        Self::admit(ray, tally) && self.scene.occluded(&Self::ray(ray, OPAQUE))
    }

    fn occluded_many(&self, rays: &[Ray], blocked: &mut [bool], tally: &mut Tally) {
        assert_eq!(rays.len(), blocked.len(), "one answer a ray");
        if !packets::occluded(self, rays, blocked, tally) {
            for (ray, blocked) in rays.iter().zip(blocked) {
                *blocked = self.occluded(ray, tally);
            }
        }
    }

    fn occluder_in(&self, cell: Cell, ray: &Ray, tally: &mut Tally) -> Option<Occluder> {
        self.at_least.occluder_in(cell, ray, tally)
    }

    fn occluder_except(
        &self,
        ray: &Ray,
        within: Option<Cell>,
        left_out: &mut LeftOut,
        tally: &mut Tally,
    ) -> Option<Occluder> {
        if within.is_some() {
            return self.at_least.occluder_except(ray, within, left_out, tally);
        }
        if !Self::admit(ray, tally) {
            return None;
        }
        let mut found = None;
        // What the lower bound missed, Embree may still meet: only the spawner is left out.
        self.scene.occluded_with(&Self::ray(ray, OPAQUE), |hit| {
            let triangle = self.triangle(hit);
            if left_out.is_spawner(triangle) {
                return Verdict::Reject;
            }
            found = Some((triangle, hit.t));
            Verdict::Accept
        });
        let (triangle, t) = found?;
        let cell = self.cells.at(triangle, ray.at(f64::from(t)));
        Some(Occluder { triangle, cell })
    }

    fn meets(&self, triangle: TriangleId, ray: &Ray, tally: &mut Tally) -> bool {
        self.at_least.meets(triangle, ray, tally)
    }

    fn transparent(&self, ray: &Ray, found: &mut Vec<TriangleId>, tally: &mut Tally) {
        found.clear();
        if self.triangles.opaque_count() as usize == self.triangles.len()
            || !Self::admit(ray, tally)
        {
            return;
        }
        let scene = self.transparent.as_ref().unwrap_or(&self.scene);
        scene.occluded_with(&Self::ray(ray, TRANSPARENT), |hit| {
            // In either scene they are a geometry by themselves.
            found.push(self.triangles.opaque_count() + hit.primitive);
            Verdict::Reject
        });
        found.sort_unstable();
        found.dedup();
    }

    fn nearest(&self, ray: &Ray, tally: &mut Tally) -> Option<Nearest> {
        if !Self::admit(ray, tally) {
            return None;
        }
        let hit = self.scene.intersect(&Self::ray(ray, OPAQUE | TRANSPARENT))?;
        let triangle = self.triangle(&hit);
        // The place of the hit is computed as every backend computes it.
        let slack = self.triangles.slack();
        let t = distance(ray, &self.triangles.get(triangle), slack).unwrap_or(f64::from(hit.t));
        Some(Nearest { triangle, t })
    }

    fn order(&self) -> &[TriangleId] {
        self.at_least.order()
    }

    fn has_cells(&self) -> bool {
        self.cells.are_there()
    }

    fn memory(&self) -> usize {
        self.bytes + self.at_least.memory()
    }
}
