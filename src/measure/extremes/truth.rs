//! The exact verdict on a ray and a mesh, triangle by triangle.
//!
//! No structure over the triangles and no filter in f32 is used, only [`certified`](crate::exact::certified)
//! on every triangle, but for those that lie wholly on one side of the segment along an axis. That the oracle thinks
//! the same is seen on a sample.

use glam::DVec3;
use rayon::prelude::*;

use crate::exact::oracle::verdict_of_scene;
use crate::exact::{Verdict, certified};
use crate::geometry::{Bounds, Ray, Triangles};

/// One ray in this many is put to the oracle too, which takes microseconds a triangle.
const ORACLE_SAMPLE: usize = 100;

/// The oracle is not asked about larger meshes.
const LARGEST_FOR_ORACLE: usize = 10_000;

/// Blocked if any triangle blocks, else a tie if any is touched at an end of the ray, else clear.
#[must_use]
pub fn truth(ray: &Ray, mesh: &Triangles) -> Verdict {
    let span = Span::of(ray);
    let mut found = Verdict::Clear;
    for id in 0..mesh.len() as u32 {
        let triangle = mesh.get(id);
        if span.is_beside(&Bounds::of(triangle)) {
            continue;
        }
        match certified::verdict(ray, &triangle) {
            Verdict::Blocked => return Verdict::Blocked,
            Verdict::Tie => found = Verdict::Tie,
            Verdict::Clear => {}
        }
    }
    found
}

/// Puts a sample of the rays to the oracle: how many, and on how many it disagrees with the verdicts.
pub(super) fn sample(rays: &[Ray], verdicts: &[Verdict], mesh: &Triangles) -> (u64, u64) {
    if mesh.len() > LARGEST_FOR_ORACLE {
        return (0, 0);
    }
    let triangles = || (0..mesh.len() as u32).map(|id| mesh.get(id));
    let sampled: Vec<_> = rays.iter().zip(verdicts).step_by(ORACLE_SAMPLE).collect();
    let disagrees = sampled
        .par_iter()
        .filter(|&&(ray, verdict)| verdict_of_scene(ray, triangles()).0 != *verdict)
        .count();
    (sampled.len() as u64, disagrees as u64)
}

/// A box that holds the closed segment.
struct Span {
    low: DVec3,
    high: DVec3,
}

impl Span {
    fn of(ray: &Ray) -> Self {
        let origin = ray.origin.as_dvec3();
        let (mut low, mut high) = (origin, origin);
        for axis in 0..3 {
            // The product of two f32 is exact in f64, and the sum is rounded once; so a step of f64
            // outwards holds the true end. A direction of zero goes nowhere, however far.
            let direction = f64::from(ray.direction[axis]);
            let step = if direction == 0.0 { 0.0 } else { direction * f64::from(ray.end) };
            low[axis] = low[axis].min((origin[axis] + step).next_down());
            high[axis] = high[axis].max((origin[axis] + step).next_up());
        }
        Self { low, high }
    }

    /// Whether no point of the box can be in the span. Never so where anything is NaN.
    fn is_beside(&self, bounds: &Bounds) -> bool {
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        max.cmplt(self.low).any() || min.cmpgt(self.high).any()
    }
}
