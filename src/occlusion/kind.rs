//! From names to backends.

use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

use serde::Serialize;

use super::{
    Brute, Bvh2, Cwbvh, DividedGrid, Engine, Grid, GridError, GridOptions, NestedGrid, Occlusion,
    UnknownName, Walk, named,
};
use crate::exact::Exact;
use crate::geometry::Triangles;
use crate::geometry::intersect::{Moller, Pluecker, Watertight};
use crate::geometry::lanes::Arithmetic;

/// The engines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, clap::ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Backend {
    /// umbra's grid: crowded voxels hold grids of their own.
    Grid,
    /// Intel Embree 4.
    Embree,
    /// obvhs' binary BVH.
    Bvh2,
    /// obvhs' compressed 8-wide BVH.
    Cwbvh,
    /// Every triangle, every time.
    Brute,
}

impl Backend {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Grid, Self::Embree, Self::Bvh2, Self::Cwbvh, Self::Brute];

    /// Whether this umbra was built with it.
    #[must_use]
    pub fn is_built_in(self) -> bool {
        self != Self::Embree || cfg!(feature = "embree")
    }

    /// Whether it can decide by a test: Embree has those of its own only.
    #[must_use]
    pub fn has(self, test: Test) -> bool {
        self != Self::Embree || matches!(test, Test::Pluecker | Test::Moller)
    }

    /// The test it uses where nothing else is asked for: the exact one where it can.
    #[must_use]
    pub fn default_test(self) -> Test {
        if self == Self::Embree { Test::Pluecker } else { Test::Exact }
    }

    /// The name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Grid => "grid",
            Self::Embree => "embree",
            Self::Bvh2 => "bvh2",
            Self::Cwbvh => "cwbvh",
            Self::Brute => "brute",
        }
    }
}

impl fmt::Display for Backend {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Backend {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, UnknownName> {
        named("engine", name, &Self::ALL)
    }
}

/// The triangle tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, clap::ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Test {
    /// Möller and Trumbore, as Embree's default mode has it.
    Moller,
    /// Plücker volumes, as Embree's robust mode has it.
    Pluecker,
    /// Woop, Benthin and Wald: watertight in f32.
    Watertight,
    /// Certified: the answer of exact arithmetic.
    Exact,
}

impl Test {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Moller, Self::Pluecker, Self::Watertight, Self::Exact];

    /// The name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Moller => "moller",
            Self::Pluecker => "pluecker",
            Self::Watertight => "watertight",
            Self::Exact => "exact",
        }
    }
}

impl fmt::Display for Test {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Test {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, UnknownName> {
        named("triangle test", name, &Self::ALL)
    }
}

/// What to build besides the default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BuildOptions {
    /// How finely the grid divides the scene.
    pub grid: GridOptions,
    /// The arithmetic of the triangle tests, which this CPU must have; its newest if none is named. Embree has its own.
    pub arithmetic: Option<Arithmetic>,
    /// How Embree is used.
    #[cfg(feature = "embree")]
    pub embree: super::EmbreeOptions,
}

/// Why there is no backend.
#[derive(Debug, thiserror::Error)]
pub enum BackendError {
    /// This umbra was built without the feature.
    #[error(
        "this umbra was built without Embree; build it with the default features, or choose another backend: grid, bvh2, cwbvh, brute"
    )]
    WithoutEmbree,
    /// Embree cannot be used here.
    #[cfg(feature = "embree")]
    #[error(transparent)]
    Embree(#[from] embree_ffi::Error),
    /// The grid cannot be as fine as was asked for.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// This CPU lacks the arithmetic that was asked for.
    #[error("this CPU has no {} arithmetic; leave it to umbra, which takes the newest there is", .0.name())]
    Arithmetic(Arithmetic),
    /// Embree decides by its own arithmetic.
    #[error(
        "embree has no test '{0}': its own are pluecker (robust mode) and moller (default mode)"
    )]
    NotInEmbree(Test),
}

