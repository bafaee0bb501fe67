//! Units of work that threads share: tiles that are dear, as those full of mirrors, are cut, and begun first.
//!
//! A picture is finished when its last unit is. In the chair room one tile of eighty takes a tenth of all time, so that more than ten threads
//! would wait for it. Which tiles are dear a small picture of the same view says: neither units nor their order
//! depend on the number of threads.

use std::cmp::Reverse;

use rayon::prelude::*;

use super::forecast::{STRIDE, Small};
use super::order::Place;
use super::{RayCounts, Settings};
use crate::occlusion::Occlusion;
use crate::scene::Scene;

/// A tile is cut into four if it takes more than this share of all work: what a tile asks is answered together, so the larger, the better.
const DEAR: f64 = 1.0 / 40.0;

/// A ray of a mirror or of glass takes so many times as long as one from the eye, with what is asked where it ends: neighbours go apart, and
/// meet small things. It is 1 to 4 in the drum, 2 in the chair room, 3 in the staircase; the tiles that take longest have most of them.
const SECONDARY: u64 = 4;

/// Units of so few pixels are not cut.
const LEAST: usize = 64;

/// Along the curve through a tile, one of so many pixels stands for its square of four by four.
const LOOKED_AT: usize = 16;

/// The units of a render.
pub(super) struct Units {
    /// The pixels of each, in the order in which they are rendered.
    pub pixels: Vec<Vec<Place>>,
    /// Their numbers, in the order in which they should be begun.
    pub order: Vec<usize>,
}

impl Units {
    /// Cuts the work of a render. Orders other than tiles are taken as they are, for their units are what memories live for.
    pub fn of(scene: &Scene, backend: &dyn Occlusion, settings: &Settings) -> Self {
        let whole = settings.units();
        if !settings.order.batches() || whole.len() < 2 {
            let order = (0..whole.len()).collect();
            return Self { pixels: whole, order };
        }
        // At one sample a pixel the look takes some thousandths of the whole; at more, more can be looked at.
        let small = Small::of(scene, backend, settings, STRIDE / settings.samples.min(2));
        let cost = |pixels: &[Place]| -> u64 {
            let some = pixels.iter().step_by(LOOKED_AT);
            some.map(|&pixel| cost_of(small.rays_at(pixel, settings))).sum()
        };
        let all: u64 = whole.par_iter().map(|pixels| cost(pixels)).sum();
        let share = |pixels: &[Place]| cost(pixels) as f64 / all as f64;
        let pixels: Vec<Vec<Place>> =
            whole.into_par_iter().flat_map_iter(|pixels| cut(pixels, &share)).collect();
        // By quarters of what is cut: neighbours stay together otherwise, as they come to the same triangles.
        let class = |pixels: &Vec<Place>| (4.0 * share(pixels) / DEAR) as u32;
        let classes: Vec<u32> = pixels.par_iter().map(class).collect();
        let mut order: Vec<usize> = (0..pixels.len()).collect();
        order.sort_by_key(|&unit| Reverse(classes[unit]));
        Self { pixels, order }
    }
}

/// What rays cost, their shadow queries included, in units of one from the eye.
fn cost_of(rays: &RayCounts) -> u64 {
    rays.primary + SECONDARY * (rays.reflected + rays.refracted)
}

/// Cuts what is dear into quarters of the curve that goes through its pixels: those of a square are squares.
fn cut(pixels: Vec<Place>, share: &impl Fn(&[Place]) -> f64) -> Vec<Vec<Place>> {
    if pixels.len() <= LEAST || share(&pixels) < DEAR {
        return vec![pixels];
    }
    let quarters = pixels.chunks(pixels.len().div_ceil(4));
    quarters.flat_map(|quarter| cut(quarter.to_vec(), share)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::occlusion::{Backend, BuildOptions, Test, build};
    use crate::render::Progress;
    use crate::render::whitted::Unit;
    use crate::scene::builtin;
    use crate::shadow::Trace;

    fn grid(scene: &Scene) -> Box<dyn Occlusion> {
        build(Backend::Grid, Test::Exact, &scene.triangles, &BuildOptions::default()).unwrap()
    }

    #[test]
    fn every_pixel_is_in_one_unit_and_every_unit_is_begun_once() {
        let scene = builtin::draft_at("chair-room", 0.1).unwrap().finish().unwrap();
        let grid = grid(&scene);
        for (width, height, samples) in [(1, 1, 1), (17, 90, 3), (320, 243, 2)] {
            let settings = Settings { width, height, samples, ..Settings::default() };
            let Units { pixels, mut order } = Units::of(&scene, &*grid, &settings);
            order.sort_unstable();
            assert_eq!(order, (0..pixels.len()).collect::<Vec<_>>());
            let mut pixels = pixels.concat();
            pixels.sort_unstable();
            let all: Vec<Place> =
                (0..width).flat_map(|x| (0..height).map(move |y| (x, y))).collect();
            assert_eq!(pixels, all, "{width}x{height}");
        }
    }

    #[test]
    fn no_unit_of_a_room_full_of_mirrors_is_much_dearer_than_others_and_the_dear_ones_are_first() {
        let scene = builtin::draft_at("chair-room", 0.1).unwrap().finish().unwrap();
        let grid = grid(&scene);
        let trace = Trace::new(&*grid);
        let settings = Settings::default();
        let cost = |pixels: &Vec<Place>| {
            let unit = Unit::new(&scene, &*grid, &trace, &settings);
            cost_of(&unit.run(pixels, &Progress::default()).statistics.rays)
        };
        let whole: Vec<u64> = settings.units().par_iter().map(cost).collect();
        let all: u64 = whole.iter().sum();
        let mean = all / whole.len() as u64;
        let Units { pixels, order } = Units::of(&scene, &*grid, &settings);
        let cut: Vec<u64> = pixels.par_iter().map(cost).collect();
        assert_eq!(cut.iter().sum::<u64>(), all);
        assert!(*whole.iter().max().unwrap() > 4 * mean && *cut.iter().max().unwrap() < 3 * mean);
        assert!(pixels.len() < 2 * whole.len());
        let (first, others) = order.split_at(order.len() / 8);
        let mean_of =
            |units: &[usize]| units.iter().map(|&unit| cut[unit]).sum::<u64>() / units.len() as u64;
        let (first, others) = (mean_of(first), mean_of(others));
        assert!(first > 2 * others, "{first} {others}");
    }
}
