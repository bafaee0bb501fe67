//! The Pareto front: what is not beaten.

/// Places of the points that no other beats, with ascending gain. A point is beaten by one that gains no
/// less and costs no more, and is better in one of the two; so points that are alike stand or fall together.
/// What is not a number is on no front.
#[must_use]
pub fn front(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len())
        .filter(|&place| !points[place].0.is_nan() && !points[place].1.is_nan())
        .collect();
    // The greatest gain first, and of equal ones the cheapest.
    order.sort_by(|&a, &b| {
        points[b].0.total_cmp(&points[a].0).then(points[a].1.total_cmp(&points[b].1))
    });
    let mut front: Vec<usize> = Vec::new();
    for place in order {
        let is_on_front = front
            .last()
            .is_none_or(|&best| points[place].1 < points[best].1 || points[place] == points[best]);
        if is_on_front {
            front.push(place);
        }
    }
    front.reverse();
    front
}

#[cfg(test)]
mod tests {
    use super::front;

    #[test]
    fn nothing_on_the_front_is_beaten_and_everything_else_is() {
        // A few thousand small integers make many equal values.
        let mut state = 1u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 24 & 15)
        };
        for _ in 0..100 {
            let points: Vec<(f64, f64)> = (0..40).map(|_| (next(), next())).collect();
            let beaten = |p: &(f64, f64)| {
                points.iter().any(|q| q.0 >= p.0 && q.1 <= p.1 && (q.0 > p.0 || q.1 < p.1))
            };
            let found = front(&points);
            for (place, point) in points.iter().enumerate() {
                assert_eq!(found.contains(&place), !beaten(point), "{point:?} of {points:?}");
            }
            assert!(found.is_sorted_by(|&a, &b| points[a].0 <= points[b].0));
        }
    }

    #[test]
    fn what_is_not_a_number_is_on_no_front() {
        assert_eq!(front(&[(f64::NAN, 0.0), (1.0, f64::NAN), (0.5, 2.0)]), [2]);
        assert_eq!(front(&[]), [0; 0]);
    }
}
