//! Arguments that several commands share.

use std::path::Path;
use std::str::FromStr;
use std::time::Instant;

use clap::Args;
use glam::{DVec3, Vec3};
use serde::Serialize;

use super::failure::{Failure, say};
#[cfg(feature = "embree")]
use super::lists::any;
use super::lists::known;
use super::numbers::whole;
use super::outputs::{check_apart, check_outputs};
use super::progress::with_word;
use crate::measure::{contender, count, grouped};
use crate::occlusion::{
    Backend, BackendError, BuildOptions, GridError, GridOptions, Occlusion, Test, build,
};
use crate::scene::{Camera, Draft, Light, Scene};
use crate::shadow::Combination;

/// Reflections and refractions at most: as many as the table of a ray's path holds.
pub(super) const MOST_DEPTH: u8 = crate::shadow::Path::MAX_LEVEL;

/// Threads at most: more than any machine has processors.
pub(super) const MOST_THREADS: usize = 1024;

/// Which engine answers; statistics have how it was built, and name backend, test and so on themselves.
#[derive(Args, Serialize)]
pub(super) struct EngineOptions {
    /// The engine that answers occlusion queries
    #[arg(long, value_enum, default_value_t = Backend::Grid)]
    #[serde(skip)]
    pub backend: Backend,
    /// The triangle test: exact, unless the engine is embree, which has pluecker (its robust mode, the
    /// default) and moller (its default mode)
    #[arg(long, value_enum)]
    #[serde(skip)]
    test: Option<Test>,
    /// Voxels of the grid along x, y and z, instead of a choice by the number of triangles
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_resolution)]
    pub grid: Option<[u32; 3]>,
    /// A plain uniform grid: crowded voxels are not divided
    #[arg(long)]
    pub uniform: bool,
    /// Crowded voxels of the grid are divided when a ray first comes to them, not beforehand
    #[arg(long, conflicts_with = "uniform")]
    pub lazy: bool,
    /// Most memory that engine and shadow method may take, like 512M or 2G: what is prepared becomes coarser
    /// or steps aside, and says so; if not given, the shadow method takes no more than Embree's structure would, and
    /// both together no more than a quarter of the machine
    #[arg(long, value_name = "SIZE", value_parser = MemoryLimit::from_str)]
    #[serde(skip)]
    memory: Option<MemoryLimit>,
    /// Threads; all processors if not given
    #[arg(long, value_name = "N", value_parser = whole(1..=MOST_THREADS))]
    #[serde(skip)]
    pub threads: Option<usize>,
}

/// How much memory may be taken.
#[derive(Clone, Debug)]
struct MemoryLimit {
    bytes: u64,
    /// As it was given.
    text: String,
}

impl FromStr for MemoryLimit {
    type Err = &'static str;

    /// A number of bytes, with K, M, G or T for powers of 1024.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let number = text.trim_end_matches(['B', 'b']).trim_end_matches('i');
        let digits = number.trim_end_matches(|c: char| c.is_ascii_alphabetic());
        let shift = match &number[digits.len()..] {
            "" => Some(0),
            "K" | "k" => Some(10),
            "M" | "m" => Some(20),
            "G" | "g" => Some(30),
            "T" | "t" => Some(40),
            _ => None,
        };
        let bytes = digits.parse::<f64>().ok().filter(|number| *number >= 0.0);
        let (Some(bytes), Some(shift)) = (bytes, shift) else {
            return Err("give it as bytes, or like 512M or 2.5G");
        };
        let bytes = bytes * f64::from(shift).exp2();
        if bytes >= u64::MAX as f64 {
            return Err("no machine has so much; give it as bytes, or like 512M or 2.5G");
        }
        Ok(Self { bytes: bytes as u64, text: text.to_owned() })
    }
}

impl MemoryLimit {
    /// What is said where an engine takes so many bytes even at its coarsest.
    fn too_little(&self, backend: Backend, bytes: u64) -> Failure {
        let Self { text, .. } = self;
        let is_bare = text.ends_with(|last: char| last.is_ascii_digit());
        let meant = match is_bare && self.bytes << 20 >= bytes {
            true => format!(" ({text} without a unit are bytes: did you mean {text}M?)"),
            false => String::new(),
        };
        Failure::Input(format!(
            "--memory {text}: over this scene {backend} takes more; give {}M or more{meant}",
            bytes.div_ceil(1 << 20)
        ))
    }
}

