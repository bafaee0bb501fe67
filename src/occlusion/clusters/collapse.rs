//! From a tree of halves to nodes of eight children.
//!
//! A node is visited by what meets its box, as often as its surface is large; so halves are put into nodes such that the surfaces of
//! all nodes together are the least. What a half costs at best, if it may take one place in the node above it or several,
//! follows from what its own halves cost (Ylitie, Karras & Laine 2017); 64 sums a half, made when it is, in rows of eight. Opening the largest box
//! until a node is full leaves many nodes with few children: bundles visit a tenth more of them.
//!
//! Halves lie in a row, not each in memory of its own, which would cost a tenth of the time of building; and what one thread has built is
//! put into nodes at once, while it is in a near cache. That forces a node around each such piece, one in a hundred and more.
//!
//! Ylitie, Karras, Laine: Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs. High Performance Graphics 2017.

use std::ops::Range;

use glam::Vec3;

use super::{Child, Node, WIDTH};
use crate::geometry::Bounds;
use crate::large_pages::vec_with_room;

/// A tree while it is built: halves in a row, each after what is in it, the whole one last. Or a single one that stands for trees
/// that were built apart, or for nodes.
#[derive(Default)]
pub(super) struct Tree {
    halves: Vec<Half>,
}

/// A part of the tree.
struct Half {
    bounds: Bounds,
    /// The least surface of all nodes in it, itself among them, if it takes at most 1, 2 … places. 0 of a cluster, and of nodes that are
    /// made already: what they have is the same wherever they are put.
    surface: [f32; WIDTH],
    inside: Inside,
}

enum Inside {
    /// Of these items.
    Cluster(Range<u32>),
    /// Two others: the left one is at this place, the right one right before this half.
    Halves(u32),
    /// Two that were built apart.
    Trees(Box<[Tree; 2]>),
    /// Nodes already.
    Nodes(Box<Nodes>),
}

/// Nodes, the root first, and the runs of items that are clusters, in the order of their numbers.
#[derive(Default)]
pub(super) struct Nodes {
    pub nodes: Vec<Node>,
    pub runs: Vec<Range<u32>>,
}

/// Trees of fewer halves are left as they are until all nodes are made: a node of their own would have few children.
const WORTH_NODES: usize = 256;

impl Tree {
    /// With room for as many halves as there are, mostly, of so many items.
    pub fn with_room(items: usize) -> Self {
        Self { halves: Vec::with_capacity(items / 2 + 1) }
    }

    /// Adds a cluster of these items.
    pub fn add_cluster(&mut self, bounds: Bounds, items: Range<u32>) {
        let inside = Inside::Cluster(items);
        self.halves.push(Half { bounds, surface: [0.0; WIDTH], inside });
    }

    /// The place of what was added last.
    pub fn last(&self) -> usize {
        self.halves.len() - 1
    }

    /// Joins what is at this place with what was added last.
    pub fn join(&mut self, left: usize) {
        let (bounds, surface) = joined([left, self.last()].map(|place| &self.halves[place]));
        self.halves.push(Half { bounds, surface, inside: Inside::Halves(left as u32) });
    }

    /// Of two that were built apart.
    pub fn of(trees: [Self; 2]) -> Self {
        let (bounds, surface) = joined(trees.each_ref().map(|tree| &tree.halves[tree.last()]));
        let inside = Inside::Trees(Box::new(trees));
        Self { halves: vec![Half { bounds, surface, inside }] }
    }

    /// With nodes in place of its halves, while these are in a near cache: it will have a node of its own, wherever it is put.
    pub fn collapsed(self) -> Self {
        if self.halves.len() < WORTH_NODES {
            return self;
        }
        let bounds = self.whole().half().bounds;
        let nodes = Box::new(self.into_nodes());
        Self { halves: vec![Half { bounds, surface: [0.0; WIDTH], inside: Inside::Nodes(nodes) }] }
    }

