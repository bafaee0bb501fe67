//! `voxel-occlusion`: for each light and voxel, whether what lies between them blocks all rays, none, or
//! some (Woo & Amanatides 1990). A shadow ray that comes into a voxel where that is known ends there.
//!
//! Wins where many rays pass few voxels that hold anything: lights that shine into open space, and
//! regions behind walls. Loses where voxels are many beside the rays: a voxel is decided when a ray
//! first asks, which costs as much as tens of rays; so it is decided only along the first steps of a ray.
//!
//! Nothing is sampled. Let the voxel be widened by the grid's padding, and the light by the rounding of
//! rays (`voxels::source`); their convex hull is the shaft.
//! * **Null**: no triangle comes into the shaft but those that the voxel itself lists. A ray that has
//!   come to the voxel unblocked is tested against that list; then it is lit. So the surface that the
//!   voxel holds need not be argued away, as the paper has to.
//! * **Full**: a sheet of triangles goes right across the shaft (`sheet`). Then every ray is blocked.
//! * **Complicated**: neither could be proven.
//!
//! In front of a decided voxel the ray is tested against the lists of the voxels it comes through. The
//! answer is that of exact arithmetic on the ray's bits, before whatever backend: one with an `f32` test may
//! answer otherwise where it is wrong. Which thread decides a voxel first does not matter, as a decision
//! depends on nothing but light and voxel.
//!
//! Woo, Amanatides: Voxel Occlusion Testing: A Shadow Determination Accelerator for Ray Tracing.
//! Graphics Interface 1990.

mod sheet;

use std::ops::ControlFlow;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};
use std::time::Instant;

use super::verdict::settle_each;
use super::voxels::{Neighbours, Shaft, Source, Voxels};
use super::{Budget, ShadowQuery, Verdict};
use crate::occlusion::Tally;
use crate::scene::Scene;
use sheet::Sheets;

/// Voxels to a triangle.
const DENSITY: f64 = 1.0;

/// A ray that is not settled after so many voxels is passed on: farther along, few are decided.
const MOST_STEPS: usize = 6;

/// So is one that comes to a voxel with more opaque triangles: a backend has better than such lists.
const MOST_LISTED: usize = 64;

/// Bits of a status, and statuses in a word.
const BITS: usize = 2;
const IN_A_WORD: usize = u32::BITS as usize / BITS;

/// What lies between a voxel and a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Status {
    /// Not asked yet.
    Unknown,
    /// What blocks every ray.
    Full,
    /// Nothing but what the voxel lists.
    Null,
    /// Neither is proven.
    Complicated,
}

impl Status {
    const ALL: [Self; 1 << BITS] = [Self::Unknown, Self::Full, Self::Null, Self::Complicated];
}

/// The statuses of one light; made when it is first asked about.
struct PerVoxel {
    source: Option<Source>,
    words: OnceLock<Box<[AtomicU32]>>,
}

/// Statuses for all lights and voxels.
pub(super) struct VoxelOcclusion {
    /// Nothing, if the memory does not suffice.
    prepared: Option<(Voxels, Neighbours)>,
    lights: Vec<PerVoxel>,
    notes: Vec<String>,
    nanoseconds: AtomicU64,
}

impl VoxelOcclusion {
    pub fn new(scene: &Scene, budget: &Budget) -> Self {
        let bytes_a_voxel = scene.lights.len() as f64 * size_of::<u32>() as f64 / IN_A_WORD as f64;
        let mut notes = Vec::new();
        let prepared =
            Voxels::with_neighbours(&scene.triangles, DENSITY, bytes_a_voxel, budget, &mut notes);
        let source = |light| Source::new(light, &scene.bounds());
        let per_voxel = |light| PerVoxel { source: source(light), words: OnceLock::new() };
        let lights = scene.lights.iter().map(per_voxel).collect();
        Self { prepared, lights, notes, nanoseconds: AtomicU64::new(0) }
    }

