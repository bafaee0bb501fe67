//! What one light sees, block by block; each block is made when a query first asks it.

use std::sync::OnceLock;

use super::LightBuffer;
use super::block::{Asked, Block};
use super::view::{LightView, View};
use crate::geometry::{Bounds, Ray};
use crate::occlusion::Cluster;
use crate::scene::Light;

/// Blocks along the side of a face of the cube.
const CUBE_BLOCKS: usize = 8;

/// Blocks along the side of the grid of a directional light.
const PARALLEL_BLOCKS: usize = 16;

/// A light with more clusters than this right beside it is left to the backend: each is tested for each query.
const MOST_NEAR: usize = 16;

/// The view of one light, and who is in it.
pub(super) struct LightMap {
    view: LightView,
    /// Blocks along the side of a face.
    side: usize,
    /// Clusters that are too near to the light to be projected.
    pub near: Vec<u32>,
    /// Where the members of each block start; one more than there are blocks.
    starts: Vec<u32>,
    /// The clusters that each block may show.
    members: Vec<u32>,
    blocks: Vec<OnceLock<Option<Block>>>,
}

impl LightMap {
    /// Sorts the clusters into blocks; `None` if the light is not one for a light buffer.
    pub fn new(light: &Light, scene: &Bounds, clusters: &[Cluster]) -> Option<Self> {
        let view = LightView::new(light, scene)?;
        let side = match view.view {
            View::Cube { .. } => CUBE_BLOCKS,
            View::Parallel { .. } => PARALLEL_BLOCKS,
        };
        let blocks = view.faces() * side * side;
        let mut near = Vec::new();
        let mut pairs: Vec<(u32, u32)> = Vec::with_capacity(clusters.len() * 5 / 4);
        for (index, cluster) in (0..).zip(clusters) {
            if !view.blocks_of(cluster, side, |block| pairs.push((block as u32, index))) {
                near.push(index);
                if near.len() > MOST_NEAR {
                    return None;
                }
            }
        }
        let mut starts = vec![0u32; blocks + 1];
        for &(block, _) in &pairs {
            starts[block as usize + 1] += 1;
        }
        for block in 0..blocks {
            starts[block + 1] += starts[block];
        }
        let mut next = starts.clone();
        let mut members = vec![0; pairs.len()];
        for &(block, index) in &pairs {
            members[next[block as usize] as usize] = index;
            next[block as usize] += 1;
        }
        let blocks = (0..blocks).map(|_| OnceLock::new()).collect();
        Some(Self { view, side, near, starts, members, blocks })
    }

    /// What a ray asks; `None` if it cannot be answered here.
    #[inline(always)]
    pub fn ask(&self, ray: &Ray, clusters: &[Cluster], buffer: &LightBuffer) -> Option<Asked<'_>> {
        let place = self.view.place(ray)?;
        let along =
            |value: f32| (((value + 1.0) * (0.5 * self.side as f32)) as usize).min(self.side - 1);
        let (column, row) = (along(place.u), along(place.v));
        let index = (place.face * self.side + row) * self.side + column;
        let block = match self.blocks[index].get() {
            Some(block) => block,
            None => self.blocks[index]
                .get_or_init(|| self.make(index, place.face, [column, row], clusters, buffer)),
        };
        Some(block.as_ref()?.asked(place.u, place.v, place.depth))
    }

    #[cold]
    fn make(
        &self,
        index: usize,
        face: usize,
        place: [usize; 2],
        clusters: &[Cluster],
        buffer: &LightBuffer,
    ) -> Option<Block> {
        let side = 2.0 / self.side as f32;
        let low = place.map(|place| place as f32 * side - 1.0);
        let members = &self.members[self.starts[index] as usize..self.starts[index + 1] as usize];
        buffer.admit_block(members.len(), || {
            Block::new(&self.view, face, low, side, clusters, members)
        })
    }

    /// Bytes held, blocks apart.
    pub fn memory(&self) -> usize {
        size_of_val(&*self.starts) + size_of_val(&*self.members) + size_of_val(&*self.blocks)
    }
}

impl LightView {
    /// Calls `found` with every block that a cluster may be seen in; `false` if it is too near.
    fn blocks_of(&self, cluster: &Cluster, side: usize, mut found: impl FnMut(usize)) -> bool {
        let mut low = [f32::INFINITY; 3];
        let mut high = [f32::NEG_INFINITY; 3];
        for corner in 0..3 {
            for (axis, values) in cluster.corner(corner).iter().enumerate() {
                for value in values {
                    low[axis] = low[axis].min(*value);
                    high[axis] = high[axis].max(*value);
                }
            }
        }
        let reach = 3.0 * self.pad;
        let mut mark = |face: usize, u: (f32, f32), v: (f32, f32)| {
            let along = |value: f32| {
                (((value + 1.0) * (0.5 * side as f32)).max(0.0) as usize).min(side - 1)
            };
            // A query at the very edge of a block may be placed in the next.
            let slack = 1.0 / 4096.0;
            if u.0 > 1.0 + slack || u.1 < -1.0 - slack || v.0 > 1.0 + slack || v.1 < -1.0 - slack {
                return;
            }
            for row in along(v.0 - slack)..=along(v.1 + slack) {
                for column in along(u.0 - slack)..=along(u.1 + slack) {
                    found((face * side + row) * side + column);
                }
            }
        };
        match &self.view {
            View::Cube { light } => {
                let low = [0, 1, 2].map(|axis| low[axis] - light[axis] - reach);
                let high = [0, 1, 2].map(|axis| high[axis] - light[axis] + reach);
                let gap = [0, 1, 2].map(|axis| low[axis].max(-high[axis]).max(0.0));
                let distance = gap[0].max(gap[1]).max(gap[2]);
                if distance <= self.near {
                    return false;
                }
                for axis in 0..3 {
                    let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
                    for (face, near, far) in
                        [(2 * axis, low[axis], high[axis]), (2 * axis + 1, -high[axis], -low[axis])]
                    {
                        if far <= 0.0 || gap[a].max(gap[b]) > 1.01 * far {
                            continue;
                        }
                        let near = near.max(distance / 1.01);
                        let span = |axis: usize| {
                            let least = low[axis] / if low[axis] > 0.0 { far } else { near };
                            let most = high[axis] / if high[axis] > 0.0 { near } else { far };
                            (least, most)
                        };
                        mark(face, span(a), span(b));
                    }
                }
            }
            View::Parallel { centre, across, half, .. } => {
                let centre_of = |axis: usize| 0.5 * (low[axis] + high[axis]) - centre[axis];
                let middle = glam::Vec3::new(centre_of(0), centre_of(1), centre_of(2));
                let radius = glam::Vec3::from_array(
                    [0, 1, 2].map(|axis| 0.5 * (high[axis] - low[axis]) + reach),
                );
                let span = |across: &glam::Vec3| {
                    let (place, radius) = (across.dot(middle), across.abs().dot(radius));
                    ((place - radius) / half, (place + radius) / half)
                };
                mark(0, span(&across[0]), span(&across[1]));
            }
        }
        true
    }
}
