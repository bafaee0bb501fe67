//! Asking a scene about 4, 8 or 16 rays at once.

use std::ptr::null_mut;

use crate::{
    Error, Hit, Ray, Scene, Verdict,
    bindings::{
        Embree, RTCDeviceProperty, RTCFeatureFlags, RTCOccludedArguments, RTCRay4, RTCRay8,
        RTCRay16, RTCRayQueryFlags, RTCScene,
    },
    filter::FilterContext,
};

/// 4, 8 or 16 rays, each quantity in its own row. Aligned for every width.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub struct RayPacket<const N: usize> {
    /// Where they start from: x, y, z.
    pub origin: [[f32; N]; 3],
    /// The least `t`.
    pub tnear: [f32; N],
    /// Where they go: x, y, z.
    pub direction: [[f32; N]; 3],
    time: [f32; N],
    /// The greatest `t`. A query leaves minus infinity in lanes that are blocked: set it anew before the next.
    pub tfar: [f32; N],
    mask: [u32; N],
    id: [u32; N],
    flags: [u32; N],
}

impl<const N: usize> Default for RayPacket<N> {
    /// Rays that hit nothing (`tfar` below 0) and see everything.
    fn default() -> Self {
        Self {
            origin: [[0.0; N]; 3],
            tnear: [0.0; N],
            direction: [[0.0; N]; 3],
            time: [0.0; N],
            tfar: [-1.0; N],
            mask: [!0; N],
            id: [0; N],
            flags: [0; N],
        }
    }
}

impl<const N: usize> RayPacket<N> {
    /// Puts a ray into a lane.
    #[inline]
    pub fn set(&mut self, lane: usize, ray: &Ray) {
        for axis in 0..3 {
            self.origin[axis][lane] = ray.origin[axis];
            self.direction[axis][lane] = ray.direction[axis];
        }
        self.tnear[lane] = ray.tnear;
        self.tfar[lane] = ray.tfar;
        self.mask[lane] = ray.mask();
    }

    /// The first `N` of `rays` in as many lanes, and which lanes those are.
    #[must_use]
    pub fn from_rays(rays: &[Ray]) -> (Self, Lanes<N>) {
        let mut packet = Self::default();
        for (lane, ray) in rays.iter().take(N).enumerate() {
            packet.set(lane, ray);
        }
        (packet, Lanes::first(rays.len().min(N)))
    }

    /// Bit i for a lane i whose `tfar` is that of a blocked ray.
    #[inline]
    fn blocked(&self) -> u32 {
        bits(self.tfar.map(|tfar| tfar == f32::NEG_INFINITY))
    }
}

/// Which lanes of a packet are to be traced; the others are neither read nor written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C, align(64))]
pub struct Lanes<const N: usize>([i32; N]);

impl<const N: usize> Lanes<N> {
    /// All of them.
    pub const ALL: Self = Self([-1; N]);

    /// Those for which `active` says so.
    #[inline]
    pub fn from_fn(active: impl FnMut(usize) -> bool) -> Self {
        Self(std::array::from_fn(active).map(|active| if active { -1 } else { 0 }))
    }

    /// The first `count`.
    #[must_use]
    #[inline]
    pub fn first(count: usize) -> Self {
        Self::from_fn(|lane| lane < count)
    }

    /// Bit i for lane i.
    #[inline]
    fn bits(&self) -> u32 {
        bits(self.0.map(|active| active != 0))
    }
}

#[inline]
fn bits<const N: usize>(lanes: [bool; N]) -> u32 {
    lanes.into_iter().enumerate().fold(0, |bits, (lane, set)| bits | u32::from(set) << lane)
}

/// Whether a packet's rays are alike. It is a matter of speed: on coherent rays [`Coherent`](Self::Coherent) is up to
/// 1.7 times as fast, on others 3 times as slow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Coherence {
    /// Each lane on its own; lanes that part company are traced singly.
    #[default]
    Incoherent,
    /// All lanes in one frustum.
    Coherent,
}

impl Coherence {
    fn flags(self) -> RTCRayQueryFlags {
        match self {
            Self::Incoherent => RTCRayQueryFlags::RTC_RAY_QUERY_FLAG_NONE,
            Self::Coherent => RTCRayQueryFlags::RTC_RAY_QUERY_FLAG_COHERENT,
        }
    }
}

/// Marks the widths 4, 8 and 16.
#[derive(Debug)]
pub struct Width<const N: usize>;

/// What is particular to a width.
pub trait PacketWidth<const N: usize>: sealed::Sealed {
    #[doc(hidden)]
    const NATIVE: RTCDeviceProperty;

    /// # Safety
    /// As `rtcOccluded4` and its like: a committed scene of a device with native packets of this width.
    #[doc(hidden)]
    unsafe fn occluded(
        api: &Embree,
        lanes: &Lanes<N>,
        scene: RTCScene,
        rays: &mut RayPacket<N>,
        arguments: *mut RTCOccludedArguments,
    );
}

mod sealed {
    pub trait Sealed {}
}

