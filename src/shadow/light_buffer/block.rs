//! A block of the view: cells with lists of the clusters that may stand in the way, nearest to the
//! light first.

use super::footprint::{Covered, FINE, Window, cover};
use super::view::LightView;
use crate::occlusion::Cluster;

/// Cells to a cluster of a block, about: more cells make shorter lists, but a cluster is listed in more of them.
const DENSITY: f64 = 0.25;

/// Most cells along the side of a block.
const MOST_CELLS: usize = 64;

/// The cells of one block.
#[derive(Debug)]
pub(super) struct Block {
    window: Window,
    /// Cells to a unit of u and v.
    scale: f32,
    /// The depth that is coded as 0, and codes to a unit of depth.
    least: f32,
    codes: f32,
    /// Where each cell's list starts; one more than there are cells.
    starts: Vec<u32>,
    /// Of each entry, the code of its least depth (upper half) and the fine cells it covers.
    keys: Vec<u32>,
    /// Of each entry, the cluster.
    clusters: Vec<u32>,
    /// Of each cell, the depth behind which it is dark; none if no cell is.
    full: Vec<f32>,
}

/// Codes of depths.
const CODES: f32 = 65_000.0;

/// What a query asks a block: a list of entries, and which of them count.
pub(super) struct Asked<'a> {
    pub keys: &'a [u32],
    pub clusters: &'a [u32],
    /// The key of the farthest entry that counts, all bits of fine cells set.
    pub last: u32,
    /// The bit of the query's fine cell.
    pub fine: u32,
    /// Whether one triangle is known to stand before all of the cell, and the query behind it.
    pub dark: bool,
}

impl Block {
    /// Lists these clusters in a square part of a face.
    pub fn new(
        view: &LightView,
        face: usize,
        low: [f32; 2],
        side: f32,
        all: &[Cluster],
        members: &[u32],
    ) -> Self {
        let wanted = (DENSITY * members.len() as f64).sqrt();
        let cells = (1 << wanted.max(1.0).log2().round() as u32).min(MOST_CELLS);
        let window = Window { face, low, side, cells };
        let mut covered = Covered::new();
        let mut full = vec![f32::INFINITY; cells * cells];
        // The least depth, the cluster, and its part of `covered`.
        let mut listed: Vec<(f32, u32, u32, u32)> = Vec::with_capacity(members.len());
        for &member in members {
            let start = covered.len() as u32;
            if let Some(depth) =
                cover(view, &window, &all[member as usize], &mut covered, &mut full)
            {
                listed.push((depth, member, start, covered.len() as u32));
            }
        }
        listed.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let least = listed.first().map_or(0.0, |first| first.0);
        let greatest = listed.last().map_or(0.0, |last| last.0);
        let codes = CODES / (greatest - least).max(f32::MIN_POSITIVE * CODES);
        let mut starts = vec![0u32; cells * cells + 1];
        for &(cell, _) in &covered {
            starts[usize::from(cell) + 1] += 1;
        }
        for cell in 0..cells * cells {
            starts[cell + 1] += starts[cell];
        }
        let mut next = starts.clone();
        let mut keys = vec![0; covered.len()];
        let mut clusters = vec![0; covered.len()];
        for &(depth, member, start, end) in &listed {
            // Rounded down, and one more: see `asked`.
            let code = ((depth - least) * codes) as u32;
            for &(cell, mask) in &covered[start as usize..end as usize] {
                let place = &mut next[usize::from(cell)];
                keys[*place as usize] = code << 16 | u32::from(mask);
                clusters[*place as usize] = member;
                *place += 1;
            }
        }
        if full.iter().all(|depth| depth.is_infinite()) {
            full = Vec::new();
        }
        Self { window, scale: cells as f32 / side, least, codes, starts, keys, clusters, full }
    }

    /// The list for a query at this place of the block.
    #[inline(always)]
    pub fn asked(&self, u: f32, v: f32, depth: f32) -> Asked<'_> {
        let cells = self.window.cells;
        let fine = |value: f32, low: f32| {
            (((value - low) * self.scale * FINE as f32) as usize).min(cells * FINE - 1)
        };
        let (column, row) = (fine(u, self.window.low[0]), fine(v, self.window.low[1]));
        let cell = row / FINE * cells + column / FINE;
        let list = self.starts[cell] as usize..self.starts[cell + 1] as usize;
        // The conversion saturates. Two more than rounded down, for rounding here and there.
        let behind = (depth - self.least) * self.codes;
        let code = if behind < 0.0 { 0 } else { (behind as u32).saturating_add(2).min(0xffff) };
        Asked {
            keys: &self.keys[list.clone()],
            clusters: &self.clusters[list],
            last: code << 16 | 0xffff,
            fine: 1 << (FINE * (row % FINE) + column % FINE),
            dark: self.full.get(cell).is_some_and(|&full| depth > full),
        }
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        size_of::<Self>()
            + size_of_val(&*self.starts)
            + size_of_val(&*self.keys)
            + size_of_val(&*self.clusters)
            + size_of_val(&*self.full)
    }
}
