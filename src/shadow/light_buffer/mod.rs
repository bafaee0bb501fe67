//! `light-buffer`: Haines and Greenberg's light buffer (§4 of the paper). Around each light, a cube of cells
//! that list what might cast a shadow in their direction, nearest to the light first; a parallel grid
//! for a directional light. A query looks up its cell and tests what is listed before its own depth:
//! nothing is traversed.
//!
//! Wins where many queries go to a light: a query tests the few clusters that its cell shows, with one
//! vector test each, and if none of them blocks it is proven lit. Costs a structure a
//! light; so blocks of cells are made when a query first asks them, and nothing for directions that no
//! query comes from. Lists hold clusters of eight triangles (`occlusion::clusters`), and sixteen bits an entry say
//! in which sixteenths of the cell the cluster is seen at all. Where one triangle covers a whole cell, all queries
//! behind it are dark without a test.
//!
//! Exact because the lists are conservative (`view` has the roundings, `footprint` the padding), and what
//! is listed is tested by the exact test on the query's own ray. Where the memory does not suffice, blocks are left out,
//! and their queries passed on.
//!
//! Haines, Greenberg: The Light Buffer: A Ray Tracer Shadow Testing Accelerator. IEEE CG&A 6(9), 1986.

mod block;
mod footprint;
mod map;
mod view;

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, OnceLock};
use std::time::Instant;

use block::{Asked, Block};
use map::LightMap;

use super::stock::Stock;
use super::{Budget, ShadowQuery, Verdict};
use crate::exact::Exact;
use crate::geometry::Triangles;
use crate::geometry::intersect::RayLanes;
use crate::geometry::lanes::{Available, Lanes, LanesJob};
use crate::occlusion::{Clusters, Tally, WIDTH};
use crate::scene::Light;

/// The light buffers of a scene, filled as queries ask.
pub(super) struct LightBuffer {
    triangles: Arc<Triangles>,
    lights: Vec<Light>,
    /// None if the memory does not suffice.
    clusters: Option<Arc<Clusters>>,
    /// What is said then.
    aside: Option<String>,
    maps: Vec<OnceLock<Option<LightMap>>>,
    arithmetic: Available,
    budget: Arc<Budget>,
    bytes: AtomicUsize,
    /// Of blocks: their bytes, and the clusters in them.
    block_bytes: AtomicUsize,
    block_members: AtomicUsize,
    nanoseconds: AtomicU64,
    /// Parts of the view that did not fit into the budget, and their bytes.
    refused: AtomicU64,
    refused_bytes: AtomicU64,
}

impl LightBuffer {
    /// Groups the triangles; what lights see is made when they are asked.
    pub fn new(stock: &Stock<'_>) -> Self {
        let Stock { scene, budget, .. } = stock;
        let (clusters, bytes) = stock.clusters();
        Self {
            triangles: scene.triangles.clone(),
            lights: scene.lights.clone(),
            aside: clusters.is_none().then(|| {
                format!("{}, as what lights see takes room, too", stock.without_clusters())
            }),
            clusters,
            maps: scene.lights.iter().map(|_| OnceLock::new()).collect(),
            arithmetic: Available::newest(),
            budget: budget.clone(),
            bytes: AtomicUsize::new(bytes),
            block_bytes: AtomicUsize::new(0),
            block_members: AtomicUsize::new(0),
            nanoseconds: AtomicU64::new(0),
            refused: AtomicU64::new(0),
            refused_bytes: AtomicU64::new(0),
        }
    }

    fn map(&self, light: usize) -> Option<&LightMap> {
        let clusters = self.clusters.as_ref()?;
        let make = || {
            let start = Instant::now();
            let bounds = self.triangles.bounds()?;
            let map = LightMap::new(&self.lights[light], &bounds, clusters.all())?;
            let fits = self.admit(map.memory());
            self.nanoseconds.fetch_add(start.elapsed().as_nanos() as u64, Relaxed);
            fits.then_some(map)
        };
        self.maps[light].get_or_init(make).as_ref()
    }

    /// Whether so many more bytes fit into the budget; counts them if they do.
    fn admit(&self, bytes: usize) -> bool {
        let fits = self.budget.take(bytes);
        if fits {
            self.bytes.fetch_add(bytes, Relaxed);
        } else {
            self.refuse(bytes);
        }
        fits
    }

