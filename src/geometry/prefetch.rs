//! Asking memory for what will be read soon.

/// Has the nearest cache read what is there, without waiting for it. The processor does so by itself where reads are in a row, and where
/// it sees their addresses early enough: not past some hundred instructions.
#[inline(always)]
pub(crate) fn prefetch<T>(item: &T) {
    #[cfg(target_arch = "x86_64")]
    {
        use core::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        const LINE: usize = 64;
        const { assert!(size_of::<T>() > 0, "there is something to read") };
        let first = (&raw const *item).cast::<i8>();
        for offset in (0..size_of::<T>()).step_by(LINE).chain([size_of::<T>() - 1]) {
            // SAFETY: SSE is part of x86-64, and the address is within the item.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(first.add(offset)) };
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = item;
}
