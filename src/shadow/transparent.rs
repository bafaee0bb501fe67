//! Transparent occluders (§11 of the paper): they attenuate, are never remembered, and each counts
//! once, however many cells list it.
//!
//! Who can finds them for many queries at once ([`Glass`]); of the others, each ray is traced among what is transparent. The product is
//! taken in ascending order of the triangles, so that its bits depend neither on the backend nor on the order in which a traversal met them.

use glam::Vec3;

use super::ShadowQuery;
use crate::geometry::{Ray, TriangleId};
use crate::occlusion::{Occlusion, Tally};
use crate::scene::Scene;

/// Finds all transparent triangles that queries meet; shared by all workers.
///
/// What it says is proven, of the ray's bits, in exact arithmetic: see [`Verdict`](super::Verdict). It passes on rays that are not valid, and
/// rays that do not end at its light.
pub trait Glass: Send + Sync {
    /// Looks at queries towards one light: each is answered, with all that it meets, or left as it is. What it costs goes to `tally`.
    fn find(&self, light: usize, queries: &[ShadowQuery], panes: &mut Panes, tally: &mut Tally);
}

/// The transparent triangles that each of some queries meets.
#[derive(Clone, Debug, Default)]
pub struct Panes {
    /// By query, a place in `met`, [`Self::NONE`] or [`Self::UNKNOWN`].
    firsts: Vec<u32>,
    /// A triangle, and the place of another one that the same query meets.
    met: Vec<(TriangleId, u32)>,
}

impl Panes {
    /// No further triangle is met.
    const NONE: u32 = u32::MAX;
    /// The query is not answered.
    const UNKNOWN: u32 = u32::MAX - 1;

    /// So many queries from now on, none of them answered.
    pub fn begin(&mut self, queries: usize) {
        self.met.clear();
        self.firsts.clear();
        self.firsts.resize(queries, Self::UNKNOWN);
    }

    /// Answers a query: it meets nothing so far.
    #[inline(always)]
    pub fn answer(&mut self, query: usize) {
        self.firsts[query] = Self::NONE;
    }

    /// A triangle that a query meets, which was answered before.
    #[inline(always)]
    pub fn add(&mut self, query: usize, triangle: TriangleId) {
        let first = &mut self.firsts[query];
        self.met.push((triangle, *first));
        *first = self.met.len() as u32 - 1;
    }

    /// What a query meets, in no order, a triangle perhaps more than once; `None` if it is not answered, or not among them.
    pub fn of(&self, query: usize) -> Option<impl Iterator<Item = TriangleId>> {
        let mut next = *self.firsts.get(query)?;
        if next == Self::UNKNOWN {
            return None;
        }
        Some(std::iter::from_fn(move || {
            let &(triangle, following) = self.met.get(next as usize)?;
            next = following;
            Some(triangle)
        }))
    }
}

/// Computes what is left of light behind transparent triangles; owned by a worker.
#[derive(Debug, Default)]
pub struct Attenuation {
    panes: Panes,
    found: Vec<TriangleId>,
    /// What was done for it.
    pub tally: Tally,
}

impl Attenuation {
    /// Prepares for some queries towards one light, which no opaque triangle blocks: what they meet is found at once.
    pub fn prepare(&mut self, glass: &dyn Glass, light: usize, queries: &[ShadowQuery]) {
        self.panes.begin(queries.len());
        glass.find(light, queries, &mut self.panes, &mut self.tally);
    }

    /// The share of light, by colour, that passes all transparent triangles on the ray of one of the queries that it was prepared for, by
    /// its place among them, or on any ray if it was not; `spawner` does not count, if one is named.
    pub fn transmittance(
        &mut self,
        scene: &Scene,
        backend: &dyn Occlusion,
        place: usize,
        ray: &Ray,
        spawner: Option<TriangleId>,
    ) -> Vec3 {
        match self.panes.of(place) {
            Some(met) => {
                self.found.clear();
                self.found.extend(met);
                self.found.sort_unstable();
                self.found.dedup();
            }
            None => backend.transparent(ray, &mut self.found, &mut self.tally),
        }
        let others = self.found.iter().filter(|&&id| Some(id) != spawner);
        others.fold(Vec3::ONE, |product, &id| product * scene.material(id).transmission)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panes_know_what_each_query_meets_and_which_are_not_answered() {
        let mut panes = Panes::default();
        for _ in 0..2 {
            panes.begin(4);
            for query in [0, 2, 3] {
                panes.answer(query);
            }
            for (query, triangle) in [(2, 7), (3, 5), (2, 0), (2, u32::MAX)] {
                panes.add(query, triangle);
            }
            let met = |query| panes.of(query).map(|met| met.collect::<Vec<_>>());
            assert_eq!(met(0), Some(vec![]));
            assert_eq!(met(1), None);
            assert_eq!(met(2), Some(vec![u32::MAX, 0, 7]));
            assert_eq!(met(3), Some(vec![5]));
        }
    }
}
