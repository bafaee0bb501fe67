//! What verdicts are prepared from, and share.

use std::sync::{Arc, OnceLock};

use super::{Budget, VerdictSet};
use crate::occlusion::Clusters;
use crate::scene::Scene;

/// Bytes of clusters and their tree to a triangle, somewhat more than they turn out to take.
const CLUSTER_BYTES: usize = 48;

/// The scene, the memory that is left, and what several verdicts use.
pub(super) struct Stock<'a> {
    pub scene: &'a Scene,
    pub budget: Arc<Budget>,
    /// All verdicts that are prepared, in their order.
    pub verdicts: VerdictSet,
    clusters: OnceLock<Option<Arc<Clusters>>>,
}

impl<'a> Stock<'a> {
    pub fn new(scene: &'a Scene, budget: Arc<Budget>, verdicts: VerdictSet) -> Self {
        Self { scene, budget, verdicts, clusters: OnceLock::new() }
    }

    /// The triangles' clusters, if the memory suffices; and their bytes, for whoever asks first.
    pub fn clusters(&self) -> (Option<Arc<Clusters>>, usize) {
        let mut bytes = 0;
        let clusters = self.clusters.get_or_init(|| {
            let estimate = CLUSTER_BYTES * self.scene.triangles.len();
            let clusters = self.budget.take(estimate).then(|| Clusters::new(&self.scene.triangles));
            bytes = clusters.as_ref().map_or(0, Clusters::memory);
            clusters.map(Arc::new)
        });
        (clusters.clone(), bytes)
    }
}
