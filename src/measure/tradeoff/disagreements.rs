//! The queries that were answered wrongly by the most contenders, each with what is needed to ask it again.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::EnginePoint;
use crate::exact::Verdict;
use crate::geometry::Ray;
use crate::measure::bits;
use crate::measure::recording::Recording;

/// How many are listed.
const MOST: usize = 50;

/// A query that some contenders answered otherwise than exactly.
#[derive(Clone, Debug, Serialize)]
pub struct Disagreement {
    /// Its number in the recording.
    pub query: u32,
    /// The pixel, column and row.
    pub pixel: (u32, u32),
    /// The light, from 0.
    pub light: u32,
    /// The ray's origin.
    pub origin: [f32; 3],
    /// The ray's direction.
    pub direction: [f32; 3],
    /// Where the ray ends, in lengths of its direction; `None` if it does not.
    pub end: Option<f32>,
    /// Origin, direction and end as the bits of f32.
    pub bits: String,
    /// What exact arithmetic says: `blocked`, `clear`, or `tie` if the ray only touches a triangle at its end.
    pub verdict: &'static str,
    /// The contenders that said otherwise.
    pub by: Vec<String>,
}

/// How many queries any contender answered otherwise than exactly.
pub(super) fn count(points: &[EnginePoint]) -> usize {
    points.iter().flat_map(|point| &point.differing).collect::<BTreeSet<_>>().len()
}

/// The worst: wrong answers before ties, and those of many contenders before those of few.
pub(super) fn worst(
    recording: &Recording,
    points: &[EnginePoint],
    truth: &[Verdict],
) -> Vec<Disagreement> {
    let mut by: BTreeMap<u32, Vec<&EnginePoint>> = BTreeMap::new();
    for point in points {
        for &number in &point.differing {
            by.entry(number).or_default().push(point);
        }
    }
    let mut numbers: Vec<u32> = by.keys().copied().collect();
    numbers.sort_by_key(|number| {
        (truth[*number as usize] == Verdict::Tie, std::cmp::Reverse(by[number].len()), *number)
    });
    numbers.truncate(MOST);
    let describe = |number: u32| {
        let recorded = &recording.queries()[number as usize];
        let Ray { origin, direction, end } = recorded.query.ray;
        Disagreement {
            query: number,
            pixel: recorded.pixel,
            light: recorded.light,
            origin: origin.to_array(),
            direction: direction.to_array(),
            end: end.is_finite().then_some(end),
            bits: bits(&recorded.query.ray),
            verdict: truth[number as usize].name(),
            by: by[&number].iter().map(|point| point.name.clone()).collect(),
        }
    };
    numbers.into_iter().map(describe).collect()
}
