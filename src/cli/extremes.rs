//! `umbra extremes`: what each engine and test gets wrong where it is hard.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::failure::{Failure, say};
use super::lists::known;
use super::numbers::whole;
use super::options::{MOST_THREADS, pool_for};
use super::outputs::{print_beside_files, write_json};
use super::progress::with_word;
use crate::measure::extremes::cases::{Case, cases};
use crate::measure::extremes::{Conditions, Report, examine, head};
use crate::measure::{contender, count};
use crate::occlusion::{Backend, BackendError, Test};

const DETAILS: &str = "\
Wrong answers are counted per million, against the exact verdict: false blocked, then false clear. Ties, which touch
something at an end of the ray only, are counted apart. All engines of umbra answer alike with the same test; where
one did not, a line below its case says so.

Exit status 1 if the exact test was wrong, or an engine of umbra differs from brute force.

Examples:
  umbra extremes
  umbra extremes --queries 1000000 --cases grazing,slivers --stats extremes.json";

/// Puts queries at the extremes to every engine and test, and counts the wrong answers
#[derive(Args)]
#[command(after_help = DETAILS)]
pub(super) struct Extremes {
    /// Rays of each case; a fiftieth of it where there are a million triangles
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = whole(1usize..))]
    queries: usize,
    /// The cases, by the names in the table; all if not given
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = parse_case)]
    cases: Vec<String>,
    /// The engines; all if not given
    #[arg(long, value_delimiter = ',', value_parser = known::<Backend>())]
    backends: Vec<Backend>,
    /// The triangle tests; all if not given
    #[arg(long, value_delimiter = ',', value_parser = known::<Test>())]
    tests: Vec<Test>,
    /// Threads; all processors if not given
    #[arg(long, value_name = "N", value_parser = whole(1..=MOST_THREADS))]
    threads: Option<usize>,
    /// Writes the table as JSON
    #[arg(long, value_name = "FILE")]
    stats: Option<PathBuf>,
}

#[derive(Serialize)]
struct Table<'a> {
    cases: &'a [Report],
}

impl Extremes {
    pub fn run(self) -> Result<(), Failure> {
        let pool = pool_for(self.stats.as_deref(), self.threads)?;
        let conditions = self.conditions();
        if let (true, Some(&test)) = (conditions.is_empty(), conditions.tests.first()) {
            let reason = BackendError::NotInEmbree(test);
            return Err(Failure::Input(format!("nothing to test: {reason}")));
        }
        for reason in self.left_out() {
            say!("umbra: left out: {reason}");
        }
        let wanted = |case: &Case| self.cases.is_empty() || self.cases.contains(&case.name);
        let cases: Vec<_> = cases().into_iter().filter(wanted).collect();
        let writes_files = self.stats.is_some();
        print_beside_files(&head(), writes_files)?;
        let mut reports = Vec::new();
        for case in &cases {
            let report = with_word(&case.what, || pool.install(|| examine(case, &conditions)))?;
            print_beside_files(&report.lines(), writes_files)?;
            reports.push(report);
        }
        if let Some(path) = &self.stats {
            write_json(path, &Table { cases: &reports })?;
        }
        match reports.iter().filter(|report| report.is_defect()).count() {
            0 => Ok(()),
            defects => {
                let cases = count(defects as u64, "case");
                Err(Failure::Comparison(format!("umbra is wrong in {cases}")))
            }
        }
    }

    /// Combinations that were asked for but do not exist, and why.
    fn left_out(&self) -> Vec<String> {
        let (backends, tests) = (self.backends.clone(), self.tests.clone());
        contender::Choice { backends, tests, ..contender::Choice::default() }.select().left_out
    }

    fn conditions(&self) -> Conditions {
        let backends = match &self.backends[..] {
            [] => Backend::ALL.into_iter().filter(|backend| backend.is_built_in()).collect(),
            chosen => chosen.to_vec(),
        };
        let tests = if self.tests.is_empty() { Test::ALL.to_vec() } else { self.tests.clone() };
        Conditions { queries: self.queries, backends, tests }
    }
}

fn parse_case(name: &str) -> Result<String, String> {
    let name = name.trim();
    let names: Vec<_> = cases().into_iter().map(|case| case.name).collect();
    if names.iter().any(|known| known == name) {
        return Ok(name.to_owned());
    }
    Err(format!("there is no such case; the cases are {}", names.join(", ")))
}
