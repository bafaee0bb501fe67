//! Numbers as exact sums of f64: Shewchuk's floating-point expansions.
//!
//! An expansion is a sum of f64 terms, in order of increasing magnitude, whose bits do not overlap, so that
//! the last one has the sign of the whole. Zero terms are dropped as they arise. Every operation here is
//! error-free as long as nothing over- or underflows: sums, differences and products of a few f32 lie between
//! 2⁻⁵⁹⁶ (four factors of at least 2⁻¹⁴⁹) and 2⁵²⁰, so on f32 input that is always so.
//!
//! The exact product is Dekker's rather than a fused multiply-add: without the CPU feature the latter is a
//! library call. Both give the same two terms.
//!
//! Source: J. R. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
//! Predicates", Discrete & Computational Geometry 18 (1997): TWO-SUM, TWO-PRODUCT, FAST-EXPANSION-SUM and
//! SCALE-EXPANSION, which keep expansions strongly non-overlapping when rounding is to nearest even.

/// A number as an exact sum of at most `CAPACITY` terms.
#[derive(Clone, Copy, Debug)]
pub struct Expansion<const CAPACITY: usize> {
    terms: [f64; CAPACITY],
    len: usize,
}

impl<const CAPACITY: usize> Expansion<CAPACITY> {
    const ZERO: Self = Self { terms: [0.0; CAPACITY], len: 0 };

    /// The terms, in order of increasing magnitude, none zero.
    #[must_use]
    pub fn terms(&self) -> &[f64] {
        &self.terms[..self.len]
    }

    /// Whether the number is below, at or above zero: −1, 0 or 1.
    #[must_use]
    pub fn sign(&self) -> i8 {
        self.terms().last().map_or(0, |&largest| if largest > 0.0 { 1 } else { -1 })
    }

    /// The number with its sign changed.
    #[must_use]
    pub fn negated(mut self) -> Self {
        self.terms[..self.len].iter_mut().for_each(|term| *term = -*term);
        self
    }

    /// The exact sum.
    #[must_use]
    pub fn plus<const OTHER: usize, const SUM: usize>(
        &self,
        other: &Expansion<OTHER>,
    ) -> Expansion<SUM> {
        const { assert!(SUM >= CAPACITY + OTHER) }
        let (mut left, mut right) =
            (self.terms().iter().peekable(), other.terms().iter().peekable());
        let mut by_magnitude = std::iter::from_fn(|| match (left.peek(), right.peek()) {
            (Some(a), Some(b)) if a.abs() < b.abs() => left.next(),
            (_, Some(_)) => right.next(),
            _ => left.next(),
        });
        let mut sum = Expansion::ZERO;
        let Some(&(mut total)) = by_magnitude.next() else { return sum };
        for &term in by_magnitude {
            let error;
            (total, error) = two_sum(total, term);
            sum.push(error);
        }
        sum.push(total);
        sum
    }

    /// The exact product with one f64.
    #[must_use]
    pub fn times<const PRODUCT: usize>(&self, factor: f64) -> Expansion<PRODUCT> {
        const { assert!(PRODUCT >= 2 * CAPACITY) }
        let mut product = Expansion::ZERO;
        let Some((&least, rest)) = self.terms().split_first().filter(|_| factor != 0.0) else {
            return product;
        };
        let (mut total, error) = two_product(least, factor);
        product.push(error);
        for &term in rest {
            let (high, low) = two_product(term, factor);
            let error;
            (total, error) = two_sum(total, low);
            product.push(error);
            let error;
            (total, error) = two_sum(high, total);
            product.push(error);
        }
        product.push(total);
        product
    }

    /// The exact product with a difference of two f32.
    #[must_use]
    pub fn times_difference<const HALF: usize, const PRODUCT: usize>(
        &self,
        factor: &Expansion<2>,
    ) -> Expansion<PRODUCT> {
        const { assert!(HALF >= 2 * CAPACITY && PRODUCT >= 2 * HALF) }
        let [low, high] = match *factor.terms() {
            [] => [0.0, 0.0],
            [high] => [0.0, high],
            [low, high, ..] => [low, high],
        };
        self.times::<HALF>(low).plus(&self.times::<HALF>(high))
    }

