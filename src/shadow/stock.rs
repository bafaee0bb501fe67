//! What verdicts are prepared from, and share.

use std::sync::{Arc, OnceLock};

use super::light_buffer::LightBuffer;
use super::{Budget, VerdictSet};
use crate::occlusion::Clusters;
use crate::scene::Scene;

/// Bytes of clusters and their tree: to a triangle (they turn out to take about 51, and 56 where things are small and apart), and
/// besides.
const CLUSTER_BYTES: [usize; 2] = [60, 1024];

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

    /// The triangles' clusters, if the memory suffices; and their bytes, for whoever asks first.
    pub fn clusters(&self) -> (Option<Arc<Clusters>>, usize) {
        let mut bytes = 0;
        let clusters = self.shared.clusters.get_or_init(|| {
            let opaque = self.scene.triangles.opaque_count() as usize;
            let clusters = self.within_budget(opaque, || Clusters::new(&self.scene.triangles));
            bytes = clusters.as_ref().map_or(0, |clusters| clusters.memory());
            clusters
        });
        (clusters.clone(), bytes)
    }

    /// Clusters of so many triangles, if the memory suffices.
    fn within_budget(
        &self,
        count: usize,
        make: impl FnOnce() -> Clusters,
    ) -> Option<Arc<Clusters>> {
        let [a_triangle, besides] = CLUSTER_BYTES;
        let estimate = a_triangle * count + besides;
        self.budget.take(estimate).then(|| {
            let clusters = make();
            self.budget.give_back(estimate.saturating_sub(clusters.memory()));
            Arc::new(clusters)
        })
    }

    /// Clusters of the transparent triangles, if there are any and the memory suffices; and their bytes.
    pub fn glass(&self) -> Option<(Arc<Clusters>, usize)> {
        let triangles = &self.scene.triangles;
        let count = triangles.len() - triangles.opaque_count() as usize;
        let make = || Clusters::of_transparent(triangles);
        let clusters = (count > 0).then(|| self.within_budget(count, make)).flatten()?;
        let bytes = clusters.memory();
        Some((clusters, bytes))
    }

    /// The one light buffer of all sets of verdicts that have it.
    pub fn light_buffer(&self) -> Arc<LightBuffer> {
        self.shared.light_buffer.get_or_init(|| Arc::new(LightBuffer::new(self))).clone()
    }
}
