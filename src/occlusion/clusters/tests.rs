//! Of the whole tree: what goes in is found again.

use glam::Vec3;

use super::*;
use crate::geometry::{Bounds, Triangle, is_finite};

/// Triangles that are small beside the unit cube in which they are spread.
fn spread(count: usize) -> Vec<Triangle> {
    let steps = Vec3::new(0.618_034, 0.754_877_7, 0.819_172_5);
    let triangle = |number| {
        let corner = (steps * number as f32).fract();
        [corner, corner + 0.01 * Vec3::X, corner + 0.01 * Vec3::Y]
    };
    (0..count).map(triangle).collect()
}

/// Adds what is found below a node, once for each time, having looked whether boxes are around it.
fn find_below(clusters: &Clusters, node: u32, within: Bounds, found: &mut Vec<TriangleId>) {
    let node = &clusters.nodes()[node as usize];
    for slot in (0..WIDTH).filter(|&slot| node.low[0][slot] <= node.high[0][slot]) {
        let [min, max] =
            [node.low, node.high].map(|corner| Vec3::from(corner.map(|values| values[slot])));
        assert!(within.contains(min) && within.contains(max));
        match node.child(slot) {
            Child::Node(inside) => find_below(clusters, inside, Bounds { min, max }, found),
            Child::Cluster(cluster) => {
                let cluster = &clusters.all()[cluster as usize];
                for lane in (0..WIDTH).filter(|&lane| !cluster.repeats(lane)) {
                    for corner in 0..3 {
                        let corner = cluster.corner(corner).map(|values| values[lane]);
                        assert!(Bounds { min, max }.contains(corner.into()));
                    }
                    found.push(cluster.ids()[lane]);
                }
            }
        }
    }
}

/// Whether the tree holds all triangles that are finite once, and no others.
fn assert_holds_finite_ones(triangles: &[Triangle]) {
    let finite: Vec<TriangleId> = (0..)
        .zip(triangles)
        .filter(|(_, triangle)| is_finite(triangle))
        .map(|(id, _)| id)
        .collect();
    let all = |triangles: &[Triangle]| triangles.to_vec();
    for clusters in [
        Clusters::new(&Triangles::new(all(triangles), [])),
        Clusters::of_transparent(&Triangles::new([], all(triangles))),
    ] {
        let mut found = Vec::new();
        if !clusters.nodes().is_empty() {
            let everywhere = Bounds { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY };
            find_below(&clusters, 0, everywhere, &mut found);
        }
        found.sort_unstable();
        assert_eq!(found, finite);
        let ids = clusters.all().iter().flat_map(Cluster::ids);
        assert!(ids.into_iter().all(|id| is_finite(&triangles[*id as usize])));
    }
}

/// As many as one cluster, few, some that bins divide, those that cells do, and what one thread and several build.
const COUNTS: [usize; 10] = [7, 8, 9, 128, 129, 400, 512, 8191, 8192, 20_000];

#[test]
fn scenes_as_wide_as_numbers_go_are_built_and_nothing_is_lost() {
    let wide = |axes: &[usize], width: f32, count: usize| {
        let mut triangles = spread(count);
        for &axis in axes {
            triangles[1][0][axis] = -width;
            triangles[count - 2][2][axis] = width;
        }
        triangles
    };
    for count in COUNTS {
        for axes in [&[0][..], &[1], &[2], &[0, 1, 2]] {
            for width in [1e19, 1e38, f32::MAX] {
                assert_holds_finite_ones(&wide(axes, width, count));
            }
        }
    }
}

#[test]
fn scenes_whose_sums_are_infinite_are_built_and_nothing_is_lost() {
    for count in COUNTS {
        for [low, high] in [[-3e38, 3e38], [0.0, 3e38], [2e38, 3e38], [-3e38, -2.9e38]] {
            let place = |corner: Vec3| {
                let share = corner.min(Vec3::ONE);
                low * (1.0 - share) + high * share
            };
            let triangles: Vec<Triangle> =
                spread(count).into_iter().map(|triangle| triangle.map(place)).collect();
            assert_holds_finite_ones(&triangles);
        }
    }
}

#[test]
fn the_tree_does_not_depend_on_how_many_threads_build_it() {
    let triangles = Triangles::new(spread(50_000), []);
    let built = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let clusters = pool.install(|| Clusters::new(&triangles));
        let ids: Vec<_> = clusters.all().iter().map(Cluster::ids).copied().collect();
        let boxes: Vec<_> = clusters.nodes().iter().map(|node| (node.low, node.high)).collect();
        (ids, boxes)
    };
    assert_eq!(built(1), built(4));
}

#[test]
fn many_triangles_in_one_place_or_a_row_or_a_plane_are_built() {
    for shape in [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z] {
        let triangles =
            spread(5000).into_iter().map(|triangle| triangle.map(|corner| corner * shape));
        assert_holds_finite_ones(&triangles.collect::<Vec<_>>());
    }
    let flat =
        spread(150_000).into_iter().map(|triangle| triangle.map(|corner| corner.with_z(0.5)));
    assert_holds_finite_ones(&flat.collect::<Vec<_>>());
}

#[test]
fn triangles_that_are_not_finite_are_in_no_cluster_and_take_none_with_them() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for count in COUNTS {
            for axis in 0..3 {
                let mut triangles = spread(count);
                for number in [1, count / 2, count - 1] {
                    triangles[number][number % 3][axis] = bad;
                }
                assert_holds_finite_ones(&triangles);
            }
        }
    }
    assert_holds_finite_ones(&[[Vec3::NAN; 3]; 20]);
}
