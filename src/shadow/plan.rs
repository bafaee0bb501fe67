//! A shadow method with its options, made ready for a scene and a backend.

use std::sync::Arc;

use clap::ValueEnum;
use serde::Serialize;

use super::stock::Stock;
use super::{
    Budget, Cached, Combination, Forgetful, LastCell, LastOccluder, LastVoxel, Memory, Method,
    Nearby, Path, PerLight, PerPath, Prepared, Retest, Shelf, Tolerance, Trace, VerdictSet,
    Verdicts, cache_tree, woo,
};
use crate::occlusion::Occlusion;
use crate::scene::Scene;

/// What keeps a shadow ray from meeting the triangle that it starts on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SelfShadow {
    /// The ray starts a little off the surface.
    #[default]
    Offset,
    /// The triangle is left out (§9 of the paper); neighbours that the ray also starts on are not.
    Exclude,
}

/// What stands before a backend, with its options.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// The verdicts that are asked first.
    pub verdicts: VerdictSet,
    /// Bytes that they may take together with the backend. If not given, they alone may take what Embree's structure would.
    pub budget: Option<u64>,
    /// Bytes that the backend would take with a larger budget, if it was made coarser for this one: advice leaves it room to
    /// take them.
    pub backend_bytes: u64,
    /// The memory that is asked next.
    pub method: Method,
    /// How a ray keeps clear of its own triangle.
    pub self_shadow: SelfShadow,
    /// Whether a traversal tests again what the memory tested.
    pub retest: Retest,
    /// Whether memories are forgotten at the beginning of each scanline (§8 of the paper).
    pub reset_scanlines: bool,
    /// Bounces down to which a cache tree has nodes.
    pub tree_depth: u8,
    /// For the tolerance check: how far apart points may be in units of the scene's diagonal, and
    /// directions in units of half a turn.
    pub tolerance: f32,
}

impl Plan {
    /// Its verdicts and memory.
    #[must_use]
    pub fn combination(&self) -> Combination {
        Combination { verdicts: self.verdicts, method: self.method }
    }

    /// Whether its options make sense, alone and together.
    pub(super) fn check(&self) -> Result<(), MethodError> {
        if !(0.0..=0.5).contains(&self.tolerance) {
            return Err(MethodError::Tolerance(self.tolerance));
        }
        if self.tree_depth > Path::MAX_LEVEL {
            return Err(MethodError::TreeDepth(self.tree_depth));
        }
        if self.self_shadow == SelfShadow::Exclude && !self.verdicts.is_empty() {
            return Err(MethodError::LeavesOut(self.combination()));
        }
        Ok(())
    }

    /// What its verdicts are prepared from; they share what memory the backend leaves of the budget.
    pub(super) fn stock<'a>(&self, scene: &'a Scene, backend: &dyn Occlusion) -> Stock<'a> {
        let budget = Budget::beside(backend, self.backend_bytes, scene, self.budget);
        Stock::new(scene, Arc::new(budget), self.verdicts)
    }
}

impl<C: Into<Combination>> From<C> for Plan {
    /// Verdicts and memory with the options that are best on the whole.
    fn from(combination: C) -> Self {
        let Combination { verdicts, method } = combination.into();
        Self {
            verdicts,
            budget: None,
            backend_bytes: 0,
            method,
            self_shadow: SelfShadow::default(),
            retest: Retest::default(),
            reset_scanlines: false,
            tree_depth: cache_tree::DEPTH,
            tolerance: 0.05,
        }
    }
}

/// Why a method cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MethodError {
    /// Not a share.
    #[error(
        "tolerance {0}: give a number from 0 (none) to 0.5 (any direction that is not opposite)"
    )]
    Tolerance(f32),
    /// Deeper than any path.
    #[error(
        "tree depth {0}: the table of a ray's path holds {max} reflections and refractions; give 0 to {max}",
        max = Path::MAX_LEVEL
    )]
    TreeDepth(u8),
    /// Verdicts are proofs about all triangles.
    #[error(
        "{0} counts the triangle that a ray starts on like any other, so it cannot be left out: use --self-shadow offset, or no verdict"
    )]
    LeavesOut(Combination),
}