    fn refuse(&self, bytes: usize) {
        self.refused.fetch_add(1, Relaxed);
        self.refused_bytes.fetch_add(bytes as u64, Relaxed);
    }

    /// A block of so many clusters, if it fits into the budget. One that takes too much is not even made if it is as
    /// large to a cluster as those before it.
    fn admit_block(&self, members: usize, make: impl FnOnce() -> Block) -> Option<Block> {
        let (bytes, known) = (self.block_bytes.load(Relaxed), self.block_members.load(Relaxed));
        let likely = (members * bytes).checked_div(known).unwrap_or(0);
        if self.budget.left() < likely as u64 {
            self.refuse(likely);
            return None;
        }
        let start = Instant::now();
        let block = make();
        self.nanoseconds.fetch_add(start.elapsed().as_nanos() as u64, Relaxed);
        self.block_bytes.fetch_add(block.memory(), Relaxed);
        self.block_members.fetch_add(members, Relaxed);
        self.admit(block.memory()).then_some(block)
    }

    #[inline(always)]
    fn settle_one<L: Lanes>(
        &self,
        map: &LightMap,
        clusters: &Clusters,
        query: &ShadowQuery,
        tally: &mut Tally,
    ) -> Option<bool> {
        let (all, ray) = (clusters.all(), &query.ray);
        let Asked { keys, clusters, last, fine, dark } = map.ask(ray, all, self)?;
        if dark {
            return Some(true);
        }
        let lanes = RayLanes::<L>::new(ray);
        let (mut blocked, mut place) = (false, 0);
        let mut near = map.near.iter();
        tally.cells += 1;
        while !blocked {
            let cluster = if let Some(&cluster) = near.next() {
                cluster
            } else {
                // Sorted by depth: the first entry behind the query ends the list.
                while place < keys.len() && keys[place] <= last && keys[place] & fine == 0 {
                    place += 1;
                }
                if place == keys.len() || keys[place] > last {
                    break;
                }
                place += 1;
                clusters[place - 1]
            };
            tally.triangle_tests += WIDTH as u64;
            let cluster = &all[cluster as usize];
            let stop = |_| ControlFlow::Break(());
            blocked = cluster.test_each::<Exact, L>(ray, &lanes, &self.triangles, stop).is_break();
        }
        Some(blocked)
    }
}

impl Verdict for LightBuffer {
    fn settle_many(
        &self,
        light: usize,
        queries: &[ShadowQuery],
        settled: &mut [Option<bool>],
        tally: &mut Tally,
    ) {
        if settled.iter().all(Option::is_some) {
            // Nothing is made for a light that nobody asks about.
            return;
        }
        if let (Some(map), Some(clusters)) = (self.map(light), &self.clusters) {
            self.arithmetic.run(Settle { buffer: self, map, clusters, queries, settled, tally });
        }
    }

    fn memory(&self) -> usize {
        self.bytes.load(Relaxed)
    }

    fn lazy_seconds(&self) -> f64 {
        self.nanoseconds.load(Relaxed) as f64 * 1e-9
    }

    fn notes(&self) -> Vec<String> {
        let refused = self.refused.load(Relaxed);
        let mut notes = Vec::new();
        if let Some(aside) = &self.aside {
            notes.push(aside.clone());
        } else if refused > 0 {
            let advice = self.budget.advice(self.refused_bytes.load(Relaxed));
            notes.push(format!("leaves {refused} parts of what lights see to the backend: they do not fit into the memory; {advice}"));
        }
        notes
    }
}

struct Settle<'a> {
    buffer: &'a LightBuffer,
    map: &'a LightMap,
    clusters: &'a Clusters,
    queries: &'a [ShadowQuery],
    settled: &'a mut [Option<bool>],
    tally: &'a mut Tally,
}

