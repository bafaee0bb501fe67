//! `umbra certify`: the exact test against the oracle, for as long as one likes.

use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::{Duration, Instant};

use clap::Args;
use serde::Serialize;

use super::failure::Failure;
use super::lists::among;
use super::numbers::whole;
use super::options::{MOST_THREADS, pool_for};
use super::outputs::{print_beside_files, write_json};
use super::progress::with_rate;
use crate::exact::adversary::Class;
use crate::exact::campaign::{Summary, campaign};
use crate::measure::{count, grouped};

/// Queries of a class between two looks at the clock: a second's work at most.
const BLOCK: u64 = 100_000;

const DETAILS: &str = "\
Every query is one ray and one triangle that are hard to get right, and depends on nothing but its class and
index. The filter in f32 (with and without fused multiplications), f64 with a bound, and expansions all decide
it; one in 100 is also put to the oracle, which computes with big integers. Wrong is what any two disagree on.

Exit status 1 if anything was wrong.

Examples:
  umbra certify                                    # a million of each class
  umbra certify --queries 5000000 --stats certified.json
  umbra certify --classes sliver,grazing --seconds 600 --queries 1000000000";

/// Holds the exact test against exact arithmetic on queries that are hard to get right
#[derive(Args)]
#[command(after_help = DETAILS)]
pub(super) struct Certify {
    /// Queries of each class
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = whole(1u64..))]
    queries: u64,
    /// Kinds of queries; all if not given
    #[arg(long, value_name = "NAMES", value_delimiter = ',',
          value_parser = among(Class::ALL.iter().map(|class| class.name())))]
    classes: Vec<String>,
    /// Stops after so long, with as many queries as there was time for
    #[arg(long, value_name = "S", value_parser = whole(1u64..))]
    seconds: Option<u64>,
    /// Threads; all processors if not given
    #[arg(long, value_name = "N", value_parser = whole(1..=MOST_THREADS))]
    threads: Option<usize>,
    /// Writes the table as JSON
    #[arg(long, value_name = "FILE")]
    stats: Option<PathBuf>,
}

/// What was found about a class.
#[derive(Serialize)]
struct Row {
    class: &'static str,
    #[serde(flatten)]
    summary: Summary,
}

#[derive(Serialize)]
struct Report<'a> {
    classes: &'a [Row],
    all: Summary,
    seconds: f64,
}

impl Certify {
    pub fn run(self) -> Result<(), Failure> {
        let pool = pool_for(self.stats.as_deref(), self.threads)?;
        let start = Instant::now();
        let done = AtomicU64::new(0);
        let whole = self.queries.saturating_mul(self.classes().count() as u64);
        let rows = with_rate(
            Some(whole),
            || {
                let queries = done.load(Relaxed);
                (self.how_far(whole, queries, start.elapsed()), queries)
            },
            || pool.install(|| self.certify(start, &done)),
        );
        let all = rows.iter().fold(Summary::default(), |all, row| all + row.summary);
        let seconds = start.elapsed().as_secs_f64();
        print_beside_files(&table(&rows, all, seconds), self.stats.is_some())?;
        if let Some(path) = &self.stats {
            write_json(path, &Report { classes: &rows, all, seconds })?;
        }
        match all.wrong {
            0 => Ok(()),
            wrong => {
                let answers = count(all.queries, "answer");
                Err(Failure::Comparison(format!("wrong: {} of {answers}", grouped(wrong))))
            }
        }
    }

    fn classes(&self) -> impl Iterator<Item = Class> {
        let wanted = |class: &Class| {
            self.classes.is_empty() || self.classes.iter().any(|name| name == class.name())
        };
        Class::ALL.iter().copied().filter(wanted)
    }

    /// How much of the whole is done, by the queries or by the time, whichever will end it.
    fn how_far(&self, whole: u64, queries: u64, elapsed: Duration) -> u64 {
        let share = self.seconds.map_or(0.0, |seconds| elapsed.as_secs_f64() / seconds as f64);
        queries.max((share * whole as f64) as u64).min(whole)
    }

    /// Takes the classes in turns, so that all get as far where the time is limited.
    fn certify(&self, start: Instant, done: &AtomicU64) -> Vec<Row> {
        let mut rows: Vec<_> = self
            .classes()
            .map(|class| (class, Row { class: class.name(), summary: Summary::default() }))
            .collect();
        let limit = self.seconds.map(Duration::from_secs);
        'blocks: for first in (0..self.queries).step_by(BLOCK as usize) {
            let indices = first..self.queries.min(first.saturating_add(BLOCK));
            for (class, row) in &mut rows {
                if limit.is_some_and(|limit| start.elapsed() >= limit) {
                    break 'blocks;
                }
                row.summary = row.summary + campaign(*class, indices.clone());
                done.fetch_add(indices.end - indices.start, Relaxed);
            }
        }
        rows.into_iter().map(|(_, row)| row).collect()
    }
}

fn table(rows: &[Row], all: Summary, seconds: f64) -> String {
    let mut text = line(
        "class",
        [
            "queries",
            "blocked",
            "clear",
            "ties",
            "by f32",
            "by f64",
            "by expansions",
            "to oracle",
            "wrong",
        ]
        .map(str::to_owned),
    );
    let numbers = |summary: &Summary| {
        [
            summary.queries,
            summary.blocked,
            summary.clear,
            summary.ties,
            summary.by_filter,
            summary.by_double,
            summary.by_expansion,
            summary.by_oracle,
            summary.wrong,
        ]
        .map(grouped)
    };
    for row in rows {
        text += &line(row.class, numbers(&row.summary));
    }
    text += &line("all", numbers(&all));
    text += &format!("{seconds:.0} s\n");
    text
}

fn line(name: &str, columns: [String; 9]) -> String {
    let mut line = format!("{name:18}");
    for column in columns {
        line += &format!("{column:>14}");
    }
    line + "\n"
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Arguments {
        #[command(flatten)]
        certify: Certify,
    }

    fn certify(line: &str) -> Certify {
        Arguments::parse_from(line.split(' ')).certify
    }

    #[test]
    fn where_time_ends_it_progress_is_that_of_the_time() {
        let limited = certify("certify --queries 1000000 --seconds 4");
        let far =
            |queries, seconds| limited.how_far(1_000_000, queries, Duration::from_secs(seconds));
        assert_eq!(far(10, 1), 250_000);
        assert_eq!(far(10, 5), 1_000_000, "the last queries may take longer");
        assert_eq!(far(900_000, 1), 900_000, "the queries end it");
        let forever = certify("certify --queries 1000000");
        assert_eq!(forever.how_far(1_000_000, 10, Duration::from_secs(100)), 10);
    }
}
