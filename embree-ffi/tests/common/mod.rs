//! Scenes and rays the tests share. Embree must be there: a test without it fails, with the one line that says why.
#![allow(dead_code, reason = "each test binary uses a part of it")]

use embree_ffi::{Device, DeviceConfig, Isa, Mesh, Ray, Scene, SceneBuilder, SceneOptions};

pub fn device() -> Device {
    device_with(DeviceConfig::default())
}

pub fn device_with(config: DeviceConfig) -> Device {
    Device::new(config).unwrap_or_else(|error| panic!("{error}"))
}

/// The instruction sets of this processor.
pub fn available() -> impl Iterator<Item = Isa> {
    Isa::ALL.into_iter().filter(|isa| isa.is_available())
}

/// Squares from -1 to 1 across the z axis, one mesh for each height, two triangles each.
pub fn stack(device: &Device, heights: &[f32], options: SceneOptions) -> Scene {
    let mut builder = SceneBuilder::new(device, options).unwrap();
    for &z in heights {
        builder.add(Mesh::new(&square(z), &SQUARE)).unwrap();
    }
    builder.commit().unwrap()
}

pub fn square(z: f32) -> [[f32; 3]; 4] {
    [[-1.0, -1.0, z], [1.0, -1.0, z], [1.0, 1.0, z], [-1.0, 1.0, z]]
}

pub const SQUARE: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

/// Up the z axis from z = -1, beside the squares' diagonal, or beside the squares.
pub fn up(hit: bool) -> Ray {
    Ray::new([if hit { 0.5 } else { 5.0 }, 0.25, -1.0], [0.0, 0.0, 1.0])
}

/// Numbers from 0 to 1, the same in every run.
pub struct Dice(pub u64);

impl Dice {
    pub fn roll(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    pub fn point(&mut self) -> [f32; 3] {
        [0; 3].map(|_| self.roll() * 2.0 - 1.0)
    }
}

/// Small triangles strewn over a cube.
pub fn soup(count: usize) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let mut dice = Dice(7);
    let mut vertices = Vec::new();
    for _ in 0..count {
        let centre = dice.point();
        vertices.extend([0; 3].map(|_| {
            let offset = dice.point();
            [0, 1, 2].map(|axis| centre[axis] + 0.1 * offset[axis])
        }));
    }
    let triangles = (0..count as u32)
        .map(|triangle| [3 * triangle, 3 * triangle + 1, 3 * triangle + 2])
        .collect();
    (vertices, triangles)
}

pub fn soup_scene(device: &Device, options: SceneOptions) -> Scene {
    let (vertices, triangles) = soup(2000);
    let mut builder = SceneBuilder::new(device, options).unwrap();
    builder.add(Mesh::new(&vertices, &triangles)).unwrap();
    builder.commit().unwrap()
}

pub fn segments(count: usize) -> Vec<Ray> {
    let mut dice = Dice(8);
    (0..count).map(|_| Ray::between(dice.point(), dice.point())).collect()
}
