//! A campaign: the stages held against each other on many hard queries.
//!
//! Each query is decided by the pipeline (filter, f64, expansions) and by expansions alone; one in
//! [`ORACLE_SAMPLE`] also by the oracle. Queries depend on class
//! and index only, so a campaign can be cut into ranges and repeated anywhere.

use std::ops::{Add, Range};

use rayon::prelude::*;
use serde::Serialize;

use super::adversary::{Class, query};
use super::certified::{Stage, decide, verdict_by_expansions};
use super::filter::Exact;
use super::oracle::{self, Verdict};
use crate::geometry::intersect::{RayLanes, TriangleTest};
use crate::geometry::lanes::Scalar;
use crate::geometry::{Ray, Triangle};

/// One query in this many is also put to the oracle, which takes microseconds.
pub const ORACLE_SAMPLE: u64 = 100;

/// What a campaign found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Summary {
    /// Queries made.
    pub queries: u64,
    /// Blocked ones.
    pub blocked: u64,
    /// Clear ones.
    pub clear: u64,
    /// Ties.
    pub ties: u64,
    /// Decided by the f32 filter.
    pub by_filter: u64,
    /// Decided in f64.
    pub by_double: u64,
    /// Decided by expansions.
    pub by_expansion: u64,
    /// Put to the oracle as well.
    pub by_oracle: u64,
    /// Queries on which any two disagreed. Anything but zero is a defect.
    pub wrong: u64,
}

impl Add for Summary {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            queries: self.queries + other.queries,
            blocked: self.blocked + other.blocked,
            clear: self.clear + other.clear,
            ties: self.ties + other.ties,
            by_filter: self.by_filter + other.by_filter,
            by_double: self.by_double + other.by_double,
            by_expansion: self.by_expansion + other.by_expansion,
            by_oracle: self.by_oracle + other.by_oracle,
            wrong: self.wrong + other.wrong,
        }
    }
}

/// Puts the queries of a class with these indices to every stage, on all threads.
#[must_use]
pub fn campaign(class: Class, indices: Range<u64>) -> Summary {
    indices.into_par_iter().map(|index| examine(class, index)).reduce(Summary::default, Add::add)
}

fn examine(class: Class, index: u64) -> Summary {
    let (ray, triangle) = query(class, index);
    let truth = verdict_by_expansions(&ray, &triangle);
    let (verdict, stage) = decide(&ray, &triangle);
    let is_sampled = index.is_multiple_of(ORACLE_SAMPLE);
    let claims = [filter::<false>(&ray, &triangle), filter::<true>(&ray, &triangle)];

    let is_blocked = truth == Verdict::Blocked;
    let is_wrong = verdict != truth
        || claims.into_iter().flatten().any(|claim| claim != is_blocked)
        || (is_sampled && oracle::verdict(&ray, &triangle) != truth);
    let by_filter = claims[0].is_some();
    Summary {
        queries: 1,
        blocked: u64::from(is_blocked),
        clear: u64::from(truth == Verdict::Clear),
        ties: u64::from(truth == Verdict::Tie),
        by_filter: u64::from(by_filter),
        by_double: u64::from(!by_filter && stage == Stage::Double),
        by_expansion: u64::from(!by_filter && stage == Stage::Expansion),
        by_oracle: u64::from(is_sampled),
        wrong: u64::from(is_wrong),
    }
}

/// Whether the triangle blocks the ray, if the filter is certain; fused or not.
fn filter<const FUSED: bool>(ray: &Ray, triangle: &Triangle) -> Option<bool> {
    if !ray.is_valid() {
        return None;
    }
    let corners = triangle.map(|corner| corner.to_array().map(Scalar::<FUSED, false>));
    let claims = Exact::claims(&RayLanes::new(ray), &corners);
    (claims.open == 0).then_some(claims.certain == 1)
}
