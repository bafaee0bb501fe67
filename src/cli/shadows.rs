//! What stands before the engine, as the command line names it.

use std::fmt;
use std::str::FromStr;

use clap::Args;
use serde::Serialize;

use super::failure::{Failure, say};
use super::numbers::{finite, whole};
use super::options::{Built, EngineOptions, MOST_DEPTH};
use crate::occlusion::Backend;
use crate::render::{Order, SettingsError};
use crate::scene::Scene;
use crate::shadow::{
    Auto, Combination, CombinationError, Method, Plan, Prepared, Retest, SelfShadow, VerdictKind,
    prepare,
};

/// What stands before the engine.
#[derive(Args, Serialize)]
pub(super) struct ShadowOptions {
    #[serde(skip)]
    #[arg(long, value_name = "METHOD", default_value_t, help = shadows_help())]
    shadows: Choice,
    /// What keeps a shadow ray from meeting the triangle that it starts on
    #[arg(long, value_enum, default_value_t)]
    self_shadow: SelfShadow,
    /// Whether a traversal tests again what was tested from memory
    #[arg(long, value_enum, default_value_t)]
    retest: Retest,
    /// Forgets what is remembered at the beginning of each scanline (orders by scanline)
    #[arg(long)]
    reset_scanlines: bool,
    /// Bounces down to which a cache tree has nodes of its own
    #[arg(long, value_name = "N", default_value_t = Plan::from(Method::CacheTree).tree_depth, value_parser = whole(0..=MOST_DEPTH))]
    tree_depth: u8,
    /// For cache-tree-tolerance: how far apart rays may start, in diagonals of the scene, and point, in
    /// half turns
    #[arg(long, value_name = "SHARE", default_value_t = Plan::from(Method::CacheTree).tolerance, value_parser = finite::<f32>)]
    tolerance: f32,
}

/// Names every method.
fn shadows_help() -> String {
    format!(
        "What stands before the engine: auto, which asks what turns out to be cheapest, light by light (over embree: shaft); or {}",
        Combination::names()
    )
}

/// A shadow method, or the program's choice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Choice {
    #[default]
    Auto,
    Given(Combination),
}

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Given(combination) => combination.fmt(f),
        }
    }
}

impl FromStr for Choice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "auto" => Ok(Self::Auto),
            _ if names_auto(text) => Err(format!("auto stands alone; {}", shadows_to_give())),
            _ => text
                .parse()
                .map(Self::Given)
                .map_err(|error: CombinationError| error.with_advice(&shadows_to_give())),
        }
    }
}

/// What `--shadows` takes.
fn shadows_to_give() -> String {
    Combination::names().replacen("give ", "give auto; or ", 1)
}

/// Whether the choice is left to the program, which is no method to go with others or to compare.
fn names_auto(text: &str) -> bool {
    text.split('+').any(|part| part.trim() == "auto")
}

/// A method that is compared.
pub(super) fn parse_method(text: &str) -> Result<Combination, String> {
    if names_auto(text) {
        let names = Combination::names();
        return Err(format!("auto chooses among the methods that are compared; {names}"));
    }
    text.parse().map_err(|error: CombinationError| error.to_string())
}

/// Embree alone decides what it tests.
pub(super) fn retest_over_embree() -> Failure {
    Failure::Input(
        "--retest: Embree tests again what it likes; leave it out, or give another engine"
            .to_owned(),
    )
}

impl ShadowOptions {
    /// Refuses what would change nothing.
    pub fn check(&self, backend: Backend, order: Order) -> Result<(), Failure> {
        if self.reset_scanlines && order.batches() {
            return Err(Failure::Input(
                "--reset-scanlines: tiles have no scanlines; give --order scanline or serpentine"
                    .to_owned(),
            ));
        }
        if self.retest != Retest::default() && backend == Backend::Embree {
            return Err(retest_over_embree());
        }
        let usual = Plan::from(Method::CacheTree);
        // Who is chosen while rendering may be a cache tree.
        let method = self.given(backend).map_or(usual.method, |combination| combination.method);
        let remembers = method != Method::Trace;
        let is_tree = matches!(method, Method::CacheTree | Method::CacheTreeTolerance);
        let retests = match self.retest {
            Retest::Again => true,
            Retest::NotCell => remembers && method != Method::ObjectCache,
            // The mailbox serves a ray that leaves out its own triangle, too.
            Retest::NotTriangles => remembers || self.self_shadow == SelfShadow::Exclude,
        };
        let without_use = [
            ("--retest", !retests, "voxel-cache or cache-tree"),
            ("--reset-scanlines", self.reset_scanlines && !remembers, "voxel-cache or cache-tree"),
            ("--tree-depth", self.tree_depth != usual.tree_depth && !is_tree, "cache-tree"),
            (
                "--tolerance",
                self.tolerance != usual.tolerance && method != Method::CacheTreeTolerance,
                "cache-tree-tolerance",
            ),
        ];
        match without_use.iter().find(|(_, is_without, _)| *is_without) {
            None => Ok(()),
            Some((option, _, others)) => Err(Failure::Input(format!(
                "{option} changes nothing with --shadows {}; leave it out, or give {others}",
                self.shadows
            ))),
        }
    }

    /// What was asked for, as it is written.
    pub fn name(&self) -> String {
        self.shadows.to_string()
    }

    /// What stands before this engine, unless that is chosen while rendering.
    fn given(&self, backend: Backend) -> Option<Combination> {
        // Embree has no exact test, so nobody but Embree gives its bits, and there is nothing to choose among. Shafts answer
        // all rays to lights, exactly, and in less time than Embree's single rays.
        let embree = backend == Backend::Embree && self.self_shadow == SelfShadow::Offset;
        match self.shadows {
            Choice::Given(combination) => Some(combination),
            Choice::Auto => embree.then(|| VerdictKind::Shaft.into()),
        }
    }

    /// Makes it ready for a scene and a backend with this test, within a memory limit, for about as many queries as
    /// are expected.
    pub fn prepare<'a>(
        &self,
        scene: &'a Scene,
        built: &'a Built,
        engine: &EngineOptions,
        expected: impl FnOnce() -> Result<u64, SettingsError>,
    ) -> Result<Box<dyn Prepared + 'a>, Failure> {
        let backend = &*built.backend;
        let given = self.given(engine.backend);
        let plan = Plan {
            budget: engine.most_bytes(),
            backend_bytes: built.wanted_bytes,
            self_shadow: self.self_shadow,
            retest: self.retest,
            reset_scanlines: self.reset_scanlines,
            tree_depth: self.tree_depth,
            tolerance: self.tolerance,
            ..given.unwrap_or_default().into()
        };
        if given.is_some() {
            let prepared = prepare(plan, scene, backend)?;
            if self.shadows == Choice::Auto {
                let exact = prepared.verdicts().iter().all(|report| report.notes.is_empty());
                say!(
                    "umbra: over embree, auto is shaft: {}",
                    match exact {
                        true => "exact; --shadows trace has Embree's own answers",
                        false =>
                            "it steps aside for want of memory, so the answers are Embree's own",
                    }
                );
            }
            return Ok(prepared);
        }
        let auto = Auto::new(plan, engine.test(), scene, backend)?;
        Ok(Box::new(auto.expecting(expected()?)))
    }
}
