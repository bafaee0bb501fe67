//! Contenders: what is compared and timed. A backend with a test, the way it is used, and the shadow
//! method before it.

#[cfg(feature = "embree")]
mod embree_variant;

#[cfg(feature = "embree")]
use std::any::Any;
use std::fmt;
use std::sync::Arc;

#[cfg(feature = "embree")]
pub use embree_variant::{EmbreeVariant, VariantError};

use crate::geometry::Triangles;
use crate::occlusion::{Backend, BackendError, BuildOptions, Occlusion, Test, build};
#[cfg(feature = "embree")]
use crate::occlusion::{Embree, EmbreeOptions};
use crate::scene::Scene;
use crate::shadow::{Combination, Method, MethodError, Prepared, VerdictKind, prepare};

/// One way to answer shadow queries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contender {
    /// The engine.
    pub backend: Backend,
    /// Its triangle test.
    pub test: Test,
    /// What stands before it: verdicts and a memory.
    pub method: Combination,
    /// How it is built and used: the grid's resolution, the arithmetic, Embree's variant.
    pub options: BuildOptions,
}

impl Contender {
    /// The engine by itself, as it is built by default.
    #[must_use]
    pub fn new(backend: Backend, test: Test) -> Self {
        Self { backend, test, method: Combination::default(), options: BuildOptions::default() }
    }

    /// Builds the engine.
    ///
    /// # Errors
    /// If it is not to be had here.
    ///
    pub fn build(&self, triangles: &Arc<Triangles>) -> Result<Box<dyn Occlusion>, BackendError> {
        build(self.backend, self.test, triangles, &self.options)
    }

    /// Makes the method ready, before an engine that [`build`](Self::build) made over the scene's triangles.
    ///
    /// # Errors
    /// If method and scene or engine do not go together.
    pub fn prepare<'a>(
        &self,
        scene: &Scene,
        engine: &'a dyn Occlusion,
    ) -> Result<Box<dyn Prepared + 'a>, MethodError> {
        prepare(self.method, scene, engine)
    }

    /// Builds the engine, or uses that of the contender before where it is the same, or the same scene in Embree.
    ///
    /// # Errors
    /// If it is not to be had here.
    ///
    pub fn build_after(
        &self,
        last: Option<(&Self, Box<dyn Occlusion>)>,
        triangles: &Arc<Triangles>,
    ) -> Result<Box<dyn Occlusion>, BackendError> {
        let Some((other, engine)) = last else { return self.build(triangles) };
        let adapted = Self { method: self.method, ..*other };
        if adapted == *self {
            return Ok(engine);
        }
        #[cfg(feature = "embree")]
        {
            let EmbreeOptions { width, coherent, .. } = self.options.embree;
            let mut adapted = adapted;
            (adapted.options.embree.width, adapted.options.embree.coherent) = (width, coherent);
            let engine = (&*engine as &dyn Any).downcast_ref::<Embree>();
            if let Some(embree) = engine.filter(|_| adapted == *self) {
                return Ok(Box::new(embree.with_packets(width, coherent)?));
            }
        }
        // Gone before the next comes: memory holds one at a time.
        drop(engine);
        self.build(triangles)
    }

    /// Whether it asks Embree many rays at once.
    #[must_use]
    pub fn is_packet(&self) -> bool {
        #[cfg(feature = "embree")]
        return self.backend == Backend::Embree
            && self.options.embree.width != crate::occlusion::PacketWidth::One;
        #[cfg(not(feature = "embree"))]
        false
    }
}

/// The name in tables: backend, test, and what is not the default.
impl fmt::Display for Contender {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.backend, self.test)?;
        #[cfg(feature = "embree")]
        if self.backend == Backend::Embree && self.options.embree != Default::default() {
            write!(f, " {}", EmbreeVariant(self.options.embree))?;
        }
        if self.method != Combination::default() {
            write!(f, " {}", self.method)?;
        }
        Ok(())
    }
}

/// Which contenders there shall be: all combinations of these that exist. An empty list stands for what is
/// sensible.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Choice {
    /// The engines; all that this build has but brute force, which takes too long, if none is named.
    pub backends: Vec<Backend>,
    /// The tests; all if none is named.
    pub tests: Vec<Test>,
    /// The methods; `trace` if none is named.
    pub methods: Vec<Combination>,
    /// The ways to use Embree; its default if none is named.
    #[cfg(feature = "embree")]
    pub embree: Vec<EmbreeVariant>,
    /// How engines are built otherwise.
    pub options: BuildOptions,
}

/// Contenders, and combinations that were asked for but do not exist.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Selection {
    /// In the order of the lists; those that share an engine follow each other.
    pub contenders: Vec<Contender>,
    /// What was left out, and why: a line each.
    pub left_out: Vec<String>,
}

