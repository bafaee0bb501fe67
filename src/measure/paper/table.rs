//! The table as text.

use std::fmt;

use super::{Column, Gain, NODE_BYTES, SceneReport, storage};
use crate::measure::grouped;
use crate::shadow::Method;

/// Width of the first column, and of the others.
const NAME: usize = 38;
const VALUE: usize = 15;

impl fmt::Display for SceneReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { published, width, height, samples_per_pixel, .. } = self;
        let samples = if *samples_per_pixel == 1 { "sample" } else { "samples" };
        let part = match self.every {
            1 => String::new(),
            every => format!(", one scanline in {every}"),
        };
        writeln!(
            f,
            "{} ({}): {width}x{height}, {samples_per_pixel} {samples} a pixel{part}, gains in {} ({})",
            published.title,
            published.scene,
            self.unit.name(),
            self.arithmetic
        )?;
        let mut row = |name: &str, paper: String, ours: &dyn Fn(&Column) -> String| {
            write!(f, "  {name:NAME$}{paper:>VALUE$}")?;
            for column in &self.columns {
                write!(f, "{:>VALUE$}", ours(column))?;
            }
            writeln!(f)
        };
        let none = String::new;
        row("", "paper".to_owned(), &|column| column.backend.to_owned())?;
        row("triangles", grouped(published.triangles), &|_| grouped(self.triangles as u64))?;
        row("lights that cast shadows", published.lights.to_string(), &|_| {
            self.lights.to_string()
        })?;
        row("rays", grouped(published.rays), &|column| grouped(column.rays.total()))?;
        row("  primary", none(), &|column| grouped(column.rays.primary))?;
        row("  reflected", none(), &|column| grouped(column.rays.reflected))?;
        row("  refracted", none(), &|column| grouped(column.rays.refracted))?;
        row("  shadow", none(), &|column| grouped(column.rays.shadow))?;
        let percent = |value: f64| format!("{value:.1} %");
        row("object cache success (Haines)", percent(published.object_rate), &|column| {
            percent(column.object_rate)
        })?;
        row("voxel cache success", percent(published.voxel_rate), &|column| {
            percent(column.voxel_rate)
        })?;
        let either = |object: f64, voxel: f64| percent(object + (1.0 - object / 100.0) * voxel);
        row("  either", either(published.object_rate, published.voxel_rate), &|column| {
            either(column.object_rate, column.voxel_rate)
        })?;
        row("gain: object cache over none", none(), &|column| gain(column.object_gain))?;
        let paper = |value: f64| format!("{value} %");
        row("gain: voxel over object cache", paper(published.voxel_gain), &|column| {
            gain(column.voxel_gain)
        })?;
        row("gain: cache tree over voxel cache", paper(published.tree_gain), &|column| {
            gain(column.tree_gain)
        })?;
        row("error: none over none", none(), &|column| gain(column.error))?;
        row("nodes of all cache trees", none(), &|column| grouped(memories(column)))?;
        row("  their bytes", none(), &|column| grouped(memories(column) * NODE_BYTES as u64))?;
        row("same picture by every method", none(), &|column| {
            if column.agree { "yes" } else { "NO" }.to_owned()
        })
    }
}

fn memories(column: &Column) -> u64 {
    let tree = column.methods.iter().find(|cost| cost.method == Method::CacheTree.name());
    tree.map_or(0, |tree| tree.shadows.memories)
}

/// 1.234 and 0.1 as 1.23 ±0.10 %.
pub fn gain(gain: Gain) -> String {
    let spread = gain.spread.map_or(String::new(), |spread| format!(" ±{spread:.2}"));
    format!("{:.2}{spread} %", gain.percent)
}

/// Table 1 and §10 beside ours.
#[must_use]
pub fn storage_table() -> String {
    let mut text = format!("A node of a cache tree: 16 bytes in the paper, {NODE_BYTES} here\n");
    for tree in storage(NODE_BYTES) {
        text += &format!(
            "  a whole tree of {:2} bounces: {:5} nodes, {} bytes; the paper: {}\n",
            tree.bounces,
            grouped(tree.nodes as u64),
            grouped(tree.bytes as u64),
            tree.claim
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_take_what_the_paper_says() {
        assert_eq!(NODE_BYTES, 16);
        let text = storage_table();
        assert!(text.contains("1,008 bytes") && text.contains("32,752 bytes"), "{text}");
    }
}