    /// The status of a voxel, which is decided now if it is not known.
    fn status(
        &self,
        light: &PerVoxel,
        source: &Source,
        voxels: &Voxels,
        (voxel, index): ([u32; 3], usize),
    ) -> Status {
        let words = light.words.get_or_init(|| {
            (0..voxels.count().div_ceil(IN_A_WORD)).map(|_| AtomicU32::new(0)).collect()
        });
        let (word, shift) = (&words[index / IN_A_WORD], index % IN_A_WORD * BITS);
        let mask = (1 << BITS) - 1;
        match Status::ALL[(word.load(Relaxed) >> shift & mask) as usize] {
            Status::Unknown => {
                let start = Instant::now();
                let status = self.decide(source, voxels, voxel, index);
                // Whoever else decides it sets the same bits.
                word.fetch_or((status as u32) << shift, Relaxed);
                self.nanoseconds.fetch_add(start.elapsed().as_nanos() as u64, Relaxed);
                status
            }
            known => known,
        }
    }

    fn decide(&self, source: &Source, voxels: &Voxels, voxel: [u32; 3], index: usize) -> Status {
        let span = voxels.span(voxel);
        let Some(shaft) = Shaft::new(span, source) else { return Status::Complicated };
        let own = voxels.opaque_in(index);
        let empty = shaft.voxels(voxels.level(), |other| {
            let foreign = |&&id: &&u32| own.binary_search(&id).is_err();
            let mut listed = voxels.opaque_in(other).iter().filter(foreign);
            match listed.any(|&id| shaft.may_meet(&voxels.corners(id))) {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        });
        if empty.is_continue() {
            return Status::Null;
        }
        // A sheet across the shaft blocks the ray from the middle, if any.
        let middle = (0.5 * (span.low + span.high)).as_vec3();
        if !span.contains(middle.as_dvec3()) {
            return Status::Complicated;
        }
        let Some((_, neighbours)) = &self.prepared else { return Status::Complicated };
        let sheets = Sheets { voxels, neighbours, shaft: &shaft };
        // Which query has to wait for a decision is chance, so none counts what it costs.
        match voxels.occluder(&source.ray_from(middle), &mut Tally::default()) {
            Some(occluder) if sheets.covers_from(occluder) => Status::Full,
            _ => Status::Complicated,
        }
    }
}

impl VoxelOcclusion {
    /// Whether one query is blocked, if that is proven.
    fn settle(&self, light: usize, query: &ShadowQuery, tally: &mut Tally) -> Option<bool> {
        let (voxels, _) = self.prepared.as_ref()?;
        let light = self.lights.get(light)?;
        let source = light.source.as_ref()?;
        let ray = &query.ray;
        if !ray.is_valid() || !source.is_aimed_at(ray) {
            return None;
        }
        let mut steps = voxels.steps(ray)?;
        for _ in 0..MOST_STEPS {
            let Some(step) = steps.next() else { return Some(false) };
            let status = self.status(light, source, voxels, (step.voxel, step.index));
            if status == Status::Full {
                return Some(true);
            }
            if voxels.opaque_in(step.index).len() > MOST_LISTED {
                return None;
            }
            if voxels.blocked_in(step.index, ray, tally) {
                return Some(true);
            }
            if status == Status::Null {
                return Some(false);
            }
        }
        None
    }
}

impl Verdict for VoxelOcclusion {
    fn settle_many(
        &self,
        light: usize,
        queries: &[ShadowQuery],
        settled: &mut [Option<bool>],
        tally: &mut Tally,
    ) {
        settle_each(queries, settled, |query| self.settle(light, query, tally));
    }

    fn memory(&self) -> usize {
        let prepared = self
            .prepared
            .as_ref()
            .map_or(0, |(voxels, neighbours)| voxels.memory() + neighbours.memory());
        let words = self.lights.iter().filter_map(|light| light.words.get());
        prepared + words.map(|words| size_of_val(&**words)).sum::<usize>()
    }

    fn lazy_seconds(&self) -> f64 {
        self.nanoseconds.load(Relaxed) as f64 * 1e-9
    }

    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }
}
