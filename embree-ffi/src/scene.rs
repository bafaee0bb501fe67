//! Building a scene of triangle meshes.

use std::{
    any::Any, ffi::c_void, fmt, num::NonZeroU32, ops::ControlFlow, panic::resume_unwind, ptr,
    sync::Arc,
};

use crate::{
    Device, Error,
    bindings::{
        Embree, RTCBufferType, RTCBuildQuality, RTCFormat, RTCGeometry, RTCGeometryType, RTCScene,
        RTCSceneFlags,
    },
    monitor::{Progress, watch_progress},
};

/// How much work goes into the acceleration structure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BuildQuality {
    /// Along Morton's curve, one tree per mesh: built in a quarter of the time, slower to query.
    Low,
    /// A surface-area heuristic.
    #[default]
    Medium,
    /// With spatial splits, unless the scene is robust or compact. A filter may then be asked twice about one triangle.
    High,
}

impl BuildQuality {
    fn raw(self) -> RTCBuildQuality {
        match self {
            Self::Low => RTCBuildQuality::RTC_BUILD_QUALITY_LOW,
            Self::Medium => RTCBuildQuality::RTC_BUILD_QUALITY_MEDIUM,
            Self::High => RTCBuildQuality::RTC_BUILD_QUALITY_HIGH,
        }
    }
}

/// How a scene is to be built.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SceneOptions {
    quality: BuildQuality,
    robust: bool,
    compact: bool,
    packet_filters: bool,
}

impl SceneOptions {
    /// The quality; medium by default.
    #[must_use]
    pub fn quality(self, quality: BuildQuality) -> Self {
        Self { quality, ..self }
    }

    /// Pluecker's triangle test and conservative boxes: far fewer rays slip through edges and vertices. Off by default.
    #[must_use]
    pub fn robust(self, robust: bool) -> Self {
        Self { robust, ..self }
    }

    /// Half the memory, somewhat slower. Off by default.
    #[must_use]
    pub fn compact(self, compact: bool) -> Self {
        Self { compact, ..self }
    }

    /// Allow filters on packets ([`Scene::filtered_packets`]). Off by default. Single rays can always be filtered.
    #[must_use]
    pub fn packet_filters(self, packet_filters: bool) -> Self {
        Self { packet_filters, ..self }
    }

    fn flags(self) -> RTCSceneFlags {
        let flag = |wanted: bool, flag: RTCSceneFlags| if wanted { flag.0 } else { 0 };
        RTCSceneFlags(
            flag(self.robust, RTCSceneFlags::RTC_SCENE_FLAG_ROBUST)
                | flag(self.compact, RTCSceneFlags::RTC_SCENE_FLAG_COMPACT)
                | flag(
                    self.packet_filters,
                    RTCSceneFlags::RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS,
                ),
        )
    }
}

/// Triangles that share vertices. Triangles with a coordinate that is NaN, infinite or beyond 1.844e18 are never hit.
#[derive(Debug, Clone, Copy)]
pub struct Mesh<'m> {
    vertices: &'m [[f32; 3]],
    triangles: &'m [[u32; 3]],
    mask: u32,
}

impl<'m> Mesh<'m> {
    /// Seen by every ray.
    #[must_use]
    pub fn new(vertices: &'m [[f32; 3]], triangles: &'m [[u32; 3]]) -> Self {
        Self { vertices, triangles, mask: !0 }
    }

    /// Seen only by rays whose mask shares a bit with this one.
    #[must_use]
    pub fn with_mask(self, mask: NonZeroU32) -> Self {
        Self { mask: mask.get(), ..self }
    }

    fn check(&self) -> Result<(), Error> {
        for (what, count) in
            [("vertices", self.vertices.len()), ("triangles", self.triangles.len())]
        {
            if count >= u32::MAX as usize {
                return Err(Error::TooMany { what, count });
            }
        }
        let vertices = self.vertices.len();
        for (triangle, corners) in self.triangles.iter().enumerate() {
            if let Some(&index) = corners.iter().find(|&&index| index as usize >= vertices) {
                return Err(Error::IndexOutOfRange { triangle, index, vertices });
            }
        }
        Ok(())
    }
}

/// A scene that is still being put together; it cannot be asked anything. [`commit`](Self::commit) makes it a [`Scene`].
#[derive(Debug)]
pub struct SceneBuilder {
    owner: SceneOwner,
    options: SceneOptions,
}

impl SceneBuilder {
    /// An empty scene.
    ///
    /// # Errors
    /// If Embree makes none, for lack of memory.
    pub fn new(device: &Device, options: SceneOptions) -> Result<Self, Error> {
        let api = &device.library().api;
        // SAFETY: the device is alive.
        let raw = unsafe { api.rtcNewScene(device.raw()) };
        if raw.is_null() {
            return Err(unexplained(device));
        }
        let owner = SceneOwner { raw, device: device.clone(), kept: Vec::new() };
        let quality = options.quality.raw();
        // SAFETY: the scene is alive and ours alone.
        unsafe {
            api.rtcSetSceneFlags(raw, options.flags());
            api.rtcSetSceneBuildQuality(raw, quality);
        }
        device.take_error()?;
        Ok(Self { owner, options })
    }

