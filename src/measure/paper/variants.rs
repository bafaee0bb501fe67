//! What the paper uses, mentions and suggests, side by side: what each way saves over the backend alone.

use std::fmt;

use serde::Serialize;

use super::lockstep::{Contestant, Taken, render_all};
use super::table::gain;
use super::{Conditions, Gain, Unit, percent};
use crate::geometry::lanes::Arithmetic;
use crate::measure::{MeasureError, grouped};
use crate::occlusion::build;
use crate::render::{Order, Progress, Settings};
use crate::scene::builtin;
use crate::shadow::{Method, MethodError, Plan, Retest, SelfShadow, ShadowTally, prepare};

/// A way to answer the shadow queries of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variant {
    /// What distinguishes it.
    pub name: &'static str,
    method: Method,
    order: Order,
    retest: Retest,
    self_shadow: SelfShadow,
    reset_scanlines: bool,
}

impl Variant {
    /// A method with the options of the paper's table.
    const fn plain(name: &'static str, method: Method) -> Self {
        Self {
            name,
            method,
            order: Order::Scanline,
            retest: Retest::Again,
            self_shadow: SelfShadow::Offset,
            reset_scanlines: false,
        }
    }

    const fn in_order(self, order: Order) -> Self {
        Self { order, ..self }
    }

    const fn with_retest(self, retest: Retest) -> Self {
        Self { retest, ..self }
    }

    const fn without_spawner(self) -> Self {
        Self { self_shadow: SelfShadow::Exclude, ..self }
    }

    const fn forgetting(self) -> Self {
        Self { reset_scanlines: true, ..self }
    }
}

const TRACE: Method = Method::Trace;
const VOXEL: Method = Method::VoxelCache;
const TREE: Method = Method::CacheTree;

/// All of them; the first is what the others are compared with.
pub const VARIANTS: [Variant; 18] = [
    Variant::plain("trace", TRACE),
    Variant::plain("object-cache", Method::ObjectCache),
    Variant::plain("voxel-cache", VOXEL),
    Variant::plain("cache-tree", TREE),
    Variant::plain("cache-tree-tolerance", Method::CacheTreeTolerance),
    Variant::plain("woo", Method::Woo),
    Variant::plain("voxel-cache, reset at scanlines", VOXEL).forgetting(),
    Variant::plain("voxel-cache, serpentine", VOXEL).in_order(Order::Serpentine),
    Variant::plain("trace, tiles", TRACE).in_order(Order::Tiles),
    Variant::plain("voxel-cache, tiles", VOXEL).in_order(Order::Tiles),
    Variant::plain("cache-tree, tiles", TREE).in_order(Order::Tiles),
    Variant::plain("voxel-cache, cell not retested", VOXEL).with_retest(Retest::NotCell),
    Variant::plain("voxel-cache, mailbox", VOXEL).with_retest(Retest::NotTriangles),
    Variant::plain("cache-tree, cell not retested", TREE).with_retest(Retest::NotCell),
    Variant::plain("cache-tree, mailbox", TREE).with_retest(Retest::NotTriangles),
    Variant::plain("trace, spawner left out", TRACE).without_spawner(),
    Variant::plain("voxel-cache, spawner left out", VOXEL).without_spawner(),
    // What it saves over itself is the error of the measure.
    Variant::plain("trace once more", TRACE),
];

/// What one variant took.
#[derive(Clone, Debug, Serialize)]
pub struct VariantCost {
    /// Which one.
    pub name: &'static str,
    /// Rays of all kinds.
    pub rays: u64,
    /// What rendering took, in the unit of the report.
    pub render: u64,
    /// Of rendering, saved over the first variant, by ray: the tiles that are rendered may hold other
    /// pixels than the scanlines.
    pub saved: Gain,
    /// How queries were answered.
    pub shadows: ShadowTally,
}

/// The variants, in one scene over one backend.
#[derive(Clone, Debug, Serialize)]
pub struct VariantReport {
    /// The scene.
    pub scene: &'static str,
    /// The backend.
    pub backend: &'static str,
    /// Its triangle test.
    pub test: &'static str,
    /// Samples a pixel.
    pub samples_per_pixel: u32,
    /// Of every so many scanlines or tiles one was rendered.
    pub every: u32,
    /// What work is counted in.
    pub unit: Unit,
    /// The instruction set of our kernels.
    pub arithmetic: &'static str,
    /// The variants.
    pub variants: Vec<VariantCost>,
    /// Whether all made the same picture, bit for bit, where they rendered the same pixels and their
    /// rays start at the same points.
    pub agree: bool,
}