    /// Adds the next larger term, unless it is zero.
    fn push(&mut self, term: f64) {
        if term != 0.0 {
            self.terms[self.len] = term;
            self.len += 1;
        }
    }
}

/// `a − b`, exactly.
#[must_use]
pub fn difference(a: f32, b: f32) -> Expansion<2> {
    let (total, error) = two_sum(f64::from(a), -f64::from(b));
    let mut difference = Expansion::ZERO;
    difference.push(error);
    difference.push(total);
    difference
}

/// The rounded sum and its rounding error (Knuth).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let from_b = sum - a;
    let from_a = sum - from_b;
    (sum, (a - from_a) + (b - from_b))
}

/// The rounded product and its rounding error (Dekker, Veltkamp).
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let ((a_high, a_low), (b_high, b_low)) = (halves(a), halves(b));
    let missing = product - a_high * b_high - a_low * b_high - a_high * b_low;
    (product, a_low * b_low - missing)
}

/// Two numbers of at most 26 bits whose sum is `a`, so that their products with other halves are exact.
fn halves(a: f64) -> (f64, f64) {
    /// 2²⁷ + 1: half of f64's 53 bits, rounded up.
    const SPLITTER: f64 = 134_217_729.0;
    let scaled = SPLITTER * a;
    let high = scaled - (scaled - a);
    (high, a - high)
}

#[cfg(test)]
mod tests {
    use num_bigint::BigInt;
    use proptest::prelude::*;

    use super::*;

    /// The number as a multiple of 2⁻¹⁰⁷⁴.
    fn integer(terms: &[f64]) -> BigInt {
        terms
            .iter()
            .map(|term| {
                let (exponent, fraction) =
                    ((term.to_bits() >> 52) & 0x7ff, term.to_bits() & ((1 << 52) - 1));
                let significand = if exponent == 0 { fraction } else { fraction | (1 << 52) };
                let magnitude = BigInt::from(significand) << exponent.saturating_sub(1);
                if *term < 0.0 { -magnitude } else { magnitude }
            })
            .sum()
    }

    fn one() -> BigInt {
        BigInt::from(1) << 1074
    }

    /// Any finite f32 bits, and often numbers of like size, whose differences cancel.
    fn coordinate() -> impl Strategy<Value = f32> {
        prop_oneof![
            any::<u32>().prop_map(f32::from_bits).prop_filter("finite", |x| x.is_finite()),
            (-4.0_f32..4.0),
            (-100_i32..100).prop_map(|x| x as f32),
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4096))]

        #[test]
        fn sums_and_products_are_exact(x in prop::array::uniform8(coordinate())) {
            let (p, q) = (difference(x[0], x[1]), difference(x[2], x[3]));
            let (r, s) = (difference(x[4], x[5]), f64::from(x[6]));
            let pq: Expansion<8> = p.times_difference::<4, 8>(&q);
            let pr: Expansion<8> = p.times_difference::<4, 8>(&r);
            let sum: Expansion<16> = pq.plus(&pr.negated());
            let scaled: Expansion<32> = sum.times(s);
            let twice: Expansion<64> = scaled.times(f64::from(x[7]));
            let [p, q, r] = [p, q, r].map(|d| integer(d.terms()));
            prop_assert_eq!(&p, &(integer(&[f64::from(x[0])]) - integer(&[f64::from(x[1])])));
            prop_assert_eq!(integer(pq.terms()) * one(), &p * &q);
            prop_assert_eq!(integer(sum.terms()) * one(), &p * &q - &p * &r);
            let value = integer(&[s]) * integer(&[f64::from(x[7])]) * (&p * &q - &p * &r);
            prop_assert_eq!(integer(twice.terms()) * one() * one() * one(), value.clone());
            let sign = twice.sign();
            prop_assert_eq!(sign > 0, value > BigInt::ZERO);
            prop_assert_eq!(sign < 0, value < BigInt::ZERO);
        }
    }
}
