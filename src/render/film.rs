//! What a render fills: colours, and which lights reach which pixels.

use glam::Vec3;

use super::legend::UNASKED;
use super::order::Place;

/// Linear radiance, a colour a pixel, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    width: u32,
    height: u32,
    pixels: Vec<Vec3>,
}

impl Film {
    /// Black.
    #[must_use]
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, pixels: vec![Vec3::ZERO; width as usize * height as usize] }
    }

    /// Pixels across.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Pixels down.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The pixels, row by row from the top.
    #[must_use]
    pub fn pixels(&self) -> &[Vec3] {
        &self.pixels
    }

    /// One pixel; (0, 0) is at the top left.
    ///
    /// # Panics
    /// Outside the picture.
    #[must_use]
    pub fn at(&self, x: u32, y: u32) -> Vec3 {
        self.pixels[index([self.width, self.height], (x, y))]
    }

    /// Sets one pixel.
    ///
    /// # Panics
    /// Outside the picture.
    pub fn set(&mut self, place: Place, colour: Vec3) {
        self.pixels[index([self.width, self.height], place)] = colour;
    }
}

/// Where a pixel of a picture is, row by row from the top.
///
/// # Panics
/// Outside the picture.
pub(super) fn index([width, height]: [u32; 2], (x, y): Place) -> usize {
    assert!(x < width && y < height, "({x}, {y}) is outside the picture of {width}x{height}");
    y as usize * width as usize + x as usize
}

/// Of one pixel and one light: how many of the pixel's samples asked, and how many were blocked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Seen {
    /// Samples whose primary hit faces the light.
    pub asked: u16,
    /// Those that an opaque triangle blocks.
    pub blocked: u16,
}

/// For every pixel and light, whether the light reaches what the eye sees there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShadowMask {
    width: u32,
    height: u32,
    lights: usize,
    seen: Vec<Seen>,
}

impl ShadowMask {
    pub(super) fn new(width: u32, height: u32, lights: usize) -> Self {
        let seen = vec![Seen::default(); width as usize * height as usize * lights];
        Self { width, height, lights, seen }
    }

    pub(super) fn set(&mut self, place: Place, seen: &[Seen]) {
        let first = index([self.width, self.height], place) * self.lights;
        self.seen[first..first + self.lights].copy_from_slice(seen);
    }

    /// Number of lights.
    #[must_use]
    pub fn lights(&self) -> usize {
        self.lights
    }

    /// What was seen of each light at a pixel.
    ///
    /// # Panics
    /// Outside the picture.
    #[must_use]
    pub fn at(&self, x: u32, y: u32) -> &[Seen] {
        let first = index([self.width, self.height], (x, y)) * self.lights;
        &self.seen[first..first + self.lights]
    }

    /// A picture of it: white where all lights that are asked reach the pixel, black where none does,
    /// blue where nothing was asked.
    #[must_use]
    pub fn picture(&self) -> Film {
        let mut film = Film::new(self.width, self.height);
        for y in 0..self.height {
            for x in 0..self.width {
                let (asked, blocked) = self.at(x, y).iter().fold((0u32, 0u32), |(a, b), seen| {
                    (a + u32::from(seen.asked), b + u32::from(seen.blocked))
                });
                let colour = match asked {
                    0 => UNASKED,
                    _ => Vec3::splat(1.0 - blocked as f32 / asked as f32),
                };
                film.set((x, y), colour);
            }
        }
        film
    }
}
