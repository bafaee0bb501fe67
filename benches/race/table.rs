//! What came of a race: in full, and as tables in Markdown.

use std::fmt;

use umbra::render::Settings;

use super::bounds::Bounds;
use crate::common::short;

/// What one racer took.
pub struct Figures {
    pub name: String,
    pub embree: bool,
    /// Whether rays were sorted for it.
    pub sorted: bool,
    /// Whether it is of low quality.
    pub low: bool,
    /// Nanoseconds of preparation, and in each part.
    pub prepared: u64,
    pub parts: Vec<u64>,
    pub blocked: usize,
    pub bytes: usize,
}

impl Figures {
    /// Whether Embree is used as it mostly is: of medium or high quality, with rays as they come.
    fn is_usual(&self) -> bool {
        !self.sorted && !self.low
    }
}

/// A race over one scene.
pub struct Outcome {
    pub scene: String,
    pub triangles: usize,
    pub lights: usize,
    pub settings: Settings,
    /// Queries that were answered, and those of the whole picture.
    pub asked: usize,
    pub all: usize,
    /// That building the grid took.
    pub grid_nanoseconds: u64,
    pub figures: Vec<Figures>,
}

impl Outcome {
    /// Nanoseconds a query, those of preparation apart.
    fn answering(&self, who: &Figures) -> f64 {
        who.parts.iter().sum::<u64>() as f64 / self.asked as f64
    }

    /// Nanoseconds a query, preparation included.
    fn whole(&self, who: &Figures) -> f64 {
        self.answering(who) + who.prepared as f64 / self.all as f64
    }

    /// The fastest Embree of some kind.
    fn best(&self, such: impl Fn(&Figures) -> bool) -> Option<&Figures> {
        let these = self.figures.iter().filter(|who| who.embree && such(who));
        these.min_by(|a, b| self.whole(a).total_cmp(&self.whole(b)))
    }

    fn ours(&self, name: &str) -> Option<&Figures> {
        self.figures.iter().find(|who| !who.embree && who.name == name)
    }

    /// Nanoseconds a query of the fastest Embree of some kind, preparation included.
    fn fastest(&self, such: impl Fn(&Figures) -> bool) -> f64 {
        self.best(such).map_or(f64::NAN, |best| self.whole(best))
    }

    /// The time of the best Embree over that of somebody.
    fn ratio(&self, who: &Figures) -> f64 {
        self.fastest(|_| true) / self.whole(who)
    }

    /// The same of an Embree as it is mostly used.
    fn ratio_to_usual(&self, who: &Figures) -> f64 {
        self.fastest(Figures::is_usual) / self.whole(who)
    }

    /// The ratio if building the grid counts too.
    fn ratio_with_grid(&self, who: &Figures) -> f64 {
        let grid = self.grid_nanoseconds as f64 / self.all as f64;
        self.ratio(who) * self.whole(who) / (self.whole(who) + grid)
    }

    /// Quartiles of the ratio over the parts, without preparation.
    fn quartiles(&self, who: &Figures) -> [f64; 3] {
        let best = self.best(|_| true).map_or(&[][..], |best| &best.parts);
        let mut ratios: Vec<f64> =
            best.iter().zip(&who.parts).map(|(best, this)| *best as f64 / *this as f64).collect();
        ratios.sort_by(f64::total_cmp);
        [1, 2, 3].map(|quarter| {
            let place = ratios.len().saturating_sub(1) * quarter / 4;
            ratios.get(place).copied().unwrap_or(f64::NAN)
        })
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { scene, triangles, lights, settings, asked, all, .. } = self;
        let Settings { width, height, samples, .. } = settings;
        let samples = samples * samples;
        write!(f, "{scene}: {triangles} triangles, {lights} lights, {width}x{height}, ")?;
        write!(f, "{samples} samples a pixel, {asked} of {all} shadow queries")?;
        let columns = ["prepared ms", "ns a query", "with prep."];
        write!(f, "\n  {:52}{:>12}{:>12}{:>12}", "", columns[0], columns[1], columns[2])?;
        write!(f, "{:>8}  {:16}{:>12}{:>12}", "ratio", "quartiles", "blocked", "MB")?;
        for who in &self.figures {
            let name = format!("{} {}", if who.embree { "embree" } else { "umbra" }, who.name);
            let (answering, whole) = (self.answering(who), self.whole(who));
            write!(
                f,
                "\n  {name:52}{:12.1}{answering:12.1}{whole:12.1}",
                who.prepared as f64 / 1e6
            )?;
            let [first, median, third] = self.quartiles(who);
            write!(f, "{:8.2}  {first:.2} {median:.2} {third:.2}  ", self.ratio(who))?;
            write!(f, "{:12}{:12.1}", who.blocked, who.bytes as f64 / 1e6)?;
        }
        Ok(())
    }
}

