//! What a render counted; the same for every number of threads, unless methods are chosen by the clock or the memory
//! does not hold all of them.

use serde::Serialize;

use crate::occlusion::Tally;
use crate::shadow::ShadowTally;

/// Rays by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct RayCounts {
    /// From the eye.
    pub primary: u64,
    /// From mirrors.
    pub reflected: u64,
    /// Into or out of transparent bodies.
    pub refracted: u64,
    /// To lights.
    pub shadow: u64,
}

impl RayCounts {
    /// All of them: what the paper's Table 2 counts.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.primary + self.reflected + self.refracted + self.shadow
    }
}

/// All counts of a render.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Statistics {
    /// Rays by kind.
    pub rays: RayCounts,
    /// How shadow queries were answered.
    pub shadows: ShadowTally,
    /// What the backend did for rays that see.
    pub nearest: Tally,
    /// What the backend did to find transparent occluders.
    pub transparent: Tally,
}

impl std::ops::AddAssign for Statistics {
    fn add_assign(&mut self, other: Self) {
        self.rays.primary += other.rays.primary;
        self.rays.reflected += other.rays.reflected;
        self.rays.refracted += other.rays.refracted;
        self.rays.shadow += other.rays.shadow;
        self.shadows += other.shadows;
        self.nearest += other.nearest;
        self.transparent += other.transparent;
    }
}