    /// Its nodes.
    pub fn into_nodes(mut self) -> Nodes {
        if let [Half { inside: Inside::Nodes(nodes), .. }] = &mut self.halves[..] {
            return std::mem::take(nodes);
        }
        let (nodes, clusters) = self.room();
        let mut all = Nodes { nodes: vec_with_room(nodes), runs: Vec::with_capacity(clusters) };
        all.add(self.whole());
        all
    }

    /// How many nodes it has, mostly, and how many clusters.
    fn room(&self) -> (usize, usize) {
        match &self.halves[..] {
            [Half { inside: Inside::Trees(trees), .. }] => {
                let [left, right] = trees.each_ref().map(Self::room);
                (left.0 + right.0 + 1, left.1 + right.1)
            }
            [Half { inside: Inside::Nodes(all), .. }] => (all.nodes.len(), all.runs.len()),
            halves => {
                let clusters = halves.len().div_ceil(2);
                // A node has five children and more, mostly.
                (clusters / 4 + 1, clusters)
            }
        }
    }

    fn whole(&self) -> Subtree<'_> {
        Subtree(&self.halves)
    }
}

/// The box around two halves, and the least surface of what they are together.
fn joined([left, right]: [&Half; 2]) -> (Bounds, [f32; WIDTH]) {
    let bounds = left.bounds.union(right.bounds);
    let opened = least_sums(&left.surface, &right.surface);
    let as_node = half_area(bounds) + opened[WIDTH - 1];
    (bounds, opened.map(|opened| opened.min(as_node)))
}

/// The least surface of two in 1, 2 … places, of which each takes one or more; in one place it is infinite.
///
/// Rows of sums without a branch, which the compiler puts into vectors.
fn least_sums(left: &[f32; WIDTH], right: &[f32; WIDTH]) -> [f32; WIDTH] {
    let mut shifted = [f32::INFINITY; 2 * WIDTH];
    shifted[WIDTH..].copy_from_slice(right);
    let mut least = [f32::INFINITY; WIDTH];
    for (first, left) in left.iter().enumerate() {
        for (last, least) in least.iter_mut().enumerate() {
            let sum = left + shifted[WIDTH - 1 + last - first];
            *least = if sum < *least { sum } else { *least };
        }
    }
    least
}

/// The last of these halves, and all that is in it, which is before it.
#[derive(Clone, Copy)]
struct Subtree<'a>(&'a [Half]);

impl<'a> Subtree<'a> {
    fn half(self) -> &'a Half {
        &self.0[self.0.len() - 1]
    }

    /// What it is divided in.
    fn halves(self) -> Option<[Self; 2]> {
        match &self.half().inside {
            Inside::Cluster(_) | Inside::Nodes(_) => None,
            Inside::Halves(left) => {
                Some([Self(&self.0[..=*left as usize]), Self(&self.0[..self.0.len() - 1])])
            }
            Inside::Trees(trees) => Some([trees[0].whole(), trees[1].whole()]),
        }
    }

    /// Puts it into places of a node: as a child, or what is inside.
    fn fill(self, places: usize, children: &mut Children<'a>) {
        let surface = &self.half().surface;
        match self.halves() {
            Some(halves) if surface[places - 1] < surface[0] => {
                fill_shared(halves, places, children);
            }
            _ => {
                children.some[children.count] = self;
                children.count += 1;
            }
        }
    }
}

/// Of a node.
struct Children<'a> {
    some: [Subtree<'a>; WIDTH],
    count: usize,
}

fn fill_shared<'a>(halves: [Subtree<'a>; 2], places: usize, children: &mut Children<'a>) {
    let first = share(halves.map(|half| &half.half().surface), places);
    halves[0].fill(first, children);
    halves[1].fill(places - first, children);
}

/// Of so many places, how many the first is to take.
fn share([left, right]: [&[f32; WIDTH]; 2], places: usize) -> usize {
    let (mut best, mut least) = (1, f32::INFINITY);
    for first in 1..places {
        let sum = left[first - 1] + right[places - first - 1];
        if sum < least {
            (best, least) = (first, sum);
        }
    }
    best
}

