//! What settles a query before anything is traversed.

use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;

use super::{Glass, ShadowQuery, ShadowTally, VerdictKind};
use crate::occlusion::Tally;

/// Settles some queries outright, from what was prepared for their light; shared by all workers.
///
/// A verdict may only say what it can prove of the ray's bits in exact arithmetic: so before a backend
/// with the exact test its answers are the backend's, bit for bit, whatever the order of queries and
/// the number of threads. It passes on rays that are not valid, and rays that do not end at its light.
pub trait Verdict: Send + Sync {
    /// Whether queries towards one light are blocked, as far as they are not settled yet; `None` stays where that is
    /// not proven. What it costs goes to `tally`.
    fn settle_many(
        &self,
        light: usize,
        queries: &[ShadowQuery],
        settled: &mut [Option<bool>],
        tally: &mut Tally,
    );

    /// What finds the *transparent* triangles that queries meet, if it does that too.
    fn glass(&self) -> Option<&dyn Glass> {
        None
    }

    /// Bytes of what was prepared so far.
    fn memory(&self) -> usize;

    /// Seconds spent on what was prepared while queries were answered, over all threads.
    fn lazy_seconds(&self) -> f64 {
        0.0
    }

    /// What the user should know: that it had to be made coarser, or steps aside.
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }
}

impl<V: Verdict> Verdict for Arc<V> {
    fn settle_many(
        &self,
        light: usize,
        queries: &[ShadowQuery],
        settled: &mut [Option<bool>],
        tally: &mut Tally,
    ) {
        V::settle_many(self, light, queries, settled, tally);
    }

    fn glass(&self) -> Option<&dyn Glass> {
        V::glass(self)
    }

    fn memory(&self) -> usize {
        V::memory(self)
    }

    fn lazy_seconds(&self) -> f64 {
        V::lazy_seconds(self)
    }

    fn notes(&self) -> Vec<String> {
        V::notes(self)
    }
}

/// Settles one by one what is not settled yet.
pub(super) fn settle_each(
    queries: &[ShadowQuery],
    settled: &mut [Option<bool>],
    mut settle: impl FnMut(&ShadowQuery) -> Option<bool>,
) {
    for (query, settled) in queries.iter().zip(settled) {
        if settled.is_none() {
            *settled = settle(query);
        }
    }
}

/// What a verdict took to prepare.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VerdictReport {
    /// Which one.
    pub verdict: VerdictKind,
    /// Seconds that preparing took, those while queries were answered included.
    pub build_seconds: f64,
    /// Bytes of what was prepared so far.
    pub bytes: usize,
    /// What the user should know.
    pub notes: Vec<String>,
}

/// The queries that one verdict was asked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Settled {
    /// Proved lit.
    pub lit: u64,
    /// Proved blocked.
    pub blocked: u64,
    /// Not settled.
    pub passed_on: u64,
}

impl Settled {
    fn of(settled: &[Option<bool>]) -> Self {
        let (lit, blocked) = (count(settled, Some(false)), count(settled, Some(true)));
        Self { lit, blocked, passed_on: settled.len() as u64 - lit - blocked }
    }
}

/// How many are such. In sums of a byte that do not overflow: those are added sixteen at once.
fn count(settled: &[Option<bool>], such: Option<bool>) -> u64 {
    let sum = |run: &[Option<bool>]| run.iter().map(|&one| u8::from(one == such)).sum::<u8>();
    settled.chunks(usize::from(u8::MAX)).map(|run| u64::from(sum(run))).sum()
}

impl std::ops::AddAssign for Settled {
    fn add_assign(&mut self, other: Self) {
        self.lit += other.lit;
        self.blocked += other.blocked;
        self.passed_on += other.passed_on;
    }
}

/// Verdicts that are asked one after the other; often none.
#[derive(Default)]
pub struct Verdicts<'a>(Vec<Stacked<'a>>);

struct Stacked<'a> {
    kind: VerdictKind,
    verdict: Box<dyn Verdict + 'a>,
    build_seconds: f64,
}

impl<'a> Verdicts<'a> {
    /// Prepares a verdict, to be asked after those before it.
    pub fn push(&mut self, kind: VerdictKind, prepare: impl FnOnce() -> Box<dyn Verdict + 'a>) {
        let start = Instant::now();
        let verdict = prepare();
        self.0.push(Stacked { kind, verdict, build_seconds: start.elapsed().as_secs_f64() });
    }

    /// Which they are, in the order in which they are asked.
    pub fn kinds(&self) -> impl Iterator<Item = VerdictKind> {
        self.0.iter().map(|stacked| stacked.kind)
    }

    /// Whether there are none.
    #[must_use]
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Settles what any of them can; a call for each, however many queries. Gives what all of
    /// them together made of it.
    pub fn settle(
        &self,
        light: usize,
        queries: &[ShadowQuery],
        settled: &mut Vec<Option<bool>>,
        tally: &mut ShadowTally,
    ) -> Settled {
        settled.clear();
        settled.resize(queries.len(), None);
        let mut before = Settled { passed_on: queries.len() as u64, ..Settled::default() };
        for Stacked { kind, verdict, .. } in &self.0 {
            verdict.settle_many(light, queries, settled, &mut tally.backend);
            let after = Settled::of(settled);
            tally.verdicts[kind.index()] += Settled {
                lit: after.lit - before.lit,
                blocked: after.blocked - before.blocked,
                passed_on: after.passed_on,
            };
            before = after;
        }
        before
    }

    /// What finds the transparent triangles that queries meet, if one of them does.
    #[must_use]
    pub fn glass(&self) -> Option<&dyn Glass> {
        self.0.iter().find_map(|stacked| stacked.verdict.glass())
    }

    /// Bytes of what was prepared so far.
    #[must_use]
    pub fn memory(&self) -> usize {
        self.0.iter().map(|stacked| stacked.verdict.memory()).sum()
    }

    /// What each took to prepare.
    #[must_use]
    pub fn reports(&self) -> Vec<VerdictReport> {
        let report = |Stacked { kind, verdict, build_seconds }: &Stacked<'_>| VerdictReport {
            verdict: *kind,
            build_seconds: build_seconds + verdict.lazy_seconds(),
            bytes: verdict.memory(),
            notes: verdict.notes(),
        };
        self.0.iter().map(report).collect()
    }
}