macro_rules! packet_width {
    ($width:literal, $raw:ident, $native:ident, $function:ident) => {
        const _: () = {
            use std::mem::offset_of;
            assert!(size_of::<RayPacket<$width>>() == size_of::<$raw>());
            assert!(align_of::<RayPacket<$width>>() % align_of::<$raw>() == 0);
            assert!(align_of::<Lanes<$width>>() % align_of::<$raw>() == 0);
            assert!(offset_of!(RayPacket<$width>, origin) == offset_of!($raw, org_x));
            assert!(offset_of!(RayPacket<$width>, tnear) == offset_of!($raw, tnear));
            assert!(offset_of!(RayPacket<$width>, direction) == offset_of!($raw, dir_x));
            assert!(offset_of!(RayPacket<$width>, time) == offset_of!($raw, time));
            assert!(offset_of!(RayPacket<$width>, tfar) == offset_of!($raw, tfar));
            assert!(offset_of!(RayPacket<$width>, mask) == offset_of!($raw, mask));
            assert!(offset_of!(RayPacket<$width>, flags) == offset_of!($raw, flags));
        };

        impl sealed::Sealed for Width<$width> {}

        impl PacketWidth<$width> for Width<$width> {
            const NATIVE: RTCDeviceProperty = RTCDeviceProperty::$native;

            #[inline]
            unsafe fn occluded(
                api: &Embree,
                lanes: &Lanes<$width>,
                scene: RTCScene,
                rays: &mut RayPacket<$width>,
                arguments: *mut RTCOccludedArguments,
            ) {
                let rays: *mut $raw = (&raw mut *rays).cast();
                // SAFETY: the caller's scene and arguments; lanes and rays are laid out and aligned as asserted above.
                unsafe { (api.$function)(lanes.0.as_ptr(), scene, rays, arguments) }
            }
        }
    };
}

packet_width!(4, RTCRay4, RTC_DEVICE_PROPERTY_NATIVE_RAY4_SUPPORTED, rtcOccluded4);
packet_width!(8, RTCRay8, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED, rtcOccluded8);
packet_width!(16, RTCRay16, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED, rtcOccluded16);

impl Scene {
    /// Packets of 4, 8 or 16 rays.
    ///
    /// Packets decide a few rays at the edges of triangles otherwise than single rays do.
    ///
    /// # Errors
    /// [`Error::PacketWidth`] where this device has no kernels for that many.
    pub fn packets<const N: usize>(&self, coherence: Coherence) -> Result<Packets<'_, N>, Error>
    where
        Width<N>: PacketWidth<N>,
    {
        let device = self.device();
        if device.library().property(device.raw(), Width::<N>::NATIVE) == 0 {
            return Err(Error::PacketWidth { width: N });
        }
        Ok(Packets { scene: self, flags: coherence.flags() })
    }

    /// [`packets`](Self::packets) with filters.
    ///
    /// # Errors
    /// As without, and [`Error::PacketFiltersNotBuilt`] where the scene was not built for them.
    pub fn filtered_packets<const N: usize>(
        &self,
        coherence: Coherence,
    ) -> Result<FilteredPackets<'_, N>, Error>
    where
        Width<N>: PacketWidth<N>,
    {
        if !self.has_packet_filters() {
            return Err(Error::PacketFiltersNotBuilt);
        }
        self.packets(coherence).map(FilteredPackets)
    }
}

/// A scene's way of answering packets of `N` rays.
#[derive(Debug, Clone, Copy)]
pub struct Packets<'s, const N: usize> {
    scene: &'s Scene,
    flags: RTCRayQueryFlags,
}

impl<const N: usize> Packets<'_, N>
where
    Width<N>: PacketWidth<N>,
{
    /// Which of the `lanes` are blocked: bit i for lane i. Their `tfar` becomes minus infinity.
    #[inline]
    pub fn occluded(&self, lanes: &Lanes<N>, rays: &mut RayPacket<N>) -> u32 {
        let mut arguments = RTCOccludedArguments {
            flags: self.flags,
            feature_mask: RTCFeatureFlags::RTC_FEATURE_FLAG_ALL,
            context: null_mut(),
            filter: None,
            occluded: None,
        };
        self.ask(lanes, rays, &mut arguments)
    }

    #[inline]
    fn ask(
        &self,
        lanes: &Lanes<N>,
        rays: &mut RayPacket<N>,
        arguments: &mut RTCOccludedArguments,
    ) -> u32 {
        let asked = lanes.bits() & !rays.blocked();
        // SAFETY: the scene is committed and alive, and its device has kernels of this width, or there were no `Packets`.
        unsafe { Width::<N>::occluded(self.scene.api(), lanes, self.scene.raw(), rays, arguments) };
        asked & rays.blocked()
    }
}

/// A scene's way of answering packets of `N` rays with a filter.
#[derive(Debug, Clone, Copy)]
pub struct FilteredPackets<'s, const N: usize>(Packets<'s, N>);

impl<const N: usize> FilteredPackets<'_, N>
where
    Width<N>: PacketWidth<N>,
{
    /// Which of the `lanes` are blocked by something that `filter`, asked with the lane, accepts: bit i for lane i.
    ///
    /// As [`Scene::occluded_with`] otherwise.
    #[inline]
    pub fn occluded_with(
        &self,
        lanes: &Lanes<N>,
        rays: &mut RayPacket<N>,
        filter: impl FnMut(usize, &Hit) -> Verdict,
    ) -> u32 {
        let mut context = FilterContext::new(filter);
        let mut arguments = context.occluded_arguments(self.0.flags);
        let blocked = self.0.ask(lanes, rays, &mut arguments);
        context.finish();
        blocked
    }

    /// Something that blocks each of the `lanes`, not necessarily the nearest.
    #[inline]
    pub fn occluders(&self, lanes: &Lanes<N>, rays: &mut RayPacket<N>) -> [Option<Hit>; N] {
        let mut found = [None; N];
        self.occluded_with(lanes, rays, |lane, hit| {
            found[lane] = Some(*hit);
            Verdict::Accept
        });
        found
    }
}
