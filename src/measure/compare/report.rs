//! What a comparison found.

use serde::{Serialize, Serializer};

use super::Claim;
use crate::exact::Verdict;
use crate::geometry::{Ray, TriangleId};
use crate::measure::wilson::PerMillion;
use crate::measure::{bits, count};

/// How an answer is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// "Blocked", where the exact verdict is that light passes.
    FalseBlocked,
    /// "Clear", where the exact verdict is that it is blocked: a leak.
    FalseClear,
    /// Right, or about a tie, but not what the contender claims to compute.
    OutOfBounds,
}

impl Kind {
    /// In words.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::FalseBlocked => "false-blocked",
            Self::FalseClear => "false-clear",
            Self::OutOfBounds => "out-of-bounds",
        }
    }
}

/// One answer that is not the truth, or not within its bounds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Disagreement {
    /// Whose: place in [`Report::contenders`].
    pub contender: usize,
    /// Place of the query in the recording.
    pub query: usize,
    /// Column and row of the pixel.
    pub pixel: (u32, u32),
    /// Index of the light.
    pub light: u32,
    /// The query, bit for bit.
    #[serde(serialize_with = "serialize_ray")]
    pub ray: Ray,
    /// How it is wrong.
    pub kind: Kind,
    /// What the contender said.
    pub blocked: bool,
    /// The oracle's verdict.
    #[serde(serialize_with = "serialize_verdict")]
    pub exact: Verdict,
    /// The triangle that blocks the ray or touches its end; or one that the contender may have reported.
    pub triangle: Option<TriangleId>,
    /// Whether it is what the contender claims to compute.
    pub explained: bool,
}

/// What one contender said.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The contender.
    pub name: String,
    /// What explains its wrong answers.
    pub claim: &'static str,
    /// Whether it claims to be right.
    pub is_exact: bool,
    /// Right answers, ties apart.
    pub agree: u64,
    /// Wrong ones where light passes.
    pub false_blocked: u64,
    /// Wrong ones where it is blocked.
    pub false_clear: u64,
    /// Of the queries that are no ties.
    pub false_blocked_per_million: PerMillion,
    /// Of the queries that are no ties.
    pub false_clear_per_million: PerMillion,
    /// Ties that it called blocked.
    pub ties_blocked: u64,
    /// Answers that nothing explains; all that are wrong, if it is exact.
    pub unexplained: u64,
}

impl Row {
    pub(super) fn new(
        name: &str,
        claim: Claim,
        [blocked, clear, _]: &[u64; 3],
        ties_blocked: u64,
        found: &[Disagreement],
    ) -> Self {
        let count = |wanted: &dyn Fn(&Disagreement) -> bool| {
            found.iter().filter(|found| wanted(found)).count() as u64
        };
        // A tie that an exact contender calls blocked is an error, but stays apart from the shares.
        let of_kind = |kind| count(&|found| found.kind == kind && found.exact != Verdict::Tie);
        let (false_blocked, false_clear) = (of_kind(Kind::FalseBlocked), of_kind(Kind::FalseClear));
        let decided = blocked + clear;
        Self {
            name: name.to_owned(),
            claim: claim.name(),
            is_exact: claim == Claim::Exact,
            agree: decided - false_blocked - false_clear,
            false_blocked,
            false_clear,
            false_blocked_per_million: PerMillion::new(false_blocked, decided),
            false_clear_per_million: PerMillion::new(false_clear, decided),
            ties_blocked,
            unexplained: count(&|found| !found.explained),
        }
    }
}

/// How the truth was checked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Checks {
    /// Queries put to the oracle.
    pub by_oracle: u64,
    /// Queries put to brute force.
    pub by_brute_force: u64,
    /// Times that one of them said otherwise: a defect of ours, if any.
    pub contradicted: u64,
}

/// What a comparison found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Name of the scene.
    pub scene: String,
    /// Its triangles.
    pub triangles: usize,
    /// Its lights.
    pub lights: usize,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Queries asked of each contender.
    pub queries: u64,
    /// Those whose exact verdict is blocked.
    pub blocked: u64,
    /// Clear.
    pub clear: u64,
    /// A tie.
    pub ties: u64,
    /// A row a contender.
    pub contenders: Vec<Row>,
    /// How the truth was checked.
    pub checks: Checks,
    /// All of them, contender by contender.
    pub disagreements: Vec<Disagreement>,
}

impl Report {
    /// Why the comparison failed, in one line; none if it did not.
    #[must_use]
    pub fn failure(&self) -> Option<String> {
        let first = |is_exact: bool| {
            self.contenders.iter().find(|row| row.is_exact == is_exact && row.unexplained > 0)
        };
        if self.checks.contradicted > 0 {
            let times = count(self.checks.contradicted, "time");
            return Some(format!("the truth was contradicted {times} by oracle or brute force"));
        }
        if let Some(Row { name, unexplained, .. }) = first(true) {
            let times = count(*unexplained, "time");
            return Some(format!("{name} claims to be exact and was wrong {times}"));
        }
        let Row { name, unexplained, .. } = first(false)?;
        let answers = count(*unexplained, "answer");
        Some(format!("{name} gave {answers} outside its bounds: nothing explains that"))
    }
}

fn serialize_verdict<S: Serializer>(verdict: &Verdict, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(verdict.name())
}

fn serialize_ray<S: Serializer>(ray: &Ray, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&bits(ray))
}