    /// Copies a mesh into the scene. Its number is how many were added before.
    ///
    /// The copy lies in Embree's own buffers, which are padded as its vector loads need.
    ///
    /// # Errors
    /// If the mesh is too large or names a vertex that it does not have, or memory does not suffice.
    pub fn add(&mut self, mesh: Mesh) -> Result<u32, Error> {
        mesh.check()?;
        let geometry = self.geometry()?;
        geometry.fill(VERTICES, RTCFormat::RTC_FORMAT_FLOAT3, mesh.vertices.iter().copied())?;
        geometry.fill(INDICES, RTCFormat::RTC_FORMAT_UINT3, mesh.triangles.iter().copied())?;
        self.attach(&geometry, mesh.mask)
    }

    /// Adds triangles whose corners, three each in a row, Embree reads where they lie. Its number is how many were added before.
    ///
    /// A corner begins with three coordinates, and takes 16 bytes, as Embree's vector loads need. The scene keeps `owner`
    /// until it is gone.
    ///
    /// # Errors
    /// If there are too many corners, or memory does not suffice.
    ///
    /// # Safety
    /// As long as a clone of `owner` lives, the corners must stay in their place, unchanged.
    pub unsafe fn add_in_place<Corner>(
        &mut self,
        corners: &[[Corner; 3]],
        mask: NonZeroU32,
        owner: Arc<dyn Any + Send + Sync>,
    ) -> Result<u32, Error> {
        const { assert!(size_of::<Corner>() == 16 && align_of::<Corner>().is_multiple_of(4)) };
        let count = 3 * corners.len();
        if count >= u32::MAX as usize {
            return Err(Error::TooMany { what: "vertices", count });
        }
        let geometry = self.geometry()?;
        if count > 0 {
            self.owner.kept.push(owner);
            let format = RTCFormat::RTC_FORMAT_FLOAT3;
            // SAFETY: the geometry is alive. The corners are of that size and number, and stay there, as the caller promises,
            // while `kept` keeps their owner: until after the scene is gone.
            unsafe {
                let corners = corners.as_ptr().cast();
                let api = &self.owner.device.library().api;
                api.rtcSetSharedGeometryBuffer(
                    geometry.raw,
                    VERTICES,
                    0,
                    format,
                    corners,
                    0,
                    16,
                    count,
                );
            }
        }
        let own = |triangle| [3 * triangle, 3 * triangle + 1, 3 * triangle + 2];
        let indices = (0..corners.len() as u32).map(own);
        geometry.fill(INDICES, RTCFormat::RTC_FORMAT_UINT3, indices)?;
        self.attach(&geometry, mask.get())
    }

    fn geometry(&self) -> Result<GeometryOwner, Error> {
        let device = self.owner.device.clone();
        let kind = RTCGeometryType::RTC_GEOMETRY_TYPE_TRIANGLE;
        // SAFETY: the device is alive.
        let raw = unsafe { device.library().api.rtcNewGeometry(device.raw(), kind) };
        if raw.is_null() {
            return Err(unexplained(&device));
        }
        Ok(GeometryOwner { raw, device })
    }

    fn attach(&self, geometry: &GeometryOwner, mask: u32) -> Result<u32, Error> {
        let device = &self.owner.device;
        let (api, raw) = (&device.library().api, geometry.raw);
        // SAFETY: scene and geometry are alive and ours alone. The scene keeps a reference of its own.
        let id = unsafe {
            api.rtcSetGeometryMask(raw, mask);
            // What is built quickly is the geometry's tree: a scene of low quality has one for each.
            api.rtcSetGeometryBuildQuality(raw, self.options.quality.raw());
            api.rtcCommitGeometry(raw);
            api.rtcAttachGeometry(self.owner.raw, raw)
        };
        device.take_error()?;
        Ok(id)
    }

    /// Builds the acceleration structure.
    ///
    /// # Errors
    /// If memory does not suffice, or the device's monitor says so.
    pub fn commit(self) -> Result<Scene, Error> {
        self.build()
    }

