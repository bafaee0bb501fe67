//! Several methods render the same picture in turns, a scanline each; what each took is measured.
//!
//! The gains to be shown are 1 to 10 % of a process, while the time of one run varies by more between
//! two minutes of the same machine. So the methods take turns within milliseconds, who begins changes
//! with every scanline, all is repeated, and of each scanline of each method the least measurement
//! counts: what disturbs a scanline disturbs it upwards, and not every time.

use glam::Vec3;

use super::Meter;
use crate::occlusion::Occlusion;
use crate::render::{Progress, Scanlines, Settings, SettingsError, Statistics};
use crate::scene::Scene;
use crate::shadow::Prepared;

/// What one method took to render the picture.
#[derive(Clone, Debug, Default)]
pub struct Taken {
    /// The sum over scanlines of the least measurement.
    pub least: u64,
    /// The sums of each repetition.
    pub repetitions: Vec<u64>,
    /// What was counted.
    pub statistics: Statistics,
    /// The picture.
    pub colours: Vec<Vec3>,
}

/// Has every method render the picture, in one thread.
///
/// # Errors
/// If the settings make no picture.
pub fn render_in_turns(
    scene: &Scene,
    backend: &dyn Occlusion,
    methods: &[Box<dyn Prepared + '_>],
    settings: &Settings,
    repetitions: usize,
    meter: &Meter,
    progress: &Progress,
) -> Result<Vec<Taken>, SettingsError> {
    let mut least = vec![vec![u64::MAX; methods.len()]; settings.height as usize];
    let mut taken = vec![Taken::default(); methods.len()];
    for repetition in 0..repetitions {
        let mut renders = methods
            .iter()
            .map(|method| Scanlines::new(scene, backend, &**method, settings))
            .collect::<Result<Vec<_>, _>>()?;
        let mut sums = vec![0; methods.len()];
        for (row, least) in least.iter_mut().enumerate() {
            for turn in 0..methods.len() {
                let which = (turn + row + repetition) % methods.len();
                let before = meter.read();
                renders[which].advance(progress);
                let spent = meter.read() - before;
                sums[which] += spent;
                least[which] = least[which].min(spent);
            }
        }
        for ((taken, sum), render) in taken.iter_mut().zip(sums).zip(renders) {
            taken.repetitions.push(sum);
            (taken.colours, taken.statistics) = render.finish();
        }
    }
    for (which, taken) in taken.iter_mut().enumerate() {
        taken.least = least.iter().map(|row| row[which]).sum();
    }
    Ok(taken)
}
