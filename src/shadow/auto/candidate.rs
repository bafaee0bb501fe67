//! Whom `auto` may ask, and what that costs beforehand.

use std::sync::OnceLock;

use super::policy::Prices;
use crate::occlusion::{Occlusion, Test};
use crate::shadow::{
    Combination, Method, Prepared, SelfShadow, VerdictKind, VerdictReport, VerdictSet,
};

/// Nanoseconds a triangle to group triangles into clusters, of all threads together: when they are the first thing that a program
/// builds, 82 to 136 were seen (EPYC), and 206 where the system had to find memory. What is thought too cheap is built too early, and
/// what it did cost is known only afterwards.
const CLUSTERS: f64 = 120.0;

/// Nanoseconds a triangle to sort clusters by the directions of a light: a first guess, which what the first light took replaces.
const LIGHT_MAP: f64 = 10.0;

/// Nanoseconds a triangle before a memory of cells can be asked over a backend without them: Embree needs a grid beside it.
const CELLS: f64 = 1000.0;

/// A method that is prepared when it is worth it.
pub(super) struct Candidate<'a> {
    pub combination: Combination,
    pub prepared: OnceLock<Box<dyn Prepared + 'a>>,
}

impl Candidate<'_> {
    /// Whether it builds while it answers.
    pub fn builds_for_lights(&self) -> bool {
        self.combination.verdicts.contains(VerdictKind::LightBuffer)
    }

    /// Whether it needs the triangles' clusters.
    pub fn needs_clusters(&self) -> bool {
        !self.combination.verdicts.is_empty()
    }

    /// Whether it is prepared, but has no memory for any of its verdicts.
    pub fn steps_aside(&self) -> bool {
        let reports = self.prepared.get().map(|prepared| prepared.verdicts()).unwrap_or_default();
        let is_nothing = |report: &VerdictReport| report.bytes == 0 && !report.notes.is_empty();
        !reports.is_empty() && reports.iter().all(is_nothing)
    }

    /// What it is expected to take before it answers the first query, over so many triangles in a backend.
    pub fn prices(&self, triangles: usize, backend: &dyn Occlusion) -> Prices {
        let triangles = triangles as f64;
        let scene = match self.combination.method {
            Method::Trace if self.needs_clusters() => CLUSTERS,
            Method::Trace | Method::ObjectCache => 0.0,
            _ if backend.has_cells() => 0.0,
            _ => CELLS,
        };
        let light = self.builds_for_lights().then_some(LIGHT_MAP * triangles);
        Prices { scene: scene * triangles, light }
    }
}

/// Who is worth asking; first the one that needs nothing.
///
/// Light buffers are among them only if more memory is allowed than usual (`roomy`): where they win, in lattices of small
/// triangles, they take two to four times what Embree does, and half of one wins nothing.
///
/// A verdict's answers are those of exact arithmetic, so verdicts stand before that test only; and they do not go
/// with leaving out the triangle that a ray starts on. The other verdicts and memories win nowhere that one of these
/// does not win by more (docs/methods.md).
pub(super) fn candidates(test: Test, self_shadow: SelfShadow, roomy: bool) -> Vec<Combination> {
    use VerdictKind::{LightBuffer, Shaft};
    let mut all = vec![Combination::default()];
    if test == Test::Exact && self_shadow == SelfShadow::Offset {
        let shaft = VerdictSet::NONE.with(Shaft);
        let mut sets = vec![shaft];
        if roomy {
            sets.extend([shaft.with(LightBuffer), VerdictSet::NONE.with(LightBuffer)]);
        }
        let alone = |verdicts| Combination { verdicts, ..Combination::default() };
        all.extend(sets.into_iter().map(alone));
    } else {
        all.push(Method::ObjectCache.into());
    }
    all.push(Method::CacheTree.into());
    all
}
