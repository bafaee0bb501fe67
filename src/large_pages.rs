//! Vectors whose memory the system may hand out in large pages.
//!
//! Building writes memory that was never touched, and the system clears it page by page at the first write: with pages of 4 KiB
//! that was a sixth of the time in which clusters of a large scene were built. Embree asks for large pages too.

use bytemuck::Zeroable;

/// An empty vector with room for so many items.
pub(crate) fn vec_with_room<T>(count: usize) -> Vec<T> {
    let mut vector = Vec::with_capacity(count);
    advise(vector.spare_capacity_mut());
    vector
}

/// So many items of zeros. In memory that was never touched nothing is written.
pub(crate) fn zeros<T: Zeroable>(count: usize) -> Vec<T> {
    let mut vector = bytemuck::zeroed_vec(count);
    advise(&mut vector[..]);
    vector
}

/// Of no avail where the system does as it likes: what is in memory stays the same.
#[cfg(target_os = "linux")]
fn advise<T>(memory: &mut [T]) {
    use rustix::mm::{Advice, madvise};
    /// On x86.
    const LARGE_PAGE: usize = 2 << 20;
    let range = memory.as_mut_ptr_range();
    let first = range.start.cast::<u8>();
    let before = first.align_offset(LARGE_PAGE);
    let bytes = size_of_val(memory).saturating_sub(before) / LARGE_PAGE * LARGE_PAGE;
    if bytes > 0 {
        // SAFETY: these pages lie within the memory that is lent to us alone, and the advice leaves its bytes as they are.
        let _ = unsafe { madvise(first.add(before).cast(), bytes, Advice::LinuxHugepage) };
    }
}

#[cfg(not(target_os = "linux"))]
fn advise<T>(_: &mut [T]) {}

#[cfg(test)]
mod tests {
    use super::{vec_with_room, zeros};

    #[test]
    fn a_vector_with_room_is_like_any_other() {
        for count in [0, 1, 1000, 3_000_000] {
            let mut vector = vec_with_room(count);
            assert!(vector.is_empty() && vector.capacity() >= count);
            vector.extend(0..count);
            assert!(vector.iter().copied().eq(0..count));
        }
        assert_eq!(vec_with_room::<()>(5), []);
    }

    #[test]
    fn zeros_are_as_many_as_were_asked_for() {
        for count in [0, 1, 1000, 3_000_000] {
            assert!(zeros::<u32>(count).into_iter().eq(std::iter::repeat_n(0, count)));
        }
    }
}
