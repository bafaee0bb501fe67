//! What a contender may say of a query: the bounds that explain a wrong answer, or do not.

use std::ops::ControlFlow;
use std::sync::Arc;

use rayon::prelude::*;

use super::rounding::{Fate, fate};
use crate::geometry::lanes::Arithmetic;
use crate::geometry::{Ray, TriangleId, Triangles};
use crate::measure::contender::Contender;
use crate::measure::truth::Truths;
use crate::occlusion::embree_bounds::{at_least, at_most};
use crate::occlusion::{Backend, Brute, BuildOptions, Occlusion, Tally, Test, build};

/// What a contender claims of its answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Claim {
    /// They are the truth.
    Exact,
    /// They are those of this test in this arithmetic, asked of every triangle.
    Test(Test, Arithmetic),
    /// They lie between the bounds of `rtcOccluded1` that [`embree_bounds`](crate::occlusion::embree_bounds)
    /// computes bit for bit. Where verdicts stand before it, they may be the truth instead.
    Single {
        /// In scenes of Embree's robust mode.
        robust: bool,
        /// Of its kernels.
        arithmetic: Arithmetic,
        /// Its boxes are clipped, so that only rounding bounds it from below: default scenes of high quality.
        clipped: bool,
        /// What verdicts settle is the truth, which need not lie between the bounds.
        verdicts: bool,
    },
    /// They are what rounding can make of Embree's polynomials: packets.
    Rounded {
        /// In scenes of Embree's robust mode.
        robust: bool,
    },
}

impl Claim {
    /// What a contender claims.
    #[must_use]
    pub fn of(contender: &Contender) -> Self {
        let arithmetic = contender.options.arithmetic.unwrap_or_else(Arithmetic::of_this_cpu);
        match (contender.backend, contender.test) {
            (Backend::Embree, test) => Self::of_embree(contender, test == Test::Pluecker),
            (_, Test::Exact) => Self::Exact,
            (_, test) => Self::Test(test, arithmetic),
        }
    }

    #[cfg(feature = "embree")]
    fn of_embree(contender: &Contender, robust: bool) -> Self {
        if contender.is_packet() {
            return Self::Rounded { robust };
        }
        let options = contender.options.embree;
        let clipped = !robust && options.quality == crate::occlusion::Quality::High;
        let verdicts = !contender.method.verdicts.is_empty();
        Self::Single { robust, arithmetic: options.arithmetic(), clipped, verdicts }
    }

    #[cfg(not(feature = "embree"))]
    fn of_embree(contender: &Contender, robust: bool) -> Self {
        let verdicts = !contender.method.verdicts.is_empty();
        Self::Single { robust, arithmetic: Arithmetic::of_this_cpu(), clipped: false, verdicts }
    }

    /// In a word, for tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "the truth",
            Self::Test(..) => "its test",
            Self::Single { clipped: false, verdicts: false, .. } => "L to U",
            Self::Single { clipped: false, verdicts: true, .. } => "the truth, or L to U",
            Self::Single { clipped: true, verdicts: false, .. } => "rounding to U",
            Self::Single { clipped: true, verdicts: true, .. } => "the truth, or rounding to U",
            Self::Rounded { .. } => "rounding",
        }
    }
}

/// Whether an answer lies within the bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Ruling {
    pub within: bool,
    /// A triangle that may be reported, if the answer is "blocked" and within the bounds.
    pub witness: Option<TriangleId>,
}

/// Judges answers by one claim.
pub(super) struct Judge<'a> {
    claim: Claim,
    truths: &'a Truths,
    engines: Engines,
}

enum Engines {
    None,
    /// Of the test, over all triangles.
    Test(Box<dyn Occlusion>),
    /// What `rtcOccluded1` says at least and at most, and at most over all triangles.
    Single {
        lower: Box<dyn Occlusion>,
        upper: Box<dyn Occlusion>,
        utmost: Box<dyn Occlusion>,
    },
}