impl Choice {
    /// Every memory and every verdict by itself.
    #[must_use]
    pub fn every_method() -> Vec<Combination> {
        let memories = Method::ALL.into_iter().map(Combination::from);
        memories.chain(VerdictKind::ALL.into_iter().map(Combination::from)).collect()
    }

    /// Every backend but brute force, test, method and use of Embree that this CPU has.
    #[must_use]
    pub fn everything() -> Self {
        Self {
            methods: Self::every_method(),
            #[cfg(feature = "embree")]
            embree: EmbreeVariant::all(),
            ..Self::default()
        }
    }

    /// The backends that are meant.
    #[must_use]
    pub fn backends(&self) -> Vec<Backend> {
        let is_sensible = |&backend: &Backend| backend != Backend::Brute && backend.is_built_in();
        or_all(&self.backends, || Backend::ALL.into_iter().filter(is_sensible).collect())
    }

    /// The combinations that exist.
    #[must_use]
    pub fn select(&self) -> Selection {
        let tests = or_all(&self.tests, || Test::ALL.to_vec());
        let methods = or_all(&self.methods, || vec![Combination::default()]);
        let mut selection = Selection::default();
        for backend in self.backends() {
            if !backend.is_built_in() {
                selection.left_out.push(format!("{backend}: {}", BackendError::WithoutEmbree));
                continue;
            }
            for &test in &tests {
                if !backend.has(test) {
                    // Of a test that nobody named, nobody misses it.
                    if !self.tests.is_empty() {
                        let reason = BackendError::NotInEmbree(test);
                        selection.left_out.push(format!("{backend} {test}: {reason}"));
                    }
                    continue;
                }
                for options in self.options_of(backend) {
                    for &method in &methods {
                        selection.add(Contender { backend, test, method, options });
                    }
                }
            }
        }
        selection
    }

    #[cfg(feature = "embree")]
    fn options_of(&self, backend: Backend) -> Vec<BuildOptions> {
        if backend != Backend::Embree || self.embree.is_empty() {
            return vec![self.options];
        }
        let options = |variant: &EmbreeVariant| BuildOptions { embree: variant.0, ..self.options };
        self.embree.iter().map(options).collect()
    }

    #[cfg(not(feature = "embree"))]
    fn options_of(&self, _: Backend) -> Vec<BuildOptions> {
        vec![self.options]
    }
}

impl Selection {
    fn add(&mut self, contender: Contender) {
        if contender.is_packet() && contender.method.method != Method::Trace {
            // Memories ask one ray at a time: it would be the contender of width 1 under another name.
            self.left_out.push(format!("{contender}: methods with memories ask no packets"));
        } else if !self.contenders.contains(&contender) {
            self.contenders.push(contender);
        }
    }
}

fn or_all<T: Clone>(named: &[T], all: impl FnOnce() -> Vec<T>) -> Vec<T> {
    if named.is_empty() { all() } else { named.to_vec() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(choice: &Choice) -> Vec<String> {
        choice.select().contenders.iter().map(Contender::to_string).collect()
    }

    #[test]
    fn unasked_every_engine_meets_with_every_test_it_has() {
        let names = names(&Choice::default());
        assert!(
            names.contains(&"grid exact".to_owned()) && names.contains(&"cwbvh moller".to_owned())
        );
        let embree = if cfg!(feature = "embree") { 2 } else { 0 };
        assert_eq!(names.len(), 12 + embree);
    }

    #[test]
    fn a_combination_that_was_named_but_does_not_exist_is_said() {
        let (backends, tests) = (vec![Backend::Embree, Backend::Grid], vec![Test::Exact]);
        let selection = Choice { backends, tests, ..Choice::default() }.select();
        assert_eq!(selection.contenders, [Contender::new(Backend::Grid, Test::Exact)]);
        let told = if cfg!(feature = "embree") {
            "embree exact: embree has no test 'exact'"
        } else {
            "embree: this umbra was built without Embree"
        };
        assert!(selection.left_out[0].starts_with(told), "{:?}", selection.left_out);
    }

    #[test]
    fn what_is_named_twice_is_one_contender() {
        let (backends, tests) = (vec![Backend::Grid; 2], vec![Test::Exact; 2]);
        assert_eq!(names(&Choice { backends, tests, ..Choice::default() }), ["grid exact"]);
    }

    #[cfg(feature = "embree")]
    #[test]
    fn methods_with_memories_stand_before_single_rays_only() {
        let choice = Choice {
            backends: vec![Backend::Embree],
            tests: vec![Test::Pluecker],
            methods: vec![Method::Trace.into(), Method::VoxelCache.into()],
            embree: vec!["default".parse().unwrap(), "4".parse().unwrap()],
            ..Choice::default()
        };
        let expected =
            ["embree pluecker", "embree pluecker voxel-cache", "embree pluecker medium-4"];
        assert_eq!(names(&choice), expected);
        assert_eq!(choice.select().left_out.len(), 1);
    }
}
