//! `shadow-polygons`: shadow volumes, counted (Crow 1977), in the voxels of a grid, with rays where counting is
//! not certain (the hybrid of Eo & Kyung 1989).
//!
//! The shadow volume of a triangle is what it hides from the light: it begins at the triangle and is
//! bounded by three shadow polygons, which run from its edges away from the light. A point lies in as
//! many volumes as triangles block its ray. Crow counts polygons from the eye to the point; here they are
//! counted from a point of the same voxel whose number of volumes is known, so that only the polygons of
//! one voxel matter (`region`), and neither the eye nor mirrors.
//!
//! Where two triangles share an edge and lie on either side of it, as the light sees them, the polygons
//! of the two cancel; where they fold over, it counts double: what is left are silhouettes. Borders and
//! edges of many triangles need no care, because each triangle brings polygons of its own.
//!
//! Loses in most scenes: a query tests all polygons of its voxel, three to five determinants each, where a
//! ray ends at the first triangle it meets; and a voxel with its polygons is prepared for each light. It
//! wins where rays go a long way past few polygons.
//!
//! Exact, because every sign is certain or the query is passed on to a ray: determinants are taken in f64
//! with a bound for rounding and for where rays towards the light end (`voxels::source`). So a point
//! on the border of a shadow, a light in the plane of a triangle, and a light within the voxel are
//! passed on. The answer is that of exact arithmetic, before whatever backend.
//!
//! Crow: Shadow Algorithms for Computer Graphics. SIGGRAPH 1977.
//! Eo, Kyung: Hybrid Shadow Testing Scheme for Ray Tracing. Computer-Aided Design 21(1), 1989.

mod crossing;
mod region;

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, OnceLock};
use std::time::Instant;

use super::verdict::settle_each;
use super::voxels::{Neighbours, Source, Voxels};
use super::{Budget, ShadowQuery, Verdict};
use crate::occlusion::Tally;
use crate::scene::Scene;
use region::{Ground, Region};

/// Voxels to a triangle.
const DENSITY: f64 = 1.0;

/// A voxel with its polygons, when it is known whether it can have them.
type Place = OnceLock<Option<Box<Region>>>;

/// The voxels of one light; made when it is first asked about.
struct PerVoxel {
    source: Option<Source>,
    places: OnceLock<Box<[Place]>>,
}

/// Polygons for all lights and voxels.
pub(super) struct ShadowPolygons {
    /// Nothing, if the memory does not suffice.
    prepared: Option<(Voxels, Neighbours)>,
    lights: Vec<PerVoxel>,
    notes: Vec<String>,
    budget: Arc<Budget>,
    nanoseconds: AtomicU64,
    region_bytes: AtomicU64,
    /// Voxels that there was no memory for, and the bytes of their regions.
    refused: AtomicU64,
    refused_bytes: AtomicU64,
}

impl ShadowPolygons {
    pub fn new(scene: &Scene, budget: &Arc<Budget>) -> Self {
        let bytes_a_voxel = (scene.lights.len() * size_of::<Place>()) as f64;
        let mut notes = Vec::new();
        let prepared =
            Voxels::with_neighbours(&scene.triangles, DENSITY, bytes_a_voxel, budget, &mut notes);
        let source = |light| Source::new(light, &scene.bounds());
        let per_voxel = |light| PerVoxel { source: source(light), places: OnceLock::new() };
        Self {
            prepared,
            lights: scene.lights.iter().map(per_voxel).collect(),
            notes,
            budget: budget.clone(),
            nanoseconds: AtomicU64::new(0),
            region_bytes: AtomicU64::new(0),
            refused: AtomicU64::new(0),
            refused_bytes: AtomicU64::new(0),
        }
    }

    /// Prepares a voxel for a light, if that can be done.
    fn prepare(&self, ground: &Ground<'_>, voxel: [u32; 3]) -> Option<Box<Region>> {
        let start = Instant::now();
        let region = ground.prepare(voxel).map(Box::new);
        self.nanoseconds.fetch_add(start.elapsed().as_nanos() as u64, Relaxed);
        let region = region?;
        if !self.budget.take(region.memory()) {
            self.refused.fetch_add(1, Relaxed);
            self.refused_bytes.fetch_add(region.memory() as u64, Relaxed);
            return None;
        }
        self.region_bytes.fetch_add(region.memory() as u64, Relaxed);
        Some(region)
    }
}

impl ShadowPolygons {
    /// Whether one query is blocked, if that is proven.
    fn settle(&self, light: usize, query: &ShadowQuery) -> Option<bool> {
        let (voxels, neighbours) = self.prepared.as_ref()?;
        let light = self.lights.get(light)?;
        let source = light.source.as_ref()?;
        let ray = &query.ray;
        if !ray.is_valid() || !source.is_aimed_at(ray) {
            return None;
        }
        let point = ray.origin.as_dvec3();
        let level = voxels.level();
        let voxel = level.voxel_of(point);
        let places =
            light.places.get_or_init(|| (0..voxels.count()).map(|_| OnceLock::new()).collect());
        let region = places[level.index(voxel)].get_or_init(|| {
            let ground = Ground { voxels, neighbours, source };
            self.prepare(&ground, voxel)
        });
        let region = region.as_ref()?;
        // Points outside the grid have a nearest voxel, but are not in it.
        if !voxels.span(voxel).contains(point) {
            return None;
        }
        Some(region.count_at(point, source, voxels)? > 0)
    }
}

impl Verdict for ShadowPolygons {
    fn settle_many(
        &self,
        light: usize,
        queries: &[ShadowQuery],
        settled: &mut [Option<bool>],
        _: &mut Tally,
    ) {
        settle_each(queries, settled, |query| self.settle(light, query));
    }

    fn memory(&self) -> usize {
        let prepared = self.prepared.as_ref();
        let prepared =
            prepared.map_or(0, |(voxels, neighbours)| voxels.memory() + neighbours.memory());
        let places = self.lights.iter().filter_map(|light| light.places.get());
        prepared
            + places.map(|places| size_of_val(&**places)).sum::<usize>()
            + self.region_bytes.load(Relaxed) as usize
    }

    fn lazy_seconds(&self) -> f64 {
        self.nanoseconds.load(Relaxed) as f64 * 1e-9
    }

    fn notes(&self) -> Vec<String> {
        let mut notes = self.notes.clone();
        match self.refused.load(Relaxed) {
            0 => {}
            refused => notes.push(format!(
                "the memory limit left {refused} voxels without polygons, and their queries are traced; {}",
                self.budget.advice(self.refused_bytes.load(Relaxed))
            )),
        }
        notes
    }
}