/// Renders the variants of a scene in turns, over each backend: runs in the current thread, so install
/// a rayon pool of one.
///
/// # Errors
/// If scene, backend, method or picture cannot be made.
pub fn compare_variants(
    name: &'static str,
    conditions: &Conditions,
    progress: &Progress,
) -> Result<Vec<VariantReport>, MeasureError> {
    let settings = conditions.settings(name);
    let scene = builtin::draft_at(name, conditions.tessellation)?.finish()?;
    let meter = conditions.meter()?;
    let Conditions { every, repetitions, .. } = *conditions;
    let mut reports = Vec::new();
    for &backend in &conditions.backends {
        let test = conditions.test.unwrap_or_else(|| backend.default_test());
        let engine = build(backend, test, &scene.triangles, &conditions.build)?;
        let contestants = VARIANTS
            .iter()
            .map(|variant| {
                let Variant { method, order, retest, self_shadow, reset_scanlines, .. } = *variant;
                let plan = Plan { method, retest, self_shadow, reset_scanlines, ..conditions.plan };
                let method = prepare(plan, &scene, &*engine)?;
                Ok(Contestant { method, settings: Settings { order, ..settings } })
            })
            .collect::<Result<Vec<_>, MethodError>>()?;
        let taken =
            render_all(&scene, &*engine, &contestants, every, repetitions, &meter, progress)?;
        reports.push(VariantReport {
            scene: name,
            backend: backend.name(),
            test: test.name(),
            samples_per_pixel: settings.samples * settings.samples,
            every,
            unit: meter.unit(),
            arithmetic: Arithmetic::of_this_cpu().name(),
            agree: agree(&taken),
            variants: VARIANTS
                .iter()
                .zip(&taken)
                .map(|(variant, taken_by)| cost(variant, &taken[0], taken_by))
                .collect(),
        });
    }
    Ok(reports)
}

fn cost(variant: &Variant, first: &Taken, taken: &Taken) -> VariantCost {
    let rays = taken.statistics.rays.total();
    // As much as it would have taken for the rays of the first.
    let share = first.statistics.rays.total() as f64 / rays.max(1) as f64;
    let scaled = |work: u64| (work as f64 * share) as u64;
    let taken_alike =
        Taken { least: scaled(taken.least), halves: taken.halves.map(scaled), ..taken.clone() };
    VariantCost {
        name: variant.name,
        rays,
        render: taken.least,
        saved: Gain::over(first, &taken_alike, 0),
        shadows: taken.statistics.shadows,
    }
}

/// Whether pictures of the same pixels are the same, for each treatment of the spawner.
fn agree(taken: &[Taken]) -> bool {
    VARIANTS.iter().zip(taken).enumerate().all(|(n, (variant, picture))| {
        VARIANTS[..n].iter().zip(taken).all(|(other, before)| {
            let alike = variant.self_shadow == other.self_shadow
                && (variant.order.batches() == other.order.batches());
            !alike || before.colours == picture.colours
        })
    })
}

/// Width of the first column, and of the others.
const NAME: usize = 32;
const VALUE: usize = 12;

impl fmt::Display for VariantReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { scene, backend, test, arithmetic, .. } = self;
        let unit = self.unit.name();
        writeln!(
            f,
            "{scene} over {backend} ({test}): {unit} ({arithmetic}) a ray of any kind; of it saved"
        )?;
        writeln!(
            f,
            "  {:NAME$}{:>VALUE$}{:>16}{:>VALUE$}{:>VALUE$}{:>VALUE$}{:>VALUE$}",
            "", "a ray", "saved", "object", "voxel", "recalled", "tests"
        )?;
        for VariantCost { name, rays, render, saved, shadows } in &self.variants {
            let rate = |part, whole| match whole {
                0 => String::new(),
                _ => format!("{:.1} %", percent(part, whole)),
            };
            let recalled = shadows.object_hits + shadows.voxel_hits;
            writeln!(
                f,
                "  {name:NAME$}{:>VALUE$}{:>16}{:>VALUE$}{:>VALUE$}{:>VALUE$}{:>VALUE$}",
                grouped(render / rays.max(&1)),
                gain(*saved),
                rate(shadows.object_hits, shadows.object_tested),
                rate(shadows.voxel_hits, shadows.voxel_tested),
                rate(recalled, shadows.blocked),
                format!(
                    "{:.1}",
                    shadows.backend.triangle_tests as f64 / shadows.queries.max(1) as f64
                ),
            )?;
        }
        Ok(())
    }
}
