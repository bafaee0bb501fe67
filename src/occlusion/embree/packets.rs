//! Many rays at once: `rtcOccluded4`, `8` and `16`.

use embree_ffi::{Coherence, Lanes, PacketWidth as Native, RayPacket, Width};

use super::{Embree, OPAQUE, PacketWidth};
use crate::geometry::Ray;
use crate::occlusion::Tally;

/// Answers in packets of the width of the options; `false` if that is one ray at a time.
pub(super) fn occluded(
    embree: &Embree,
    rays: &[Ray],
    blocked: &mut [bool],
    tally: &mut Tally,
) -> bool {
    match embree.options.width {
        PacketWidth::One => return false,
        PacketWidth::Four => in_packets::<4>(embree, rays, blocked, tally),
        PacketWidth::Eight => in_packets::<8>(embree, rays, blocked, tally),
        PacketWidth::Sixteen => in_packets::<16>(embree, rays, blocked, tally),
    }
    true
}

fn in_packets<const N: usize>(
    embree: &Embree,
    rays: &[Ray],
    blocked: &mut [bool],
    tally: &mut Tally,
) where
    Width<N>: Native<N>,
{
    let coherent = embree.options.coherent;
    let coherence = if coherent { Coherence::Coherent } else { Coherence::Incoherent };
    let packets =
        embree.scene.packets::<N>(coherence).expect("the width was checked when it was built");
    for (rays, blocked) in rays.chunks(N).zip(blocked.chunks_mut(N)) {
        let mut packet = RayPacket::<N>::default();
        for (lane, ray) in rays.iter().enumerate() {
            // A lane whose ray cannot be answered keeps the default, which hits nothing.
            if Embree::admit(ray, tally) {
                packet.set(lane, &Embree::ray(ray, OPAQUE));
            }
        }
        let bits = packets.occluded(&Lanes::first(rays.len()), &mut packet);
        for (lane, blocked) in blocked.iter_mut().enumerate() {
            *blocked = bits & (1 << lane) != 0;
        }
    }
}
