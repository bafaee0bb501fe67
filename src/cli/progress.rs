//! A progress bar for whatever takes more than a second, on terminals only.

use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::{Duration, Instant};

use indicatif::{HumanCount, ProgressBar, ProgressStyle};

use crate::render::Progress;

/// No bar for what is done before this.
const PATIENCE: Duration = Duration::from_secs(1);

/// How often the bar moves.
const BEAT: Duration = Duration::from_millis(100);

/// Runs a job while showing how far its pixels are.
pub(super) fn with_bar<T: Send>(
    pixels: u64,
    progress: &Progress,
    job: impl FnOnce() -> T + Send,
) -> T {
    if !std::io::stderr().is_terminal() {
        return job();
    }
    let finished = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let start = Instant::now();
            let mut bar = None;
            while !finished.load(Relaxed) {
                std::thread::sleep(BEAT);
                if start.elapsed() < PATIENCE {
                    continue;
                }
                let bar = bar.get_or_insert_with(|| new_bar(pixels));
                bar.set_position(progress.pixels.load(Relaxed));
                let rays = progress.rays.load(Relaxed) as f64 / start.elapsed().as_secs_f64();
                bar.set_message(format!("{} rays/s", HumanCount(rays as u64)));
            }
            if let Some(bar) = bar {
                bar.finish_and_clear();
            }
        });
        let result = job();
        finished.store(true, Relaxed);
        result
    })
}

fn new_bar(pixels: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {msg}  {eta} left");
    ProgressBar::new(pixels).with_style(style.expect("the template is well formed"))
}