impl<'a> Judge<'a> {
    pub fn new(claim: Claim, truths: &'a Truths) -> Self {
        let Truths { triangles, walk } = truths;
        let engines = match claim {
            Claim::Exact | Claim::Rounded { .. } => Engines::None,
            Claim::Test(test, arithmetic) => Engines::Test(brute(test, arithmetic, triangles)),
            Claim::Single { robust, arithmetic, .. } => {
                let brute = Brute::new(triangles);
                Engines::Single {
                    lower: at_least(triangles, walk.clone(), robust, arithmetic),
                    upper: at_most(triangles, walk.clone(), robust, arithmetic),
                    utmost: at_most(triangles, brute, robust, arithmetic),
                }
            }
        };
        Self { claim, truths, engines }
    }

    /// Whether what is judged claims to be the truth.
    pub fn is_exact(&self) -> bool {
        self.claim == Claim::Exact
    }

    /// Whether the claim is about answers that are right, too.
    pub fn judges_right_ones(&self) -> bool {
        matches!(self.claim, Claim::Single { verdicts: false, .. })
    }

    /// Whether the claim is about ties that are called blocked, too.
    pub fn judges_ties(&self) -> bool {
        matches!(self.claim, Claim::Exact | Claim::Single { .. })
    }

    /// Judges an answer that is not the truth, or any if it [judges right ones](Self::judges_right_ones), too.
    pub fn rule(&self, ray: &Ray, blocked: bool) -> Ruling {
        let occluder = |engine: &dyn Occlusion| {
            engine.occluder(ray, &mut Tally::default()).map(|occluder| occluder.triangle)
        };
        let by_witness =
            |witness: Option<TriangleId>| Ruling { within: witness.is_some(), witness };
        let clear = |within: bool| Ruling { within, witness: None };
        match (&self.engines, self.claim) {
            (Engines::Test(engine), _) => {
                let witness = occluder(&**engine);
                Ruling { within: witness.is_some() == blocked, witness }
            }
            (Engines::Single { upper, utmost, .. }, _) if blocked => {
                by_witness(occluder(&**upper).or_else(|| occluder(&**utmost)))
            }
            (Engines::Single { lower, .. }, Claim::Single { robust, clipped, .. }) => {
                let is_proven = occluder(&**lower).is_some();
                clear(!is_proven || (clipped && !self.is_surely_met(ray, robust)))
            }
            (Engines::None, Claim::Rounded { robust }) if blocked => {
                by_witness(self.may_be_met(ray, robust))
            }
            (Engines::None, Claim::Rounded { robust }) => clear(!self.is_surely_met(ray, robust)),
            // A wrong answer of who claims the truth.
            _ => clear(false),
        }
    }

    /// Whether some triangle is reported, however it is rounded.
    fn is_surely_met(&self, ray: &Ray, robust: bool) -> bool {
        let mut met = false;
        self.truths.candidates(ray, |triangle| {
            met = self.fate(ray, triangle, robust) == Fate::Met;
            if met { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        met
    }

    /// A triangle that may be reported: one that the ray comes near, or else any.
    fn may_be_met(&self, ray: &Ray, robust: bool) -> Option<TriangleId> {
        let mut near = None;
        let may_be = |triangle: TriangleId| self.fate(ray, triangle, robust) != Fate::Missed;
        self.truths.candidates(ray, |triangle| {
            near = may_be(triangle).then_some(triangle);
            if near.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        let all = 0..self.truths.triangles.opaque_count();
        near.or_else(|| all.into_par_iter().find_any(|&triangle| may_be(triangle)))
    }

    fn fate(&self, ray: &Ray, triangle: TriangleId, robust: bool) -> Fate {
        fate(ray, &self.truths.triangles.get(triangle), robust)
    }
}

/// The test over all triangles, with nothing that could lose one.
pub(super) fn brute(
    test: Test,
    arithmetic: Arithmetic,
    triangles: &Arc<Triangles>,
) -> Box<dyn Occlusion> {
    let options = BuildOptions { arithmetic: Some(arithmetic), ..BuildOptions::default() };
    build(Backend::Brute, test, triangles, &options).expect("brute force is always to be had")
}
