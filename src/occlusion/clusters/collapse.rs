//! From a tree of halves to nodes of eight children.
//!
//! A node is visited by what meets its box, as often as its surface is large; so halves are put into nodes such that the surfaces of
//! all nodes together are the least. What a half costs at best, if it may take one place in the node above it or several,
//! follows from what its own halves cost (Ylitie, Karras & Laine 2017); 27 sums a half, made when it is. Opening the largest box
//! until a node is full leaves many nodes with few children: bundles visit a tenth more of them.
//!
//! Ylitie, Karras, Laine: Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs. High Performance Graphics 2017.

use std::ops::Range;

use glam::Vec3;

use super::{Child, Node, WIDTH};
use crate::geometry::Bounds;

/// A tree while it is built: two halves, or a cluster.
pub(super) struct Half {
    bounds: Bounds,
    inside: Option<Box<[Half; 2]>>,
    /// What is in it.
    items: Range<u32>,
    /// The least surface of all nodes in it, itself among them, if it takes at most 1, 2 … places.
    surface: [f32; WIDTH],
}

impl Half {
    /// A cluster of these items.
    pub fn cluster(bounds: Bounds, items: Range<u32>) -> Self {
        Self { bounds, inside: None, items, surface: [0.0; WIDTH] }
    }

    pub fn of(inside: [Self; 2]) -> Self {
        let [left, right] = &inside;
        let bounds = left.bounds.union(right.bounds);
        let items = left.items.start..right.items.end;
        let as_node = half_area(bounds) + shared_surface(&inside, share(&inside, WIDTH), WIDTH);
        let mut surface = [as_node; WIDTH];
        for places in 2..=WIDTH {
            let opened = shared_surface(&inside, share(&inside, places), places);
            surface[places - 1] = opened.min(as_node);
        }
        Self { bounds, inside: Some(Box::new(inside)), items, surface }
    }

    /// Puts it into places of a node: as a child, or what is inside.
    fn fill<'a>(&'a self, places: usize, children: &mut Vec<&'a Self>) {
        match &self.inside {
            Some(inside) if self.surface[places - 1] < self.surface[0] => {
                fill_shared(inside, places, children);
            }
            _ => children.push(self),
        }
    }
}

/// Of so many places, how many the first is to take.
fn share(inside: &[Half; 2], places: usize) -> usize {
    let surface = |first| shared_surface(inside, first, places);
    (1..places).min_by(|&a, &b| surface(a).total_cmp(&surface(b))).expect("a place for each")
}

fn shared_surface([left, right]: &[Half; 2], first: usize, places: usize) -> f32 {
    left.surface[first - 1] + right.surface[places - first - 1]
}

fn fill_shared<'a>(inside: &'a [Half; 2], places: usize, children: &mut Vec<&'a Half>) {
    let first = share(inside, places);
    inside[0].fill(first, children);
    inside[1].fill(places - first, children);
}

/// The nodes, the root first, and the items of each cluster in the order of their numbers.
pub(super) fn collapse(tree: &Half) -> (Vec<Node>, Vec<Range<u32>>) {
    let (mut nodes, mut clusters) = (Vec::new(), Vec::new());
    add_node(tree, &mut nodes, &mut clusters);
    nodes.shrink_to_fit();
    (nodes, clusters)
}

fn add_node(half: &Half, nodes: &mut Vec<Node>, clusters: &mut Vec<Range<u32>>) -> u32 {
    let number = nodes.len();
    nodes.push(Node::EMPTY);
    let mut children = Vec::with_capacity(WIDTH);
    match &half.inside {
        Some(inside) => fill_shared(inside, WIDTH, &mut children),
        None => children.push(half),
    }
    for (slot, half) in children.into_iter().enumerate() {
        let child = match half.inside {
            Some(_) => Child::Node(add_node(half, nodes, clusters)),
            None => {
                clusters.push(half.items.clone());
                Child::Cluster(clusters.len() as u32 - 1)
            }
        };
        nodes[number].set(slot, &half.bounds, child);
    }
    number as u32
}

fn half_area(bounds: Bounds) -> f32 {
    let Vec3 { x, y, z } = bounds.extent();
    x * y + y * z + z * x
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn cluster(number: u32, place: [u8; 3]) -> Half {
        let min = Vec3::from(place.map(f32::from));
        Half::cluster(Bounds { min, max: min + 1.0 }, number..number + 1)
    }

    /// A tree over clusters in a row, cut where `cuts` say.
    fn tree(places: &[[u8; 3]], first: u32, cuts: &mut impl Iterator<Item = usize>) -> Half {
        if let [place] = places {
            return cluster(first, *place);
        }
        let at = 1 + cuts.next().unwrap() % (places.len() - 1);
        let (left, right) = places.split_at(at);
        Half::of([tree(left, first, cuts), tree(right, first + at as u32, cuts)])
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
            let tree = tree(&places, 0, &mut cuts.into_iter());
            let (nodes, clusters) = collapse(&tree);
            let mut found = (0.0, Vec::new());
            let area = if tree.inside.is_some() { half_area(tree.bounds) } else { 0.0 };
            reached(0, area, &nodes, &mut found);
            found.1.sort_unstable();
            prop_assert_eq!(found.1, (0..places.len() as u32).collect::<Vec<_>>());
            let mut items: Vec<u32> = clusters.into_iter().flatten().collect();
            items.sort_unstable();
            prop_assert_eq!(items, (0..places.len() as u32).collect::<Vec<_>>());
            prop_assert!((found.0 - tree.surface[0]).abs() <= 1e-4 * found.0);
        }
    }

    #[test]
    fn eight_clusters_are_one_node_however_the_tree_leans() {
        for cuts in [vec![0; 8], vec![6, 5, 4, 3, 2, 1, 0, 0], vec![3, 1, 0, 0, 1, 0, 0, 0]] {
            let places: Vec<[u8; 3]> = (0..8).map(|n| [n * 3, n * n, 1]).collect();
            let (nodes, _) = collapse(&tree(&places, 0, &mut cuts.into_iter()));
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
        let tree = Half::of([left, right]);
        let small = half_area(Bounds { min: Vec3::ZERO, max: Vec3::new(3.0, 1.0, 1.0) });
        assert_eq!(tree.surface[0], half_area(tree.bounds) + small);
        assert_eq!(collapse(&tree).0.len(), 2);
    }
}