impl Nodes {
    /// Adds a half; the number of its node.
    fn add(&mut self, half: Subtree) -> u32 {
        if let Inside::Nodes(nodes) = &half.half().inside {
            return self.add_nodes(nodes);
        }
        let number = self.nodes.len();
        self.nodes.push(Node::EMPTY);
        let mut children = Children { some: [half; WIDTH], count: 1 };
        if let Some(halves) = half.halves() {
            children.count = 0;
            fill_shared(halves, WIDTH, &mut children);
        }
        for slot in 0..children.count {
            let child = children.some[slot];
            let held = match &child.half().inside {
                Inside::Cluster(items) => {
                    self.runs.push(items.clone());
                    Child::Cluster(self.runs.len() as u32 - 1)
                }
                _ => Child::Node(self.add(child)),
            };
            self.nodes[number].set(slot, &child.half().bounds, held);
        }
        number as u32
    }

    /// Adds others; the number of their root.
    fn add_nodes(&mut self, others: &Self) -> u32 {
        let [first_node, first_cluster] =
            [self.nodes.len(), self.runs.len()].map(|count| count as u32);
        let moved = others.nodes.iter().map(|node| node.moved(first_node, first_cluster));
        self.nodes.extend(moved);
        self.runs.extend_from_slice(&others.runs);
        first_node
    }
}