/// Builds a backend over the triangles; over none, one that nothing blocks. Works on all threads of the current rayon pool. The grid
/// takes some 0.4 of the time of Embree; [`Occlusion::memory`] says how many bytes there are then.
///
/// ```
/// use std::sync::Arc;
/// use umbra::geometry::{Ray, Triangles};
/// use umbra::glam::Vec3;
/// use umbra::occlusion::{Backend, BuildOptions, Tally, Test, build};
///
/// let wall = [Vec3::ZERO, Vec3::X, Vec3::Y].map(|corner| corner + Vec3::Z);
/// let triangles = Arc::new(Triangles::from_iter([wall]));
/// let grid = build(Backend::Grid, Test::Exact, &triangles, &BuildOptions::default())?;
///
/// // Many rays at once are cheaper than one by one.
/// let rays = [0.2, 0.8].map(|x| Ray::towards(Vec3::new(x, x, 0.0), Vec3::Z));
/// let (mut blocked, mut tally) = ([false; 2], Tally::default());
/// grid.occluded_many(&rays, &mut blocked, &mut tally);
/// assert_eq!(blocked, [true, false]);
/// # Ok::<(), umbra::occlusion::BackendError>(())
/// ```
///
/// # Errors
/// If the backend or the arithmetic is not to be had here, or the grid not as fine.
pub fn build(
    backend: Backend,
    test: Test,
    triangles: &Arc<Triangles>,
    options: &BuildOptions,
) -> Result<Box<dyn Occlusion>, BackendError> {
    let own = backend != Backend::Embree;
    if let Some(arithmetic) = options.arithmetic.filter(|one| own && !one.is_available()) {
        return Err(BackendError::Arithmetic(arithmetic));
    }
    Ok(match backend {
        Backend::Grid => grid(test, triangles, options)?,
        Backend::Bvh2 => engine(test, triangles, Bvh2::new(triangles), options),
        Backend::Cwbvh => engine(test, triangles, Cwbvh::new(triangles), options),
        Backend::Brute => engine(test, triangles, Brute::new(triangles), options),
        Backend::Embree => embree(test, triangles, options)?,
    })
}

fn grid(
    test: Test,
    triangles: &Arc<Triangles>,
    options: &BuildOptions,
) -> Result<Box<dyn Occlusion>, BackendError> {
    let GridOptions { resolution, nested, lazy, .. } = options.grid;
    Ok(if lazy || (nested && resolution.is_some()) {
        engine(test, triangles, DividedGrid::new(triangles, options.grid)?, options)
    } else if nested {
        engine(test, triangles, NestedGrid::new(triangles), options)
    } else {
        engine(test, triangles, Grid::of_resolution(triangles, options.grid)?, options)
    })
}

#[cfg(feature = "embree")]
fn embree(
    test: Test,
    triangles: &Arc<Triangles>,
    options: &BuildOptions,
) -> Result<Box<dyn Occlusion>, BackendError> {
    if !Backend::Embree.has(test) {
        return Err(BackendError::NotInEmbree(test));
    }
    let robust = test == Test::Pluecker;
    Ok(Box::new(super::Embree::new(triangles.clone(), robust, options.embree)?))
}

#[cfg(not(feature = "embree"))]
fn embree(
    _: Test,
    _: &Arc<Triangles>,
    _: &BuildOptions,
) -> Result<Box<dyn Occlusion>, BackendError> {
    Err(BackendError::WithoutEmbree)
}

fn engine<W: Walk>(
    test: Test,
    triangles: &Arc<Triangles>,
    walk: W,
    options: &BuildOptions,
) -> Box<dyn Occlusion> {
    let (triangles, arithmetic) = (triangles.clone(), options.arithmetic);
    match test {
        Test::Moller => Box::new(Engine::<W, Moller>::new(triangles, walk, arithmetic)),
        Test::Pluecker => Box::new(Engine::<W, Pluecker>::new(triangles, walk, arithmetic)),
        Test::Watertight => Box::new(Engine::<W, Watertight>::new(triangles, walk, arithmetic)),
        Test::Exact => Box::new(Engine::<W, Exact>::new(triangles, walk, arithmetic)),
    }
}
