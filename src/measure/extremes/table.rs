//! The table as text: a line a case, wrong answers per million.

use std::fmt::Write;

use super::{Answers, Report};
use crate::occlusion::{Backend, Test};

/// Width of the names, and of the numbers.
const NAME: usize = 30;
const VALUE: usize = 9;

/// What has a column: all engines of ours with one test answer alike, or a line below says so.
const COLUMNS: [(&str, Backend, Test); 6] = [
    ("exact", Backend::Brute, Test::Exact),
    ("watertight", Backend::Brute, Test::Watertight),
    ("pluecker", Backend::Brute, Test::Pluecker),
    ("moller", Backend::Brute, Test::Moller),
    ("embree robust", Backend::Embree, Test::Pluecker),
    ("embree fast", Backend::Embree, Test::Moller),
];

/// The head of the table.
#[must_use]
pub fn head() -> String {
    let mut text = format!("{:NAME$}", "false blocked, false clear");
    for (name, ..) in COLUMNS {
        let _ = write!(text, "{name:>width$}", width = 2 * VALUE);
    }
    text + &format!("{:>VALUE$}\n", "ties")
}

impl Report {
    /// The lines of one case.
    #[must_use]
    pub fn lines(&self) -> String {
        let mut text = format!("{:NAME$}", self.case);
        for (_, backend, test) in COLUMNS {
            let found = self.answers_of(backend, test);
            for wrong in [found.map(|f| f.false_blocked), found.map(|f| f.false_clear)] {
                let number = wrong.map_or_else(|| "-".to_owned(), |wrong| self.per_million(wrong));
                let _ = write!(text, "{number:>VALUE$}");
            }
        }
        let _ = writeln!(text, "{:>VALUE$}", self.per_million(self.ties));
        if self.oracle_disagrees > 0 {
            let _ = writeln!(text, "  *** the oracle disagrees on {} rays", self.oracle_disagrees);
        }
        for defect in self.answers.iter().filter(|answers| answers.is_defect()) {
            let Answers { backend, test, false_blocked, false_clear, blocked_ties, .. } = defect;
            let unlike = defect.unlike_brute.unwrap_or_default();
            let _ = writeln!(
                text,
                "  *** {backend} {test}: {false_blocked} false blocked, {false_clear} false clear, {blocked_ties} ties blocked, {unlike} unlike brute force"
            );
        }
        text
    }

    /// What an engine with a test answered; any engine of ours stands for brute force if that was not asked.
    fn answers_of(&self, backend: Backend, test: Test) -> Option<&Answers> {
        let with_test = || self.answers.iter().filter(|answers| answers.test == test.name());
        let is_peer = |answers: &Answers| answers.backend == Backend::Embree.name();
        match backend {
            Backend::Embree => with_test().find(|answers| is_peer(answers)),
            _ => with_test().find(|answers| !is_peer(answers)),
        }
    }

    fn per_million(&self, count: u64) -> String {
        let share = 1e6 * count as f64 / self.rays as f64;
        if count == 0 { "0".to_owned() } else { format!("{share:.0}") }
    }
}