    /// [`commit`](Self::commit), telling `progress` the fraction done, from any of the building threads.
    ///
    /// A panic of `progress` cancels, and goes on from here.
    ///
    /// # Errors
    /// As without it; and [`ErrorCode::Cancelled`](crate::ErrorCode::Cancelled) if it answers [`ControlFlow::Break`].
    pub fn commit_with_progress(
        self,
        progress: impl Fn(f64) -> ControlFlow<()> + Sync,
    ) -> Result<Scene, Error> {
        let api = &self.owner.device.library().api;
        let raw = self.owner.raw;
        let progress = Progress::new(&progress);
        // SAFETY: the scene is alive and ours alone, and `progress` outlives the build, the only time it is called.
        unsafe {
            api.rtcSetSceneProgressMonitorFunction(
                raw,
                Some(watch_progress),
                (&raw const progress).cast_mut().cast(),
            );
        }
        let outcome = self.build();
        if let Ok(scene) = &outcome {
            // SAFETY: the scene is alive and still ours alone; it must not keep a pointer to `progress`.
            unsafe { api.rtcSetSceneProgressMonitorFunction(scene.raw(), None, ptr::null_mut()) };
        }
        if let Some(payload) = progress.take_panic() {
            resume_unwind(payload);
        }
        outcome
    }

    fn build(self) -> Result<Scene, Error> {
        let device = &self.owner.device;
        // SAFETY: the scene is alive and ours alone.
        unsafe { device.library().api.rtcCommitScene(self.owner.raw) };
        device.take_error()?;
        Ok(Scene { owner: self.owner, packet_filters: self.options.packet_filters })
    }
}

/// A committed scene. Any number of threads may ask it at once.
#[derive(Debug)]
pub struct Scene {
    owner: SceneOwner,
    packet_filters: bool,
}

impl Scene {
    /// The device it was built by.
    #[must_use]
    pub fn device(&self) -> &Device {
        &self.owner.device
    }

    /// Looks whether Embree met an error in this thread's queries since the last look.
    ///
    /// Queries do not look themselves, it would cost more than many of them. None of them is known to meet an error.
    ///
    /// # Errors
    /// The first one that it met.
    pub fn check(&self) -> Result<(), Error> {
        self.owner.device.take_error()
    }

    pub(crate) fn has_packet_filters(&self) -> bool {
        self.packet_filters
    }

    #[inline]
    pub(crate) fn raw(&self) -> RTCScene {
        self.owner.raw
    }

    #[inline]
    pub(crate) fn api(&self) -> &'static Embree {
        &self.owner.device.library().api
    }
}

/// The one reference we hold to a scene.
struct SceneOwner {
    raw: RTCScene,
    device: Device,
    /// Who owns what its geometries read in place; dropped after the scene, which our own [`Drop`] releases first.
    kept: Vec<Arc<dyn Any + Send + Sync>>,
}

// SAFETY: a scene may be used and released from any thread. Changing it needs `&mut` or ownership of the builder, and
// after the commit nothing changes it: queries only read.
unsafe impl Send for SceneOwner {}
// SAFETY: as above.
unsafe impl Sync for SceneOwner {}

impl Drop for SceneOwner {
    fn drop(&mut self) {
        // SAFETY: our one reference, released once, while the device is alive.
        unsafe { self.device.library().api.rtcReleaseScene(self.raw) }
    }
}

impl fmt::Debug for SceneOwner {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        self.device.fmt(formatter)
    }
}

const VERTICES: RTCBufferType = RTCBufferType::RTC_BUFFER_TYPE_VERTEX;
const INDICES: RTCBufferType = RTCBufferType::RTC_BUFFER_TYPE_INDEX;

/// The one reference we hold to a geometry until the scene has its own.
struct GeometryOwner {
    raw: RTCGeometry,
    device: Device,
}

impl GeometryOwner {
    /// Puts items into a new buffer of Embree's.
    fn fill<T: Copy>(
        &self,
        kind: RTCBufferType,
        format: RTCFormat,
        items: impl ExactSizeIterator<Item = [T; 3]>,
    ) -> Result<(), Error> {
        let (api, bytes, count) = (&self.device.library().api, size_of::<[T; 3]>(), items.len());
        // SAFETY: the geometry is alive.
        let buffer: *mut c_void =
            unsafe { api.rtcSetNewGeometryBuffer(self.raw, kind, 0, format, bytes, count) };
        if count == 0 {
            // Embree then has no buffer to show, or one of no use.
            return self.device.take_error();
        }
        if buffer.is_null() {
            return Err(unexplained(&self.device));
        }
        for (place, item) in (0..count).zip(items) {
            // SAFETY: the buffer was made for as many items of that size, and nobody else knows it yet.
            unsafe { buffer.cast::<[T; 3]>().add(place).write_unaligned(item) };
        }
        Ok(())
    }
}

impl Drop for GeometryOwner {
    fn drop(&mut self) {
        // SAFETY: our one reference, released once, while the device is alive.
        unsafe { self.device.library().api.rtcReleaseGeometry(self.raw) }
    }
}

/// The error behind a null handle.
fn unexplained(device: &Device) -> Error {
    let message = || "no reason given".to_owned();
    device
        .take_error()
        .err()
        .unwrap_or_else(|| Error::Embree { code: crate::ErrorCode::Unknown, message: message() })
}
