//! `shaft`: queries to one light are answered together, by the shaft between the light and their origins.
//!
//! Neighbouring queries to a light all end in one point, or run in parallel. What may block any of them lies in
//! the shaft from the light to the box of their origins (Haines & Wallace 1991); one walk through the tree finds it
//! for 256 queries. What is found is cast on all of them, sixteen at a time, by planes that the queries share.
//! A shaft with nothing in it proves them lit, all at once. Nothing is prepared a light, so many lights cost no
//! more than few.
//!
//! Wins where neighbouring queries start near each other, the more samples the better. Bundles that do not stay together,
//! as those that mirrors see, are put together anew by the directions in which the light sees them (`order`, `view`); where
//! that does not help, parts of a bundle go on by themselves, in the end ray by ray.
//!
//! With a light buffer behind it, bundles that do not stay together are left to that: `shaft+light-buffer`.
//!
//! Exact: a query is settled by a plane that is certain by more than its error bound (`planes`), else by the
//! exact test. Rays that are not to their light, bit for bit, are passed on.
//!
//! Haines, Wallace: Shaft Culling for Efficient Ray-Cast Radiosity. Eurographics Workshop on Rendering 1991.
//! Dmitriev, Havran, Seidel: Faster Ray Tracing with SIMD Shaft Culling. MPI-I-2004-4-006, 2004.

mod alone;
mod bundle;
mod cast;
mod cluster;
mod columns;
mod frustum;
mod kept;
mod nearest;
mod order;
mod planes;
mod rays;
mod source;
mod view;
mod walk;

use std::sync::{Arc, Mutex, PoisonError};

use bundle::{BUNDLE, Chosen, PACKET, Places};
use columns::Read;
use order::SortByDirection;
use source::Source;
use walk::{Around, Walker};

use super::stock::Stock;
use super::{Glass, Panes, ShadowQuery, Verdict, VerdictKind};
use crate::geometry::Triangles;
use crate::geometry::lanes::{Available, Lanes, LanesJob};
use crate::occlusion::{Clusters, Tally};

/// Bundles whose packets are larger than so many clusters are put together anew, by direction,
/// unless packets that are put together so are expected to be as large.
const APART: f32 = 0.45;

/// So few packets are not sorted.
const WORTH_SORTING: usize = 4;

/// Shafts to the lights of a scene.
pub(super) struct Shafts {
    triangles: Arc<Triangles>,
    sources: Vec<Source>,
    /// None if the memory does not suffice.
    clusters: Option<Arc<Clusters>>,
    /// What is said then.
    aside: Option<String>,
    /// Bytes of them, if nobody else counts them.
    bytes: usize,
    /// Shafts among the transparent triangles, if there are any.
    glass: Option<Box<Self>>,
    /// Whether bundles that do not stay together are left to a light buffer.
    leaves_spread: bool,
    arithmetic: Available,
    /// Walkers that nobody uses now; as many are made as threads ask at once, 150 KiB each and some 28 bytes a query
    /// of the largest call.
    idle: Mutex<Vec<Box<Walker>>>,
}

impl Shafts {
    /// Groups the triangles; there is nothing to prepare for lights.
    pub fn new(stock: &Stock<'_>) -> Self {
        let (clusters, bytes) = stock.clusters();
        let glass = stock.glass().map(|(clusters, bytes)| {
            Box::new(Self::among(stock, Some(clusters), bytes, false, None))
        });
        let leaves_spread = stock.verdicts.contains(VerdictKind::LightBuffer);
        Self::among(stock, clusters, bytes, leaves_spread, glass)
    }

    fn among(
        stock: &Stock<'_>,
        clusters: Option<Arc<Clusters>>,
        bytes: usize,
        leaves_spread: bool,
        glass: Option<Box<Self>>,
    ) -> Self {
        Self {
            aside: clusters.is_none().then(|| stock.without_clusters()),
            triangles: stock.scene.triangles.clone(),
            sources: stock.scene.lights.iter().map(Source::new).collect(),
            clusters,
            bytes,
            glass,
            leaves_spread,
            arithmetic: Available::newest(),
            idle: Mutex::new(Vec::new()),
        }
    }