/// Voxels along x, y and z.
pub(super) fn parse_resolution(text: &str) -> Result<[u32; 3], String> {
    let parts: Vec<u32> = text
        .split(',')
        .map(|part| part.trim().parse().ok())
        .collect::<Option<_>>()
        .ok_or("give three whole numbers, like 64,64,32")?;
    let parts: [u32; 3] = parts.try_into().map_err(|_| "give three numbers, like 64,64,32")?;
    let options = GridOptions { resolution: Some(parts), ..GridOptions::default() };
    options.check().map_err(|error| error.to_string())?;
    Ok(parts)
}

/// The size of a picture.
pub(super) fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let (width, height) =
        text.split_once(['x', 'X', '×']).ok_or("give it as WIDTHxHEIGHT, like 640x486")?;
    let number =
        |part: &str| part.trim().parse().map_err(|_| format!("'{part}' is not a number of pixels"));
    Ok((number(width)?, number(height)?))
}

/// An engine, built.
pub(super) struct Built {
    pub backend: Box<dyn Occlusion>,
    /// Bytes that it would take if it were not coarser, to keep to a limit.
    pub wanted_bytes: u64,
    pub seconds: f64,
}

impl EngineOptions {
    /// The test that was asked for, or the backend's own choice.
    pub fn test(&self) -> Test {
        self.test.unwrap_or_else(|| self.backend.default_test())
    }

    /// Most bytes that engine and shadow method may take, if that was given.
    pub fn most_bytes(&self) -> Option<u64> {
        self.memory.as_ref().map(|limit| limit.bytes)
    }

    /// Builds the backend.
    pub fn build(&self, scene: &Scene) -> Result<Built, Failure> {
        let grid = GridOptions {
            resolution: self.grid,
            nested: !self.uniform,
            lazy: self.lazy,
            // A grid that is built at once and takes too much gives way to a coarser one.
            most_bytes: self.most_bytes().filter(|_| self.lazy),
        };
        let start = Instant::now();
        with_word(&format!("building {}", self.backend), || {
            let backend = self.build_over(scene, grid)?;
            let wanted_bytes = backend.memory() as u64;
            let backend = self.within_memory(scene, backend)?;
            Ok(Built { backend, wanted_bytes, seconds: start.elapsed().as_secs_f64() })
        })
    }

    fn build_over(
        &self,
        scene: &Scene,
        grid: GridOptions,
    ) -> Result<Box<dyn Occlusion>, BackendError> {
        let options = BuildOptions { grid, ..BuildOptions::default() };
        build(self.backend, self.test(), &scene.triangles, &options)
    }

    /// The backend, or a coarser one if it takes more memory than it may and can be coarser; says so.
    fn within_memory(
        &self,
        scene: &Scene,
        backend: Box<dyn Occlusion>,
    ) -> Result<Box<dyn Occlusion>, Failure> {
        /// How many times fewer voxels the next coarser grid has.
        const COARSER: usize = 8;
        let Some(limit) = &self.memory else { return Ok(backend) };
        let mut bytes = backend.memory() as u64;
        if bytes <= limit.bytes {
            return Ok(backend);
        }
        // Gone before another comes.
        drop(backend);
        let mut voxels = match self.backend {
            // Each takes eight bytes while a grid is built.
            Backend::Grid => scene.triangles.len().min((limit.bytes / 8).max(1) as usize),
            _ => 0,
        };
        while voxels > 0 {
            let grid = GridOptions {
                most_bytes: Some(limit.bytes),
                ..GridOptions::uniform(&scene.triangles, voxels)
            };
            bytes = match self.build_over(scene, grid) {
                Ok(coarser) if coarser.memory() as u64 <= limit.bytes => {
                    let [x, y, z] = grid.resolution.expect("a number of voxels gives a resolution");
                    say!("umbra: {x} by {y} by {z} voxels only, to keep to the memory limit");
                    return Ok(coarser);
                }
                Ok(coarser) => coarser.memory() as u64,
                Err(BackendError::Grid(GridError::TooFine(refused))) => refused.bytes(),
                Err(error) => return Err(error.into()),
            };
            voxels = if voxels == 1 { 0 } else { (voxels / COARSER).max(1) };
        }
        Err(limit.too_little(self.backend, bytes))
    }

    /// Refuses what only the grid has, where another engine was asked for.
    pub fn check(&self) -> Result<(), Failure> {
        let options =
            [("--grid", self.grid.is_some()), ("--uniform", self.uniform), ("--lazy", self.lazy)];
        only_over(Backend::Grid, &[self.backend], &options)
    }

    /// A pool of the threads that were asked for.
    pub fn pool(&self) -> Result<rayon::ThreadPool, Failure> {
        pool(self.threads)
    }
}

