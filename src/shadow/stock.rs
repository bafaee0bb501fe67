//! What verdicts are prepared from, and share.

use std::sync::{Arc, OnceLock};

use super::light_buffer::LightBuffer;
use super::{Budget, VerdictSet};
use crate::occlusion::Clusters;
use crate::scene::Scene;

/// Bytes of clusters and their tree before they are built: to a triangle (they turn out to take about 51, and 56 where things are small
/// and apart; to almost 90 where these are heaps of one triangle more than a cluster has), and besides.
const CLUSTER_BYTES: [usize; 2] = [60, 1024];

/// Bytes that clusters of so many triangles are expected to take.
fn estimate(triangles: usize) -> usize {
    let [a_triangle, besides] = CLUSTER_BYTES;
    a_triangle * triangles + besides
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

    /// The opaque triangles' clusters, if the memory suffices; and their bytes, for whoever asks first.
    pub fn clusters(&self) -> (Option<Arc<Clusters>>, usize) {
        let triangles = &self.scene.triangles;
        let count = triangles.opaque_count() as usize;
        self.once(&self.shared.clusters, count, || Clusters::new(triangles))
    }

    /// Clusters of the transparent triangles, if there are any and the memory suffices; and their bytes, for whoever asks first.
    pub fn glass(&self) -> Option<(Arc<Clusters>, usize)> {
        let triangles = &self.scene.triangles;
        let count = triangles.len() - triangles.opaque_count() as usize;
        if count == 0 {
            return None;
        }
        let make = || Clusters::of_transparent(triangles);
        let (clusters, bytes) = self.once(&self.shared.glass, count, make);
        Some((clusters?, bytes))
    }

    /// Clusters of so many triangles, which are made by whoever asks first; only to them they cost bytes.
    fn once(
        &self,
        shared: &OnceLock<Option<Arc<Clusters>>>,
        count: usize,
        make: impl FnOnce() -> Clusters,
    ) -> (Option<Arc<Clusters>>, usize) {
        let mut bytes = 0;
        // `make` may take up other work while it waits for threads; none of that comes here, as one at a time prepares from a stock (see `Auto`).
        let clusters = shared.get_or_init(|| {
            let clusters = self.within_budget(count, make);
            bytes = clusters.as_ref().map_or(0, |clusters| clusters.memory());
            clusters
        });
        (clusters.clone(), bytes)
    }

    /// What the user should know where there are no clusters.
    pub fn without_clusters(&self) -> String {
        let bytes = estimate(self.scene.triangles.opaque_count() as usize);
        let advice = self.budget.advice(bytes as u64);
        format!(
            "steps aside: the memory limit leaves too little for the triangles' clusters; {advice}"
        )
    }

    /// Clusters of so many triangles, if the memory suffices.
    fn within_budget(
        &self,
        count: usize,
        make: impl FnOnce() -> Clusters,
    ) -> Option<Arc<Clusters>> {
        let estimate = estimate(count);
        if !self.budget.take(estimate) {
            return None;
        }
        let clusters = make();
        let bytes = clusters.memory();
        let suffices = self.budget.take(bytes.saturating_sub(estimate));
        self.budget.give_back(if suffices { estimate.saturating_sub(bytes) } else { estimate });
        suffices.then(|| Arc::new(clusters))
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
    fn clusters_that_turn_out_larger_than_estimated_are_paid_for_or_dropped() {
        let scene = heaps();
        let estimate = estimate(scene.triangles.len());
        let truth = Clusters::new(&scene.triangles).memory();
        assert!(truth > estimate);
        let stock =
            |bytes| Stock::new(&scene, Arc::new(Budget::new(bytes as u64)), VerdictSet::NONE);
        for bytes in [estimate, truth - 1] {
            let stock = stock(bytes);
            assert!(matches!(stock.clusters(), (None, 0)), "{bytes} of {truth} bytes");
            assert_eq!(stock.budget.left(), bytes as u64);
        }
        let stock = stock(truth + 5);
        let (clusters, bytes) = stock.clusters();
        assert!(clusters.is_some() && bytes == truth);
        assert_eq!(stock.budget.left(), 5);
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
        let (clusters, bytes) = stock.clusters();
        let (glass, glass_bytes) = stock.glass().unwrap();
        let left = stock.budget.left();
        assert!(bytes > 0 && glass_bytes > 0);
        assert_eq!(left, (1 << 20) - (bytes + glass_bytes) as u64);
        let (same_clusters, nothing) = other.clusters();
        assert!(Arc::ptr_eq(&clusters.unwrap(), &same_clusters.unwrap()) && nothing == 0);
        let (same_glass, nothing) = other.glass().unwrap();
        assert!(Arc::ptr_eq(&glass, &same_glass) && nothing == 0);
        assert_eq!(stock.budget.left(), left);
    }
}