/// Makes a method ready for a scene and a backend over its triangles, and over no others: that is not checked, and
/// before a backend over another scene answers are about neither, or asking panics.
///
/// ```
/// # use umbra::glam::Vec3;
/// # use umbra::occlusion::{Backend, BuildOptions, Test, build};
/// # use umbra::scene::builtin;
/// use umbra::shadow::{Answer, Combination, Path, ShadowQuery, prepare};
///
/// # let scene = builtin::draft_at("chair-room", 0.01)?.finish()?;
/// # let backend = build(Backend::Grid, Test::Exact, &scene.triangles, &BuildOptions::default())?;
/// let method: Combination = "shaft+object-cache".parse()?;
/// let prepared = prepare(method, &scene, &*backend)?;
///
/// // From the middle of the scene to its first light.
/// let ray = scene.lights[0].shadow_ray(scene.bounds().centre().as_vec3());
/// let queries = [ShadowQuery { ray, path: Path::EYE, spawner: 0 }];
/// let mut answers = [Answer::default()];
/// prepared.worker().answer(0, &queries, &mut answers);
/// println!("{}", if answers[0].blocked { "dark" } else { "lit" });
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// What it costs depends on the verdicts: none takes nothing, `light-buffer` prepares a light when it is first asked
/// about, the others prepare here. Each worker answers by itself; share the method among threads, and give each a worker.
///
/// A plan is one method. [`Auto::new`](super::Auto::new), which chooses among them, is no plan, as it has to be told the backend's
/// test: exact or not decides whom it may ask. What it gives is a [`Prepared`] like any other.
///
/// # Errors
/// If the options make no sense, alone or together.
///
/// # Panics
/// If the scene has no triangle that is finite; one that [`Draft::finish`](crate::scene::Draft::finish) made has.
pub fn prepare<'a>(
    plan: impl Into<Plan>,
    scene: &Scene,
    backend: &'a dyn Occlusion,
) -> Result<Box<dyn Prepared + 'a>, MethodError> {
    let plan = plan.into();
    plan.check()?;
    Ok(prepare_from(&plan, &plan.stock(scene, backend), backend))
}

/// Makes a plan that has been checked ready, from what others may have taken from before.
pub(super) fn prepare_from<'a>(
    plan: &Plan,
    stock: &Stock<'_>,
    backend: &'a dyn Occlusion,
) -> Box<dyn Prepared + 'a> {
    let mut verdicts = Verdicts::default();
    for kind in plan.verdicts.iter() {
        verdicts.push(kind, || kind.prepare(stock));
    }
    let bounds = stock.scene.bounds();
    let diagonal = bounds.min.distance(bounds.max);
    let tolerance = Tolerance::new(plan.tolerance * diagonal, plan.tolerance);
    let opaque = stock.scene.triangles.opaque_count();
    let table = Table { verdicts, backend, opaque, plan: *plan };
    match plan.method {
        Method::Trace if plan.self_shadow == SelfShadow::Offset => {
            Box::new(Trace::behind(table.verdicts, backend))
        }
        Method::Trace => table.memory(PerLight::<Forgetful>::default(), ()),
        Method::ObjectCache => table.memory(PerLight::<LastOccluder>::default(), ()),
        Method::VoxelCache => table.memory(PerLight::<LastVoxel>::default(), ()),
        Method::CacheTree => table.memory(PerPath::<LastVoxel>::new(plan.tree_depth), ()),
        Method::CacheTreeTolerance => {
            table.memory(PerPath::<Nearby<LastVoxel>>::new(plan.tree_depth), (tolerance, ()))
        }
        Method::Woo => table.memory(PerLight::<LastCell>::default(), woo::Fronts::default()),
    }
}

/// What all memories are put behind and before.
struct Table<'a> {
    verdicts: Verdicts<'a>,
    backend: &'a dyn Occlusion,
    opaque: u32,
    plan: Plan,
}

impl<'a> Table<'a> {
    fn memory<M, K>(self, shelf: K, shared: M::Shared) -> Box<dyn Prepared + 'a>
    where
        M: Memory + 'a,
        K: Shelf<M> + 'a,
        M::Shared: 'a,
    {
        let Self { verdicts, backend, opaque, plan } = self;
        Box::new(Cached::<M, K>::new(backend, opaque, verdicts, shelf, shared, plan))
    }
}