/// Ours that have a ratio in the tables.
const RATED: [&str; 3] = ["shaft", "auto", "light-buffer"];

/// Two tables of several races, and their means: who is how much faster, and what lies behind it.
pub fn markdown(outcomes: &[Outcome], bounds: &Bounds) -> String {
    let mut lines = vec![
        "| scene | queries | best Embree | ns | usual, ns | `shaft`, ns | `auto`, ns | ratio of `shaft` | quartiles, built | of `auto` | with the grid | over usual: `shaft`, `auto` |".to_owned(),
        format!("|{}", " --- |".repeat(12)),
    ];
    lines.extend(outcomes.iter().filter_map(ratios));
    let mean = |name: &str, what: &str, ratio: fn(&Outcome, &Figures) -> f64| {
        let ratios =
            outcomes.iter().filter_map(|outcome| Some(ratio(outcome, outcome.ours(name)?)));
        let ratios: Vec<f64> = ratios.collect();
        let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
        format!("{:.2} for `{name}`{what} (least {least:.2})", geometric_mean(&ratios))
    };
    let mut means = RATED.map(|name| mean(name, "", Outcome::ratio)).to_vec();
    means.push(mean("auto", " with the grid", Outcome::ratio_with_grid));
    for name in ["shaft", "auto"] {
        means.push(mean(name, " over Embree as usual", Outcome::ratio_to_usual));
    }
    lines.push(format!("\nGeometric mean of the ratios: {}.\n", means.join(", ")));
    lines.push("| scene | if sorted, ns | grid `trace`, ns | `light-buffer`, ns | ratio of it | MB: Embree, `shaft`, `light-buffer` | over the bound: Embree, `shaft`, `auto` |".to_owned());
    lines.push(format!("|{}", " --- |".repeat(7)));
    lines.extend(outcomes.iter().filter_map(|outcome| behind(outcome, bounds)));
    lines.push(format!("\n{bounds}"));
    if outcomes.iter().any(|outcome| outcome.asked < outcome.all) {
        lines.push(
            "Only some tiles were answered: what `light-buffer` and `auto` built while answering is charged to those alone.".to_owned(),
        );
    }
    lines.join("\n")
}

fn ratios(outcome: &Outcome) -> Option<String> {
    let best = outcome.best(|_| true)?;
    let (shaft, auto) = (outcome.ours("shaft")?, outcome.ours("auto")?);
    let [first, median, third] = outcome.quartiles(shaft);
    Some(format!(
        "| {} | {:.1} M | {} | {} | {} | {} | {} | **{:.2}** | {first:.2} {median:.2} {third:.2} | {:.2} | {:.2} | {:.2}, {:.2} |",
        outcome.scene,
        outcome.all as f64 / 1e6,
        best.name,
        short(outcome.whole(best)),
        short(outcome.fastest(Figures::is_usual)),
        short(outcome.whole(shaft)),
        short(outcome.whole(auto)),
        outcome.ratio(shaft),
        outcome.ratio(auto),
        outcome.ratio_with_grid(auto),
        outcome.ratio_to_usual(shaft),
        outcome.ratio_to_usual(auto),
    ))
}

fn behind(outcome: &Outcome, bounds: &Bounds) -> Option<String> {
    let best = outcome.best(|_| true)?;
    let [trace, buffer, shaft, auto] =
        ["trace", "light-buffer", "shaft", "auto"].map(|name| outcome.ours(name));
    let (trace, buffer, shaft, auto) = (trace?, buffer?, shaft?, auto?);
    let megabytes =
        [best, shaft, buffer].map(|who| format!("{:.1}", who.bytes as f64 / 1e6)).join(", ");
    let over = [best, shaft, auto]
        .map(|who| format!("{:.1}", outcome.whole(who) / bounds.query()))
        .join(", ");
    Some(format!(
        "| {} | {} | {} | {} | {:.2} | {megabytes} | {over} |",
        outcome.scene,
        short(outcome.fastest(|embree| embree.sorted)),
        short(outcome.whole(trace)),
        short(outcome.whole(buffer)),
        outcome.ratio(buffer),
    ))
}

fn geometric_mean(values: &[f64]) -> f64 {
    (values.iter().map(|value| value.ln()).sum::<f64>() / values.len() as f64).exp()
}
