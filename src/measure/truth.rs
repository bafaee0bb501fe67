//! What exact arithmetic says about each query.

use std::ops::ControlFlow;
use std::sync::Arc;

use crate::exact::{Verdict, certified, oracle};
use crate::geometry::lanes::Scalar;
use crate::geometry::{Ray, TriangleId, Triangles};
use crate::occlusion::{Bvh2, Cell, Visit, Walk};

/// The exact verdict on a query, and the triangle that gives it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Truth {
    /// Blocked, clear, or a tie.
    pub verdict: Verdict,
    /// A triangle that blocks the ray, or touches its end.
    pub triangle: Option<TriangleId>,
}

impl Truth {
    /// Whether light is blocked: a tie does not block.
    #[must_use]
    pub fn is_blocked(&self) -> bool {
        self.verdict == Verdict::Blocked
    }
}

/// Finds the truth: a culler that loses no triangle, and an exact test of those it names.
pub(super) struct Truths {
    pub triangles: Arc<Triangles>,
    pub walk: Arc<Bvh2>,
}

impl Truths {
    pub fn new(triangles: Arc<Triangles>) -> Self {
        let walk = Arc::new(Bvh2::new(&triangles));
        Self { triangles, walk }
    }

    /// By f64 with a bound, and expansions.
    pub fn certified(&self, ray: &Ray) -> Truth {
        self.ask(ray, |triangle| certified::verdict(ray, &self.triangles.get(triangle)))
    }

    /// By big integers.
    pub fn oracle(&self, ray: &Ray) -> Truth {
        self.ask(ray, |triangle| oracle::verdict(ray, &self.triangles.get(triangle)))
    }

    fn ask(&self, ray: &Ray, verdict: impl Fn(TriangleId) -> Verdict) -> Truth {
        let mut truth = Truth { verdict: Verdict::Clear, triangle: None };
        self.candidates(ray, |triangle| {
            match verdict(triangle) {
                Verdict::Clear => {}
                Verdict::Tie => {
                    truth = Truth { verdict: Verdict::Tie, triangle: Some(triangle) };
                }
                Verdict::Blocked => {
                    truth = Truth { verdict: Verdict::Blocked, triangle: Some(triangle) };
                    return ControlFlow::Break(());
                }
            }
            ControlFlow::Continue(())
        });
        truth
    }

    /// Calls `each` for every opaque triangle that the ray might meet, until it breaks.
    pub fn candidates(&self, ray: &Ray, each: impl FnMut(TriangleId) -> ControlFlow<()>) {
        if ray.is_valid() {
            let opaque = self.triangles.opaque_count();
            self.walk.walk::<Scalar<false, false>, _>(
                ray,
                &mut Candidates { opaque, end: ray.end, each },
            );
        }
    }
}

struct Candidates<F> {
    opaque: TriangleId,
    end: f32,
    each: F,
}

impl<F: FnMut(TriangleId) -> ControlFlow<()>> Visit for Candidates<F> {
    fn visit(&mut self, _: Cell, triangles: &[TriangleId]) -> ControlFlow<()> {
        triangles.iter().filter(|id| **id < self.opaque).try_for_each(|&id| (self.each)(id))
    }

    fn end(&self) -> f32 {
        self.end
    }
}