fn half_area(bounds: Bounds) -> f32 {
    let Vec3 { x, y, z } = bounds.extent();
    x * y + y * z + z * x
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Adds a tree over clusters in a row, cut where `cuts` say.
    fn add(
        tree: &mut Tree,
        places: &[[u8; 3]],
        first: u32,
        cuts: &mut impl Iterator<Item = usize>,
    ) {
        if let [place] = places {
            let min = Vec3::from(place.map(f32::from));
            return tree.add_cluster(Bounds { min, max: min + 1.0 }, first..first + 1);
        }
        let at = 1 + cuts.next().unwrap() % (places.len() - 1);
        let (left, right) = places.split_at(at);
        add(tree, left, first, cuts);
        let left = tree.last();
        add(tree, right, first + at as u32, cuts);
        tree.join(left);
    }

    /// One that one thread builds.
    fn tree(places: &[[u8; 3]], first: u32, cuts: &mut impl Iterator<Item = usize>) -> Tree {
        let mut tree = Tree::default();
        add(&mut tree, places, first, cuts);
        tree
    }

    /// The same, of halves that are built apart as long as there are more than ten clusters.
    fn apart(places: &[[u8; 3]], first: u32, cuts: &mut impl Iterator<Item = usize>) -> Tree {
        if places.len() <= 10 {
            return tree(places, first, cuts);
        }
        let at = 1 + cuts.next().unwrap() % (places.len() - 1);
        let (left, right) = places.split_at(at);
        Tree::of([apart(left, first, cuts), apart(right, first + at as u32, cuts)])
    }

    /// Looks whether nodes hold so many clusters once; the surfaces of all nodes, of which the root has this one.
    fn assert_holds(count: usize, area: f32, Nodes { nodes, runs }: &Nodes) -> f32 {
        let all: Vec<u32> = (0..count as u32).collect();
        let mut found = (0.0, Vec::new());
        reached(0, area, nodes, &mut found);
        found.1.sort_unstable();
        assert_eq!(found.1, all);
        let mut items: Vec<u32> = runs.iter().cloned().flatten().collect();
        items.sort_unstable();
        assert_eq!(items, all);
        found.0
    }

    /// The surfaces of all nodes that are reached, and the items of clusters.
    fn reached(node: u32, area: f32, nodes: &[Node], found: &mut (f32, Vec<u32>)) {
        found.0 += area;
        let node = &nodes[node as usize];
        for slot in (0..WIDTH).filter(|&slot| node.low[0][slot] <= node.high[0][slot]) {
            let low = Vec3::from([0, 1, 2].map(|axis| node.low[axis][slot]));
            let high = Vec3::from([0, 1, 2].map(|axis| node.high[axis][slot]));
            match node.child(slot) {
                Child::Node(inside) => {
                    reached(inside, half_area(Bounds { min: low, max: high }), nodes, found);
                }
                Child::Cluster(cluster) => found.1.push(cluster),
            }
        }
    }

    proptest! {
        #[test]
        fn nodes_hold_every_cluster_once_and_have_the_surface_that_was_promised(
            places in prop::collection::vec(prop::array::uniform3(0u8..50), 1..120),
            cuts in prop::collection::vec(0usize..1000, 120),
        ) {
            let one = tree(&places, 0, &mut cuts.iter().copied());
            let several = apart(&places, 0, &mut cuts.into_iter());
            for tree in [one, several] {
                let Half { bounds, surface, .. } = *tree.whole().half();
                let area = if places.len() > 1 { half_area(bounds) } else { 0.0 };
                let found = assert_holds(places.len(), area, &tree.into_nodes());
                prop_assert!((found - surface[0]).abs() <= 1e-4 * found);
            }
        }
    }

    #[test]
    fn pieces_that_become_nodes_beforehand_lose_nothing_and_have_their_surface() {
        let places = |count: usize| -> Vec<[u8; 3]> {
            (0..count).map(|n| [n % 7, n % 11, n % 249].map(|place| place as u8)).collect()
        };
        // A large piece, one that is too small for a node of its own, and a single cluster.
        for counts in [[400, 300], [400, 3], [1, 400], [300, 1]] {
            let count = counts.iter().sum();
            let (places, cuts) = (places(count), [3, 100, 8, 1, 20, 41]);
            let (left, right) = places.split_at(counts[0]);
            let mut cuts = cuts.into_iter().cycle();
            let trees = [tree(left, 0, &mut cuts), tree(right, counts[0] as u32, &mut cuts)];
            // Without those of nodes made beforehand, which are 0 above.
            let mut made = 0.0;
            for tree in &trees {
                if tree.halves.len() >= WORTH_NODES {
                    made += tree.whole().half().surface[0];
                }
            }
            let all = Tree::of(trees.map(Tree::collapsed));
            let Half { bounds, surface, .. } = *all.whole().half();
            let nodes = all.into_nodes();
            let found = assert_holds(count, half_area(bounds), &nodes);
            assert!((found - surface[0] - made).abs() <= 1e-4 * found);
            let children = |node: &Node| {
                (0..WIDTH).filter(|&slot| node.low[0][slot] <= node.high[0][slot]).count()
            };
            assert!(nodes.nodes.iter().all(|node| children(node) > 1));
        }
    }

    #[test]
    fn eight_clusters_are_one_node_however_the_tree_leans() {
        for cuts in [vec![0; 8], vec![6, 5, 4, 3, 2, 1, 0, 0], vec![3, 1, 0, 0, 1, 0, 0, 0]] {
            let places: Vec<[u8; 3]> = (0..8).map(|n| [n * 3, n * n, 1]).collect();
            let nodes = tree(&places, 0, &mut cuts.into_iter()).into_nodes().nodes;
            assert_eq!(nodes.len(), 1);
        }
    }

    #[test]
    fn a_small_node_is_made_rather_than_a_large_one_opened_halfway() {
        // Nine clusters, of which two are close together: these are the node inside.
        let mut places: Vec<[u8; 3]> = (0..7).map(|n| [n * 30, 0, 0]).collect();
        places.extend([[240, 200, 200], [242, 200, 200]]);
        let left = tree(&places[..7], 0, &mut std::iter::repeat(0));
        let right = tree(&places[7..], 7, &mut std::iter::repeat(0));
        let tree = Tree::of([left, right]);
        let small = half_area(Bounds { min: Vec3::ZERO, max: Vec3::new(3.0, 1.0, 1.0) });
        let root = tree.whole().half();
        assert_eq!(root.surface[0], half_area(root.bounds) + small);
        assert_eq!(tree.into_nodes().nodes.len(), 2);
    }
}
