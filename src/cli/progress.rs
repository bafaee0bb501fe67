//! A progress bar for whatever takes more than a second, on terminals only.

use std::io::IsTerminal;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::mpsc;
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
    let done = || (progress.pixels.load(Relaxed), progress.rays.load(Relaxed));
    with_rate(Some(pixels), done, job)
}

/// Runs a job while showing how much of the whole (unknown if none) is done, and how many rays.
pub(super) fn with_rate<T: Send>(
    whole: Option<u64>,
    done: impl Fn() -> (u64, u64) + Sync,
    job: impl FnOnce() -> T + Send,
) -> T {
    let start = Instant::now();
    let status = || {
        let (done, rays) = done();
        let rate = rays as f64 / start.elapsed().as_secs_f64();
        (done, format!("{} rays/s", HumanCount(rate as u64)))
    };
    watch(whole, status, job)
}

/// Runs a job while saying what it is.
pub(super) fn with_word<T: Send>(word: &str, job: impl FnOnce() -> T + Send) -> T {
    watch(None, || (0, word.to_owned()), job)
}

/// Runs a job while showing what `status` says: how much is done, and a message.
fn watch<T: Send>(
    whole: Option<u64>,
    status: impl Fn() -> (u64, String) + Sync,
    job: impl FnOnce() -> T + Send,
) -> T {
    if !std::io::stderr().is_terminal() {
        return job();
    }
    // Dropped with the job's result, or if the job panics.
    let (running, finished) = mpsc::channel::<()>();
    let status = &status;
    std::thread::scope(move |scope| {
        scope.spawn(move || {
            let ended = |beat| finished.recv_timeout(beat) != Err(mpsc::RecvTimeoutError::Timeout);
            if ended(PATIENCE) {
                return;
            }
            let bar = new_bar(whole);
            // What was done before there was a bar took longer than none: it is no measure of the time left.
            bar.set_position(status().0);
            bar.reset_eta();
            while !ended(BEAT) {
                let (done, message) = status();
                bar.set_position(done);
                bar.set_message(message);
                bar.tick();
            }
            bar.finish_and_clear();
        });
        let result = job();
        drop(running);
        result
    })
}

fn new_bar(whole: Option<u64>) -> ProgressBar {
    let (bar, template) = match whole {
        Some(whole) => (ProgressBar::new(whole), "{wide_bar} {percent:>3} %  {msg}  {eta} left"),
        None => (ProgressBar::new_spinner(), "{spinner} {msg}  {elapsed}"),
    };
    let style = ProgressStyle::with_template(template);
    bar.with_style(style.expect("the template is well formed"))
}
