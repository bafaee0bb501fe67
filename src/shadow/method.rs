//! From names to shadow methods.

use std::fmt;

use clap::ValueEnum;

use super::{
    Cached, Forgetful, LastCell, LastOccluder, LastVoxel, Memory, Nearby, PerLight, PerPath,
    Prepared, Retest, Shelf, Tolerance, Trace, Undecided, Verdict, cache_tree, woo,
};
use crate::occlusion::Occlusion;
use crate::scene::Scene;

/// The shadow methods.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, ValueEnum)]
pub enum Method {
    /// The backend alone.
    #[default]
    Trace,
    /// Each light tests its last occluder first (Haines & Greenberg 1986).
    ObjectCache,
    /// Then the voxel it was in (Pearce & Jevans 1991).
    VoxelCache,
    /// A voxel cache for each path of reflections and refractions (Pearce & Jevans 1991).
    CacheTree,
    /// The same, passed over by rays far from the one that was blocked.
    CacheTreeTolerance,
    /// A voxel cache that keeps no occluder, but moves it to the front of its voxel (Woo).
    Woo,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Trace,
        Self::ObjectCache,
        Self::VoxelCache,
        Self::CacheTree,
        Self::CacheTreeTolerance,
        Self::Woo,
    ];

    /// The name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Trace => "trace",
            Self::ObjectCache => "object-cache",
            Self::VoxelCache => "voxel-cache",
            Self::CacheTree => "cache-tree",
            Self::CacheTreeTolerance => "cache-tree-tolerance",
            Self::Woo => "woo",
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What keeps a shadow ray from meeting the triangle that it starts on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, ValueEnum)]
pub enum SelfShadow {
    /// The ray starts a little off the surface.
    #[default]
    Offset,
    /// The triangle is left out (§9 of the paper); neighbours that the ray also starts on are not.
    Exclude,
}

/// A method with its options.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// The method.
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

impl From<Method> for Plan {
    /// The method with the options that are best on the whole.
    fn from(method: Method) -> Self {
        Self {
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
}

/// Makes a method ready for a scene and a backend over its triangles.
///
/// # Errors
/// If method and scene or backend do not go together.
pub fn prepare<'a>(
    plan: impl Into<Plan>,
    scene: &Scene,
    backend: &'a dyn Occlusion,
) -> Result<Box<dyn Prepared + 'a>, MethodError> {
    prepare_behind(Undecided, plan, scene, backend)
}

/// The same, for queries that a verdict does not settle.
///
/// # Errors
/// If method and scene or backend do not go together.
pub fn prepare_behind<'a, V: Verdict + 'a>(
    verdict: V,
    plan: impl Into<Plan>,
    scene: &Scene,
    backend: &'a dyn Occlusion,
) -> Result<Box<dyn Prepared + 'a>, MethodError> {
    let plan = plan.into();
    if !(0.0..=0.5).contains(&plan.tolerance) {
        return Err(MethodError::Tolerance(plan.tolerance));
    }
    let bounds = scene.bounds();
    let diagonal = bounds.min.distance(bounds.max);
    let tolerance = Tolerance::new(plan.tolerance * diagonal, plan.tolerance);
    let table = Table { verdict, backend, opaque: scene.triangles.opaque_count(), plan };
    Ok(match plan.method {
        Method::Trace if plan.self_shadow == SelfShadow::Offset => {
            Box::new(Trace::behind(table.verdict, backend))
        }
        Method::Trace => table.memory(PerLight::<Forgetful>::default(), ()),
        Method::ObjectCache => table.memory(PerLight::<LastOccluder>::default(), ()),
        Method::VoxelCache => table.memory(PerLight::<LastVoxel>::default(), ()),
        Method::CacheTree => table.memory(PerPath::<LastVoxel>::new(plan.tree_depth), ()),
        Method::CacheTreeTolerance => {
            table.memory(PerPath::<Nearby<LastVoxel>>::new(plan.tree_depth), (tolerance, ()))
        }
        Method::Woo => table.memory(PerLight::<LastCell>::default(), woo::Fronts::default()),
    })
}

/// What all memories are put behind and before.
struct Table<'a, V> {
    verdict: V,
    backend: &'a dyn Occlusion,
    opaque: u32,
    plan: Plan,
}

impl<'a, V: Verdict + 'a> Table<'a, V> {
    fn memory<M, K>(self, shelf: K, shared: M::Shared) -> Box<dyn Prepared + 'a>
    where
        M: Memory + 'a,
        K: Shelf<M> + 'a,
        M::Shared: 'a,
    {
        let Self { verdict, backend, opaque, plan } = self;
        Box::new(Cached::<V, M, K>::new(backend, opaque, verdict, shelf, shared, plan))
    }
}