/// Refuses options that were given for an engine which is not asked.
pub(super) fn only_over(
    backend: Backend,
    asked: &[Backend],
    options: &[(&str, bool)],
) -> Result<(), Failure> {
    match options.iter().find(|(_, is_given)| *is_given && !asked.contains(&backend)) {
        None => Ok(()),
        Some((option, _)) => Err(Failure::Input(format!(
            "{option} is for {backend}, which is not asked; leave it out, or ask {backend}"
        ))),
    }
}

/// A pool of so many threads; of all processors if no number is given.
pub(super) fn pool(threads: Option<usize>) -> Result<rayon::ThreadPool, Failure> {
    // For rayon, 0 are all processors.
    let threads = threads.unwrap_or(0);
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|e| Failure::Input(format!("cannot start {threads} threads: {e}")))
}

/// Who is compared: every combination of these that exists.
#[derive(Args)]
pub(super) struct ContenderOptions {
    /// The engines; all but brute if not given
    #[arg(long, value_delimiter = ',', value_name = "LIST", value_parser = known::<Backend>())]
    backends: Vec<Backend>,
    /// The triangle tests; all if not given
    #[arg(long, value_delimiter = ',', value_name = "LIST", value_parser = known::<Test>())]
    tests: Vec<Test>,
    /// The methods that stand before the engines, as --shadows of render has them
    #[arg(long, value_delimiter = ',', value_name = "LIST", value_parser = super::shadows::parse_method)]
    pub methods: Vec<Combination>,
    /// The ways to use Embree: names like avx2-high-8-coherent, `default`, or `all`
    #[cfg(feature = "embree")]
    #[arg(long, value_delimiter = ',', value_name = "LIST", value_parser = any())]
    pub embree_variants: Vec<String>,
}

impl ContenderOptions {
    /// What was named.
    pub fn choice(&self) -> Result<contender::Choice, Failure> {
        #[cfg(feature = "embree")]
        if !self.backends.is_empty() {
            let variants = ("--embree-variants", !self.embree_variants.is_empty());
            only_over(Backend::Embree, &self.backends, &[variants])?;
        }
        Ok(contender::Choice {
            backends: self.backends.clone(),
            tests: self.tests.clone(),
            methods: self.methods.clone(),
            #[cfg(feature = "embree")]
            embree: contender::EmbreeVariant::list(&self.embree_variants)
                .map_err(|error| Failure::Input(format!("--embree-variants: {error}")))?,
            ..contender::Choice::default()
        })
    }
}

/// The threads of a command that puts queries of its own making, once it is clear that it can run.
pub(super) fn pool_for(
    stats: Option<&Path>,
    threads: Option<usize>,
) -> Result<rayon::ThreadPool, Failure> {
    check_outputs(&Vec::from_iter(stats), &[])?;
    pool(threads)
}

/// Loads a scene, and says what the program decided for the user. No output may replace a file of the scene; which
/// they are is known only now.
pub(super) fn load_scene(scene: &Path, outputs: &[&Path]) -> Result<Scene, Failure> {
    finish_draft(scene, outputs, |draft| draft)
}

/// The same for whoever brings rays: no camera or light is looked for that nobody needs, nor is anything said of them.
pub(super) fn load_triangles(scene: &Path, outputs: &[&Path]) -> Result<Scene, Failure> {
    finish_draft(scene, outputs, |draft| {
        let camera = Camera::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, 1.0);
        let light = Light::Directional { direction: DVec3::Y, irradiance: Vec3::ONE };
        Draft { camera: Some(camera), lights: vec![light], ..draft }
    })
}

/// Says what transparent triangles are to a command that asks only whether anything blocks, if there are any.
pub(super) fn note_transparent(scene: &mut Scene, command: &str) {
    let all = scene.triangles.len() as u64;
    let transparent = all - u64::from(scene.triangles.opaque_count());
    let [are, they_block] = match transparent {
        0 => return,
        1 => ["is", "it attenuates light and blocks"],
        _ => ["are", "they attenuate light and block"],
    };
    let note = format!(
        "{} of {} {are} transparent: {they_block} nothing in `{command}`",
        grouped(transparent),
        count(all, "triangle")
    );
    say!("umbra: {}: {note}", scene.name);
    scene.notes.push(note);
}

fn finish_draft(
    scene: &Path,
    outputs: &[&Path],
    prepare: impl FnOnce(Draft) -> Draft + Send,
) -> Result<Scene, Failure> {
    let scene = with_word(&format!("loading {}", scene.display()), || {
        prepare(crate::scene::draft(scene)?).finish()
    })?;
    check_apart(outputs, &scene.files)?;
    for note in &scene.notes {
        say!("umbra: {}: {note}", scene.name);
    }
    Ok(scene)
}
