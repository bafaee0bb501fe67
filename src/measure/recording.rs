//! The shadow queries of a render, recorded once so that every contender gets the same bits.

use std::ops::Range;

use rayon::prelude::*;

use crate::exact::Exact;
use crate::geometry::Ray;
use crate::occlusion::{Bvh2, Engine, Occlusion};
use crate::render::{Progress, RecordedQuery, Settings, SettingsError, render};
use crate::scene::{Scene, default_budget};
use crate::shadow::{Answer, Prepared, ShadowQuery, Trace};

/// Queries that one worker answers with the same memories, at least; a tile with one light asks 256.
const BLOCK: usize = 4096;

/// The shadow queries of a picture: tile by tile, within a tile generation by generation and light by light, as the renderer asks them.
#[derive(Clone, Debug)]
pub struct Recording {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    queries: Vec<RecordedQuery>,
    /// Queries that the renderer asks at once: about one light, of one generation of a unit.
    runs: Vec<Range<usize>>,
    /// Runs that make up a block.
    blocks: Vec<Range<usize>>,
}

/// Why a picture's queries are not recorded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "a picture of {pixels} pixels with {samples} samples each and {lights} lights may ask {queries} shadow queries or more, which take {needed:.1} GiB; give a smaller size or fewer samples"
)]
pub struct TooManyQueries {
    pixels: u64,
    samples: u64,
    lights: u64,
    queries: u64,
    needed: f64,
}

/// No light faces anything that the camera sees: nothing to answer.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{scene}: no shadow query is asked in this picture; give the scene another camera or light"
)]
pub struct NoQueries {
    /// The scene.
    pub scene: String,
}

impl Recording {
    /// Whether the queries of such a picture may be expected to fit into memory: those of primary hits into a
    /// quarter of it.
    ///
    /// # Errors
    /// If they may not.
    pub fn check(scene: &Scene, settings: &Settings) -> Result<(), TooManyQueries> {
        // While a picture is put together, its units' queries are there twice.
        const BYTES: u64 = 2 * size_of::<RecordedQuery>() as u64;
        let pixels = u64::from(settings.width) * u64::from(settings.height);
        let samples = u64::from(settings.samples) * u64::from(settings.samples);
        let lights = scene.lights.len() as u64;
        let queries = pixels.saturating_mul(samples).saturating_mul(lights);
        let needed = queries.saturating_mul(BYTES);
        if needed <= default_budget() {
            return Ok(());
        }
        let needed = needed as f64 / f64::from(1 << 30);
        Err(TooManyQueries { pixels, samples, lights, queries, needed })
    }

    /// Renders the picture by the exact test, and keeps what was asked.
    ///
    /// # Errors
    /// If the settings make no picture.
    pub fn of(
        scene: &Scene,
        settings: &Settings,
        progress: &Progress,
    ) -> Result<Self, SettingsError> {
        let walk = Bvh2::new(&scene.triangles);
        let engine = Engine::<_, Exact>::new(scene.triangles.clone(), walk, None);
        let settings = Settings { record: true, ..*settings };
        let rendered = render(scene, &engine, &Trace::new(&engine), &settings, progress)?;
        Ok(Self::new(settings.width, settings.height, rendered.queries))
    }

    /// Queries of a picture of that size, unit by unit, in the order in which they are to be asked.
    #[must_use]
    pub fn new(width: u32, height: u32, units: Vec<Vec<RecordedQuery>>) -> Self {
        let (mut runs, mut blocks) = (Vec::new(), Vec::new());
        let (mut end, mut first_run, mut first_query) = (0, 0, 0);
        for (place, unit) in units.iter().enumerate() {
            for run in unit.chunk_by(RecordedQuery::is_asked_with) {
                runs.push(end..end + run.len());
                end += run.len();
            }
            if end - first_query >= BLOCK || place + 1 == units.len() {
                blocks.push(first_run..runs.len());
                (first_run, first_query) = (runs.len(), end);
            }
        }
        Self { width, height, queries: units.concat(), runs, blocks }
    }

    /// Whether there is anything to answer; `scene` is what the scene is called.
    ///
    /// # Errors
    /// If there is not.
    pub fn check_asked(&self, scene: &str) -> Result<(), NoQueries> {
        if self.queries.is_empty() { Err(NoQueries { scene: scene.to_owned() }) } else { Ok(()) }
    }

    /// The queries.
    #[must_use]
    pub fn queries(&self) -> &[RecordedQuery] {
        &self.queries
    }

    /// Their rays.
    pub fn rays(&self) -> impl ExactSizeIterator<Item = &Ray> {
        self.queries.iter().map(|recorded| &recorded.query.ray)
    }

    /// The runs of queries that are asked at once, in order: light and place.
    pub fn runs(&self) -> impl Iterator<Item = (usize, Range<usize>)> {
        self.runs.iter().map(|run| (self.queries[run.start].light as usize, run.clone()))
    }

    /// Asks a method all queries, on all threads of the current pool: whether each is blocked. Memories are
    /// fresh at places that do not depend on the number of threads.
    #[must_use]
    pub fn answers(&self, method: &dyn Prepared) -> Vec<bool> {
        let answered: Vec<Vec<bool>> =
            self.blocks.par_iter().map(|block| self.answer_block(method, block.clone())).collect();
        answered.concat()
    }

    fn answer_block(&self, method: &dyn Prepared, block: Range<usize>) -> Vec<bool> {
        let mut worker = method.worker();
        let mut blocked = Vec::new();
        let (mut asked, mut answers): (Vec<ShadowQuery>, Vec<Answer>) = (Vec::new(), Vec::new());
        for run in &self.runs[block] {
            let queries = &self.queries[run.clone()];
            asked.clear();
            asked.extend(queries.iter().map(|recorded| recorded.query));
            answers.clear();
            answers.resize(asked.len(), Answer::default());
            worker.answer(queries[0].light as usize, &asked, &mut answers);
            blocked.extend(answers.iter().map(|answer| answer.blocked));
        }
        blocked
    }

    /// Asks an engine alone.
    #[must_use]
    pub fn answers_of(&self, engine: &dyn Occlusion) -> Vec<bool> {
        self.answers(&Trace::new(engine))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;

    #[test]
    fn a_picture_with_one_light_is_answered_call_by_call_as_it_was_rendered_on_all_threads() {
        let mut draft = builtin::draft_at("drum", 0.02).unwrap();
        draft.lights.truncate(1);
        let scene = draft.finish().unwrap();
        let settings = Settings { width: 96, height: 72, samples: 2, ..Settings::default() };
        let recording = Recording::of(&scene, &settings, &Progress::default()).unwrap();
        let mut ends = Vec::new();
        let walk =
            Engine::<_, Exact>::new(scene.triangles.clone(), Bvh2::new(&scene.triangles), None);
        let mut end = 0;
        crate::render::record(&scene, &walk, &Trace::new(&walk), &settings, |unit| {
            for run in unit.chunk_by(RecordedQuery::is_asked_with) {
                end += run.len();
                ends.push(end);
            }
        })
        .unwrap();
        let runs: Vec<usize> = recording.runs().map(|(_, run)| run.end).collect();
        assert_eq!(runs, ends);
        assert!(runs.len() > 3 && recording.blocks.len() > 1, "{runs:?} {:?}", recording.blocks);
        let answered: usize = recording.blocks.iter().map(|block| block.len()).sum();
        assert_eq!(answered, runs.len());
    }
}
