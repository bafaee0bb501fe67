//! What verdicts are prepared from, and share.

use std::sync::{Arc, OnceLock};

use super::light_buffer::LightBuffer;
use super::{Budget, VerdictSet};
use crate::occlusion::Clusters;
use crate::scene::Scene;

/// Bytes that clusters and their tree may take: to a triangle (about 56, and 61 where things are small and apart, if rays come to
/// all), and besides.
const CLUSTER_BYTES: [usize; 2] = [62, 4096];

/// Bytes that clusters of so many triangles may take.
fn most_bytes(triangles: usize) -> usize {
    let [a_triangle, besides] = CLUSTER_BYTES;
    a_triangle * triangles + besides
}

/// Clusters, which several verdicts may use.
#[derive(Clone)]
pub(super) struct Lent {
    pub clusters: Arc<Clusters>,
    /// Whether it is here that they are counted.
    counts: bool,
}

impl Lent {
    /// Bytes of what is made by now.
    pub fn memory(&self) -> usize {
        if self.counts { self.clusters.memory() } else { 0 }
    }

    /// Seconds that it took to make what was asked for.
    pub fn lazy_seconds(&self) -> f64 {
        if self.counts { self.clusters.lazy_seconds() } else { 0.0 }
    }
}

/// The scene, the memory that is left, and what several verdicts use.
pub(super) struct Stock<'a> {
    pub scene: &'a Scene,
    pub budget: Arc<Budget>,
    /// All verdicts that are prepared, in their order.
    pub verdicts: VerdictSet,
    shared: Arc<Shared>,
}

/// What is made once, by whoever asks first.
#[derive(Default)]
struct Shared {
    clusters: OnceLock<Option<Arc<Clusters>>>,
    glass: OnceLock<Option<Arc<Clusters>>>,
    light_buffer: OnceLock<Arc<LightBuffer>>,
}

impl<'a> Stock<'a> {
    pub fn new(scene: &'a Scene, budget: Arc<Budget>, verdicts: VerdictSet) -> Self {
        Self { scene, budget, verdicts, shared: Arc::default() }
    }

    /// The same stock for other verdicts.
    pub fn for_verdicts(&self, verdicts: VerdictSet) -> Self {
        Self { budget: self.budget.clone(), verdicts, shared: self.shared.clone(), ..*self }
    }

    /// The opaque triangles' clusters, if the memory suffices; whoever asks first counts them.
    pub fn clusters(&self) -> Option<Lent> {
        let triangles = &self.scene.triangles;
        let count = triangles.opaque_count() as usize;
        self.once(&self.shared.clusters, count, |bytes| Clusters::of_opaque(triangles, bytes))
    }

    /// Clusters of the transparent triangles, if there are any and the memory suffices; whoever asks first counts them.
    pub fn glass(&self) -> Option<Lent> {
        let triangles = &self.scene.triangles;
        let count = triangles.len() - triangles.opaque_count() as usize;
        if count == 0 {
            return None;
        }
        let make = |bytes| Clusters::of_transparent(triangles, bytes);
        self.once(&self.shared.glass, count, make)
    }

    /// Clusters of so many triangles, which are made by whoever asks first, within so many bytes.
    fn once(
        &self,
        shared: &OnceLock<Option<Arc<Clusters>>>,
        count: usize,
        make: impl FnOnce(usize) -> Clusters,
    ) -> Option<Lent> {
        let mut counts = false;
        // `make` may take up other work while it waits for threads; none of that comes here, as one at a time prepares from a stock (see `Auto`).
        let clusters = shared.get_or_init(|| {
            counts = true;
            let bytes = most_bytes(count);
            self.budget.take(bytes).then(|| Arc::new(make(bytes)))
        });
        clusters.clone().map(|clusters| Lent { clusters, counts })
    }

    /// What the user should know where there are no clusters.
    pub fn without_clusters(&self) -> String {
        let bytes = most_bytes(self.scene.triangles.opaque_count() as usize);
        let advice = self.budget.advice(bytes as u64);
        format!(
            "steps aside: the memory limit leaves too little for the triangles' clusters; {advice}"
        )
    }

    /// The one light buffer of all sets of verdicts that have it.
    pub fn light_buffer(&self) -> Arc<LightBuffer> {
        self.shared.light_buffer.get_or_init(|| Arc::new(LightBuffer::new(self))).clone()
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::geometry::Triangles;

    /// Heaps of nine triangles, one more than a cluster has, and far apart: they take more than other triangles.
    fn heaps() -> Scene {
        let heap = |number: u16| {
            let steps = Vec3::new(0.618_034, 0.754_877_7, 0.819_172_5);
            let place = 1e5 * (steps * f32::from(number)).fract();
            [[place, place + Vec3::X, place + Vec3::Y]; 9]
        };
        let triangles = Triangles::new((0..1000).flat_map(heap), []);
        Scene { triangles: triangles.into(), ..crate::scene::load("jittered-dense").unwrap() }
    }

    #[test]
    fn clusters_keep_within_the_memory_that_they_asked_for_however_many_they_are() {
        let scene = heaps();
        let most = most_bytes(scene.triangles.len());
        let free = Clusters::new(&scene.triangles);
        free.make_all();
        assert!(free.memory() > most);
        let stock = |bytes: usize| {
            Stock::new(&scene, Arc::new(Budget::new(bytes as u64)), VerdictSet::NONE)
        };
        assert!(stock(most - 1).clusters().is_none());
        let stock = stock(most);
        let lent = stock.clusters().unwrap();
        lent.clusters.make_all();
        // What room there is, is used.
        assert!((most - most / 50..=most).contains(&lent.memory()), "{} of {most}", lent.memory());
        assert_eq!(stock.budget.left(), 0);
    }

    #[test]
    fn sets_of_verdicts_that_share_a_stock_pay_for_their_clusters_once() {
        let [opaque, glass] = [0.0, 50.0].map(|z| {
            let strip = |number: u16| {
                [Vec3::ZERO, Vec3::X, Vec3::Y]
                    .map(|corner| corner + Vec3::new(f32::from(number), 0.0, z))
            };
            (0..100).map(strip).collect::<Vec<_>>()
        });
        let triangles = Triangles::new(opaque, glass).into();
        let scene = Scene { triangles, ..crate::scene::load("jittered-dense").unwrap() };
        let stock = Stock::new(&scene, Arc::new(Budget::new(1 << 20)), VerdictSet::NONE);
        let other = stock.for_verdicts(VerdictSet::NONE);
        for lend in [Stock::clusters, Stock::glass] {
            let before = stock.budget.left();
            let first = lend(&stock).unwrap();
            let left = stock.budget.left();
            assert_eq!(left, before - most_bytes(100) as u64);
            assert!((1..=most_bytes(100)).contains(&first.memory()));
            let second = lend(&other).unwrap();
            assert!(Arc::ptr_eq(&first.clusters, &second.clusters) && second.memory() == 0);
            assert_eq!(stock.budget.left(), left);
        }
    }
}
