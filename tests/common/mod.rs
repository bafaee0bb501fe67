//! Shared by the tests: random numbers, meshes, rays.
#![allow(dead_code, reason = "each test binary uses a part of it")]

pub mod command;
pub mod lit;

use std::sync::Arc;

use glam::Vec3;
use umbra::geometry::{Ray, Triangle, Triangles};
use umbra::occlusion::{Backend, BuildOptions, Occlusion, Test, build};

/// Every backend that this build has.
pub const BACKENDS: &[Backend] = &[
    Backend::Grid,
    Backend::Bvh2,
    Backend::Cwbvh,
    Backend::Brute,
    #[cfg(feature = "embree")]
    Backend::Embree,
];

/// A backend as it is built by itself. That it cannot be built is a failure, of whatever test.
pub fn engine(backend: Backend, test: Test, triangles: &Arc<Triangles>) -> Box<dyn Occlusion> {
    build(backend, test, triangles, &BuildOptions::default())
        .unwrap_or_else(|error| panic!("{backend} {test}: {error}"))
}

/// SplitMix64: the same numbers on every machine.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// From 0 to 1, 24 bits.
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1u64 << 24) as f32
    }

    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// A point of the cube from −`half` to `half`.
    pub fn in_cube(&mut self, half: f32) -> Vec3 {
        Vec3::new(self.between(-half, half), self.between(-half, half), self.between(-half, half))
    }
}

/// Random triangles of about `size` in a cube of side 2.
pub fn soup(count: usize, size: f32, seed: u64) -> Vec<Triangle> {
    let mut random = Random(seed);
    (0..count)
        .map(|_| {
            let centre = random.in_cube(1.0);
            std::array::from_fn(|_| centre + random.in_cube(size))
        })
        .collect()
}

/// A closed sphere with poles, `rings` × 2`rings` quads.
pub fn sphere(centre: Vec3, radius: f32, rings: usize) -> Vec<Triangle> {
    let point = |ring: usize, segment: usize| {
        let theta = std::f32::consts::PI * ring as f32 / rings as f32;
        let phi = std::f32::consts::PI * (segment % (2 * rings)) as f32 / rings as f32;
        let (sin, cos) = if ring == rings { (0.0, -1.0) } else { theta.sin_cos() };
        centre + radius * Vec3::new(sin * phi.cos(), cos, sin * phi.sin())
    };
    let mut triangles = Vec::new();
    for ring in 0..rings {
        for segment in 0..2 * rings {
            let [a, b] = [point(ring, segment), point(ring, segment + 1)];
            let [c, d] = [point(ring + 1, segment), point(ring + 1, segment + 1)];
            if ring > 0 {
                triangles.push([a, b, c]);
            }
            if ring + 1 < rings {
                triangles.push([b, d, c]);
            }
        }
    }
    triangles
}

/// How a ray is made, to stress one thing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aim {
    Random,
    AtEdge,
    AtVertex,
    AxisParallel,
    FromOutside,
    ToDirection,
}

impl Aim {
    pub const ALL: [Self; 6] = [
        Self::Random,
        Self::AtEdge,
        Self::AtVertex,
        Self::AxisParallel,
        Self::FromOutside,
        Self::ToDirection,
    ];

    pub fn ray(self, triangles: &[Triangle], random: &mut Random) -> Ray {
        let [a, b, _] = triangles[random.below(triangles.len())];
        let origin = random.in_cube(1.2);
        // Through the target and on, so that it lies inside the segment.
        let through =
            |origin: Vec3, target: Vec3| Ray::between(origin, origin + (target - origin) * 1.5);
        match self {
            Self::Random => Ray::between(origin, random.in_cube(1.2)),
            Self::AtEdge => through(origin, a.lerp(b, random.unit())),
            Self::AtVertex => through(origin, a),
            Self::AxisParallel => {
                let axis =
                    Vec3::AXES[random.below(3)] * if random.bits() & 1 == 0 { 1.0 } else { -1.0 };
                // On a plane of the mesh in one coordinate, as often as not.
                let origin = if random.bits() & 1 == 0 { origin } else { a - axis };
                Ray { origin, direction: axis, end: random.between(0.5, 3.0) }
            }
            Self::FromOutside => through(random.in_cube(1.0) * 1e3, random.in_cube(1.0)),
            Self::ToDirection => Ray::towards(origin, random.in_cube(1.0)),
        }
    }
}

/// The ten real scenes: data beside the project, in `UMBRA_SCENES` or `../shared/scenes`.
///
/// `None` where they are absent: then the test says so on the terminal, past the test harness, and in CI
/// it fails.
pub fn real_scenes() -> Option<std::path::PathBuf> {
    use std::io::Write;
    let folder = std::env::var_os("UMBRA_SCENES").map_or_else(
        || std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes"),
        Into::into,
    );
    if folder.join("sponza.glb").is_file() {
        return Some(folder);
    }
    let message = format!(
        "the real scenes are not in {}: set UMBRA_SCENES to their folder",
        folder.display()
    );
    assert!(std::env::var_os("CI").is_none(), "{message}");
    let _ = writeln!(std::io::stderr(), "\n*** NOT TESTED on real scenes: {message} ***");
    None
}

/// The real scenes' files.
pub const REAL_SCENES: [&str; 10] = [
    "CornellBox-Original.obj",
    "bigtujunga.glb",
    "bunny.obj",
    "delft.obj",
    "jungle.glb",
    "office.obj",
    "satellite.glb",
    "sponza.glb",
    "staircase.glb",
    "tower_bridge.glb",
];