    fn settle_with(
        &self,
        walker: &mut Walker,
        clusters: &Clusters,
        light: usize,
        queries: &[ShadowQuery],
        mut told: Told<'_>,
        tally: &mut Tally,
    ) {
        let source = &self.sources[light];
        let mut columns = std::mem::take(&mut walker.columns);
        let mut order = std::mem::take(&mut walker.order);
        self.arithmetic.run(Read { columns: &mut columns, source, queries });
        let mut walk = |places, leaves_spread| {
            let queries = Chosen::new(queries, &columns, places);
            let around = Around { clusters, triangles: &self.triangles, queries, leaves_spread };
            match &mut told {
                Told::Blocked(settled) => {
                    if self.arithmetic.run(Walk::<false> { walker, source, around, tally }) {
                        walker.bundle.tell(places, settled);
                    }
                }
                Told::Met(panes) => {
                    if self.arithmetic.run(Walk::<true> { walker, source, around, tally }) {
                        walker.bundle.tell_all(places, panes);
                    }
                }
            }
        };
        let size = columns.extent_if_sorted().max(APART * clusters.typical_extent());
        let is_worth_sorting = columns.asked.len() > WORTH_SORTING;
        order.packets.clear();
        for first in (0..queries.len()).step_by(BUNDLE) {
            let count = BUNDLE.min(queries.len() - first);
            let packets = first / PACKET..(first + count).div_ceil(PACKET);
            let is_apart = columns.typical_extent(packets.clone()) > size;
            if is_apart && is_worth_sorting {
                order.packets.extend(packets.map(|packet| packet as u32));
            } else {
                walk(Places::Row { first, count }, is_apart && self.leaves_spread);
            }
        }
        if !order.packets.is_empty() {
            self.arithmetic.run(SortByDirection { order: &mut order, columns: &columns, source });
            for places in order.places.chunks(BUNDLE) {
                walk(Places::These(places), self.leaves_spread);
            }
        }
        (walker.columns, walker.order) = (columns, order);
    }

    fn settle_by_a_walker(
        &self,
        light: usize,
        queries: &[ShadowQuery],
        told: Told<'_>,
        tally: &mut Tally,
    ) {
        let Some(clusters) = &self.clusters else { return };
        let mut walker = self.walker();
        walker.begin();
        self.settle_with(&mut walker, clusters, light, queries, told, tally);
        self.idle.lock().unwrap_or_else(PoisonError::into_inner).push(walker);
    }

    fn walker(&self) -> Box<Walker> {
        let mut idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner);
        idle.pop().unwrap_or_else(|| Box::new(Walker::new()))
    }
}

/// What is told of queries.
enum Told<'a> {
    /// Whether they are blocked.
    Blocked(&'a mut [Option<bool>]),
    /// All that they meet.
    Met(&'a mut Panes),
}

impl Verdict for Shafts {
    fn settle_many(
        &self,
        light: usize,
        queries: &[ShadowQuery],
        settled: &mut [Option<bool>],
        tally: &mut Tally,
    ) {
        self.settle_by_a_walker(light, queries, Told::Blocked(settled), tally);
    }

    fn glass(&self) -> Option<&dyn Glass> {
        self.glass.as_deref().map(|glass| glass as &dyn Glass)
    }

    fn memory(&self) -> usize {
        self.bytes + self.glass.as_ref().map_or(0, |glass| glass.bytes)
    }

    fn notes(&self) -> Vec<String> {
        self.aside.iter().cloned().collect()
    }
}

impl Glass for Shafts {
    fn find(&self, light: usize, queries: &[ShadowQuery], panes: &mut Panes, tally: &mut Tally) {
        self.settle_by_a_walker(light, queries, Told::Met(panes), tally);
    }
}

struct Walk<'a, 'b, const ALL: bool> {
    walker: &'a mut Walker,
    source: &'a Source,
    around: Around<'b>,
    tally: &'a mut Tally,
}

impl<const ALL: bool> LanesJob for Walk<'_, '_, ALL> {
    type Answer = bool;

    #[inline(always)]
    fn run<L: Lanes>(self) -> bool {
        self.walker.walk::<L, ALL>(self.source, &self.around, self.tally)
    }
}

#[cfg(test)]
mod strategies {
    use glam::Vec3;
    use proptest::prelude::*;

    /// A point of a cube around the origin, which reaches so far.
    pub fn point(reach: f32) -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(-reach..reach).prop_map(Vec3::from_array)
    }
}
