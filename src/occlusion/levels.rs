//! How deep a tree is.

use std::ops::Range;

/// Nodes from the root, which is node 0, to the deepest one, both included; `children` gives the numbers of a node's. Not by
/// recursion: trees over triangles that lie in each other like shells are chains of thousands.
pub(super) fn levels(children: impl Fn(u32) -> Range<u32>) -> usize {
    let (mut deepest, mut rest) = (0, vec![(0, 1)]);
    while let Some((node, level)) = rest.pop() {
        deepest = deepest.max(level);
        rest.extend(children(node).map(|child| (child, level + 1)));
    }
    deepest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_deepest_path_counts() {
        assert_eq!(levels(|_| 0..0), 1);
        let tree = [1..4, 0..0, 4..6, 0..0, 6..7, 0..0, 0..0];
        assert_eq!(levels(|node| tree[node as usize].clone()), 4);
        assert_eq!(levels(|node| node + 1..(node + 2).min(100_000)), 100_000);
    }
}