impl LanesJob for Settle<'_> {
    type Answer = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { buffer, map, clusters, queries, settled, tally } = self;
        for (query, settled) in queries.iter().zip(settled) {
            if settled.is_none() {
                *settled = buffer.settle_one::<L>(map, clusters, query, tally);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::exact::certified;
    use crate::scene::{Draft, DraftTriangle};
    use crate::shadow::VerdictSet;

    /// A bumpy sheet of triangles, closed in itself.
    fn globe(rings: u32) -> Vec<[Vec3; 3]> {
        let corner = |ring: u32, part: u32| {
            let theta = std::f32::consts::PI * ring as f32 / rings as f32;
            let phi = std::f32::consts::TAU * (part % rings) as f32 / rings as f32;
            let bump = 1.0 + 0.05 * ((7 * ring + 3 * (part % rings)) % 5) as f32;
            bump * Vec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin())
        };
        let mut mesh = Vec::new();
        for ring in 0..rings {
            for part in 0..rings {
                let [a, b] = [corner(ring, part), corner(ring, part + 1)];
                let [c, d] = [corner(ring + 1, part), corner(ring + 1, part + 1)];
                mesh.extend([[a, b, c], [b, d, c]]);
            }
        }
        mesh
    }

    #[test]
    fn whatever_blocks_a_ray_is_listed_and_what_is_dark_is_blocked_for_lights_anywhere() {
        for rings in [4, 7, 24] {
            lists_all(&globe(rings));
        }
    }

    fn lists_all(mesh: &[[Vec3; 3]]) {
        let [a, b, c] = mesh[mesh.len() * 2 / 5];
        let lights = [a, b + 0.5 * (c - b), a.lerp(b, 0.3), Vec3::splat(0.1), 3.0 * a];
        let point =
            |position: Vec3| Light::Point { position: position.as_dvec3(), intensity: Vec3::ONE };
        let triangle = |corners: &[Vec3; 3]| DraftTriangle {
            corners: corners.map(|corner| corner.as_dvec3()),
            normals: [Vec3::ZERO; 3],
            material: 0,
        };
        let triangles = mesh.iter().map(triangle).collect();
        let lights = lights.map(point).to_vec();
        let scene = Draft { triangles, lights, ..Draft::default() }.finish().unwrap();
        let buffer = LightBuffer::new(&Stock::new(
            &scene,
            Arc::new(Budget::new(u64::MAX)),
            VerdictSet::NONE,
        ));
        let all = buffer.clusters.as_ref().unwrap().all();
        let (mut blockers, mut dark) = (0, 0);
        for (number, light) in scene.lights.iter().enumerate() {
            let map = buffer.map(number).expect("few clusters are near");
            let Light::Point { position, .. } = light else { unreachable!("all are points") };
            let position = position.as_vec3();
            let places = globe(13).into_iter();
            let places = places.flat_map(|[a, b, c]| [0.9 * a, 1.3 * b, 0.3 * c]);
            // And where two or three faces of the cube meet.
            let sides = [-1.0, -0.4, 0.4, 1.0];
            let corners = sides.into_iter().flat_map(|x| {
                sides.into_iter().flat_map(move |y| sides.into_iter().map(move |z| (x, y, z)))
            });
            let corners = corners.map(|(x, y, z)| position + 0.7 * Vec3::new(x, y, z));
            for origin in places.chain(corners) {
                let ray = light.shadow_ray(origin);
                let Some(asked) = map.ask(&ray, all, &buffer) else { continue };
                let blocked = (0..scene.triangles.len() as u32)
                    .any(|id| certified::blocks(&ray, &scene.triangles.get(id)));
                assert!(blocked || !asked.dark, "{ray:?} is in the light");
                dark += u32::from(asked.dark);
                for (number, cluster) in (0u32..).zip(all) {
                    let blocks = |&id: &u32| certified::blocks(&ray, &scene.triangles.get(id));
                    if !cluster.ids().iter().any(blocks) {
                        continue;
                    }
                    let mut entries = asked.keys.iter().zip(asked.clusters);
                    let listed = entries.any(|(&key, &cluster)| {
                        cluster == number && key <= asked.last && key & asked.fine != 0
                    });
                    let seen = listed || map.near.contains(&number);
                    assert!(seen, "{ray:?}: cluster {number} blocks");
                    blockers += 1;
                }
            }
        }
        assert!(blockers > 100 && (dark > 10 || mesh.len() > 100), "{blockers} {dark}");
    }
}
