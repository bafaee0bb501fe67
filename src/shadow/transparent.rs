//! Transparent occluders (§11 of the paper): they attenuate, are never remembered, and each counts
//! once, however many cells list it.
//!
//! The product is taken in ascending order of the triangles, so that its bits depend neither on the
//! backend nor on the order in which a traversal met them.

use glam::Vec3;

use crate::geometry::{Ray, TriangleId};
use crate::occlusion::{Occlusion, Tally};
use crate::scene::Scene;

/// Computes what is left of light behind transparent triangles; owned by a worker.
#[derive(Debug, Default)]
pub struct Attenuation {
    found: Vec<TriangleId>,
    /// What the backend did for it.
    pub tally: Tally,
}

impl Attenuation {
    /// The share of light, by colour, that passes all transparent triangles on a ray that no opaque
    /// one blocks; `spawner` does not count, if one is named.
    pub fn transmittance(
        &mut self,
        scene: &Scene,
        backend: &dyn Occlusion,
        ray: &Ray,
        spawner: Option<TriangleId>,
    ) -> Vec3 {
        backend.transparent(ray, &mut self.found, &mut self.tally);
        let others = self.found.iter().filter(|&&id| Some(id) != spawner);
        others.fold(Vec3::ONE, |product, &id| product * scene.material(id).transmission)
    }
}
