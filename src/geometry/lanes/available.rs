//! Arithmetic that this CPU has.

use std::marker::PhantomData;

#[cfg(target_arch = "x86_64")]
use super::avx::Avx;
#[cfg(target_arch = "x86_64")]
use super::sse::Sse;
use super::{Arithmetic, InLanes, Lanes, LanesJob};

/// An arithmetic that this CPU was found to have. There is no other way to one, so any job may run in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Available(Arithmetic);

impl Available {
    /// The arithmetic, if this CPU has it.
    pub fn find(arithmetic: Arithmetic) -> Option<Self> {
        arithmetic.is_available().then_some(Self(arithmetic))
    }

    /// Those that this CPU has, the oldest first.
    pub fn all() -> impl Iterator<Item = Self> {
        Arithmetic::ALL.into_iter().filter_map(Self::find)
    }

    /// The newest that this CPU has.
    pub fn newest() -> Self {
        Self::all().last().expect("SSE arithmetic is everywhere")
    }

    /// The newest for vectors of short integers: AVX2, if there is one. AVX-512 is compiled for here without BW, so such vectors have 256
    /// bits there, and code that also may use 512 moves halves to and fro.
    pub fn newest_for_short_integers() -> Self {
        Self::find(Arithmetic::Avx2).unwrap_or_else(Self::newest)
    }

    /// Which one it is.
    pub fn arithmetic(self) -> Arithmetic {
        self.0
    }

    /// Runs a job compiled for the instruction set.
    #[inline]
    pub fn run<J: LanesJob>(self, job: J) -> J::Answer {
        #[cfg(target_arch = "x86_64")]
        match self.0 {
            Arithmetic::Sse => Sse::run(InLanes::<_, Sse>(job, PhantomData)),
            Arithmetic::Avx2 => Avx::<false>::run(InLanes::<_, Avx<false>>(job, PhantomData)),
            Arithmetic::Avx512 => Avx::<true>::run(InLanes::<_, Avx<true>>(job, PhantomData)),
        }
        #[cfg(not(target_arch = "x86_64"))]
        job.run::<super::Scalar<false, false>>()
    }
}
