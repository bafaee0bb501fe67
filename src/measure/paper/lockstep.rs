//! Several methods render the same picture in turns, a few milliseconds each; what each took is
//! measured.
//!
//! The gains to be shown are 1 to 10 % of a process, while the time of one run varies by more between
//! two minutes of the same machine. So the methods take turns within milliseconds, who begins changes
//! with every piece of the picture, all is repeated, and of each piece by each method the least
//! measurement counts: what disturbs a piece disturbs it upwards, and not every time.
//!
//! Whoever runs after a method like it finds caches filled and branches learnt, and would win by
//! that alone, by up to 5 %. So everyone renders each piece twice, by two workers in the same state, and
//! the second run counts: by then all have what they need. What is left out so is waiting for memory, as
//! it was by *pixie*, which counted the cycles of a processor that never waits.
//!
//! None of this is needed where Callgrind counts: there everyone renders once, one after the other.

use glam::Vec3;

use super::Meter;
use crate::measure::MeasureError;
use crate::measure::turns::order_of;
use crate::occlusion::Occlusion;
use crate::render::{Pieces, Piecewise, Place, Progress, Settings, Statistics};
use crate::scene::Scene;
use crate::shadow::Prepared;

/// A method, and the picture that it renders.
pub struct Contestant<'a> {
    /// The method.
    pub method: Box<dyn Prepared + 'a>,
    /// The picture; size and samples are the same for all that take turns.
    pub settings: Settings,
}

/// What one contestant took to render the picture.
#[derive(Clone, Debug, Default)]
pub struct Taken {
    /// The sum over pieces of the least measurement; under Callgrind, the only one.
    pub least: u64,
    /// The same of the even and of the odd repetitions alone.
    pub halves: [u64; 2],
    /// Whether there are odd repetitions.
    pub repeated: bool,
    /// What was counted.
    pub statistics: Statistics,
    /// The picture.
    pub colours: Vec<(Place, Vec3)>,
}

/// Has every contestant render the picture, or one of every so many of its scanlines or tiles, in one
/// thread: once if Callgrind counts, else twice a repetition.
///
/// # Errors
/// If the settings make no picture, or the meter fails.
pub fn render_all(
    scene: &Scene,
    backend: &dyn Occlusion,
    contestants: &[Contestant<'_>],
    every: u32,
    repetitions: usize,
    meter: &Meter,
    progress: &Progress,
) -> Result<Vec<Taken>, MeasureError> {
    if let Meter::Callgrind(_) = meter {
        let render = |contestant| render_once(scene, backend, contestant, every, meter, progress);
        return contestants.iter().map(render).collect();
    }
    render_in_turns(scene, backend, contestants, every, repetitions, meter, progress)
}

fn render_once(
    scene: &Scene,
    backend: &dyn Occlusion,
    Contestant { method, settings }: &Contestant<'_>,
    every: u32,
    meter: &Meter,
    progress: &Progress,
) -> Result<Taken, MeasureError> {
    let mut render = Piecewise::new(scene, backend, &**method, settings, every)?;
    let before = meter.read()?;
    while render.advance(progress) {}
    let least = meter.read()? - before;
    let Pieces { colours, statistics } = render.finish();
    Ok(Taken { least, halves: [least; 2], repeated: false, statistics, colours })
}

fn render_in_turns(
    scene: &Scene,
    backend: &dyn Occlusion,
    contestants: &[Contestant<'_>],
    every: u32,
    repetitions: usize,
    meter: &Meter,
    progress: &Progress,
) -> Result<Vec<Taken>, MeasureError> {
    let mut taken = vec![Taken::default(); contestants.len()];
    // By contestant and half, then by piece.
    let mut least: Vec<[Vec<u64>; 2]> = vec![Default::default(); contestants.len()];
    for repetition in 0..repetitions {
        let begin = || -> Result<Vec<_>, MeasureError> {
            contestants
                .iter()
                .map(|Contestant { method, settings }| {
                    Piecewise::new(scene, backend, &**method, settings, every)
                })
                .map(|render| render.map_err(MeasureError::from))
                .collect()
        };
        let (mut first, mut second) = (begin()?, begin()?);
        for (least, render) in least.iter_mut().zip(&first) {
            least.iter_mut().for_each(|half| half.resize(render.count(), u64::MAX));
        }
        // Those that render tiles have other pieces than the rest, and may have more.
        let pieces = first.iter().map(Piecewise::count).max().unwrap_or(0);
        for piece in 0..pieces {
            for which in order_of(contestants.len(), (repetition, piece)) {
                first[which].advance(progress);
                let before = meter.read()?;
                if second[which].advance(progress) {
                    let spent = meter.read()? - before;
                    let least = &mut least[which][repetition % 2][piece];
                    *least = spent.min(*least);
                }
            }
        }
        for (taken, render) in taken.iter_mut().zip(second) {
            let done = render.finish();
            (taken.colours, taken.statistics) = (done.colours, done.statistics);
        }
    }
    for (taken, [even, odd]) in taken.iter_mut().zip(&least) {
        taken.least = even.iter().zip(odd).map(|(even, odd)| even.min(odd)).sum();
        taken.repeated = repetitions > 1;
        taken.halves = match taken.repeated {
            true => [even, odd].map(|half| half.iter().sum()),
            false => [taken.least; 2],
        };
    }
    Ok(taken)
}
