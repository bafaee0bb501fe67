// Generated from abi/embree4.h by examples/bindings.rs. Do not edit.

#[repr(C)]
#[derive(Debug)]
pub struct RTCDeviceTy {
    _unused: [u8; 0],
}
pub type RTCDevice = *mut RTCDeviceTy;
#[repr(C)]
#[derive(Debug)]
pub struct RTCSceneTy {
    _unused: [u8; 0],
}
pub type RTCScene = *mut RTCSceneTy;
#[repr(C)]
#[derive(Debug)]
pub struct RTCGeometryTy {
    _unused: [u8; 0],
}
pub type RTCGeometry = *mut RTCGeometryTy;
#[repr(C)]
#[repr(align(16))]
#[derive(Debug, Copy, Clone)]
pub struct RTCRay {
    pub org_x: f32,
    pub org_y: f32,
    pub org_z: f32,
    pub tnear: f32,
    pub dir_x: f32,
    pub dir_y: f32,
    pub dir_z: f32,
    pub time: f32,
    pub tfar: f32,
    pub mask: ::core::ffi::c_uint,
    pub id: ::core::ffi::c_uint,
    pub flags: ::core::ffi::c_uint,
}
#[allow(clippy::unnecessary_operation, clippy::identity_op)]
const _: () = {
    ["Size of RTCRay"][::core::mem::size_of::<RTCRay>() - 48usize];
    ["Alignment of RTCRay"][::core::mem::align_of::<RTCRay>() - 16usize];
    ["Offset of field: RTCRay::org_x"][::core::mem::offset_of!(RTCRay, org_x) - 0usize];
    ["Offset of field: RTCRay::org_y"][::core::mem::offset_of!(RTCRay, org_y) - 4usize];
    ["Offset of field: RTCRay::org_z"][::core::mem::offset_of!(RTCRay, org_z) - 8usize];
    ["Offset of field: RTCRay::tnear"][::core::mem::offset_of!(RTCRay, tnear) - 12usize];
    ["Offset of field: RTCRay::dir_x"][::core::mem::offset_of!(RTCRay, dir_x) - 16usize];
    ["Offset of field: RTCRay::dir_y"][::core::mem::offset_of!(RTCRay, dir_y) - 20usize];
    ["Offset of field: RTCRay::dir_z"][::core::mem::offset_of!(RTCRay, dir_z) - 24usize];
    ["Offset of field: RTCRay::time"][::core::mem::offset_of!(RTCRay, time) - 28usize];
    ["Offset of field: RTCRay::tfar"][::core::mem::offset_of!(RTCRay, tfar) - 32usize];
    ["Offset of field: RTCRay::mask"][::core::mem::offset_of!(RTCRay, mask) - 36usize];
    ["Offset of field: RTCRay::id"][::core::mem::offset_of!(RTCRay, id) - 40usize];
    ["Offset of field: RTCRay::flags"][::core::mem::offset_of!(RTCRay, flags) - 44usize];
};
#[repr(C)]
#[repr(align(16))]
#[derive(Debug, Copy, Clone)]
pub struct RTCHit {
    pub Ng_x: f32,
    pub Ng_y: f32,
    pub Ng_z: f32,
    pub u: f32,
    pub v: f32,
    pub primID: ::core::ffi::c_uint,
    pub geomID: ::core::ffi::c_uint,
    pub instID: [::core::ffi::c_uint; 1usize],
    pub instPrimID: [::core::ffi::c_uint; 1usize],
}
#[allow(clippy::unnecessary_operation, clippy::identity_op)]
const _: () = {
    ["Size of RTCHit"][::core::mem::size_of::<RTCHit>() - 48usize];
    ["Alignment of RTCHit"][::core::mem::align_of::<RTCHit>() - 16usize];
    ["Offset of field: RTCHit::Ng_x"][::core::mem::offset_of!(RTCHit, Ng_x) - 0usize];
    ["Offset of field: RTCHit::Ng_y"][::core::mem::offset_of!(RTCHit, Ng_y) - 4usize];
    ["Offset of field: RTCHit::Ng_z"][::core::mem::offset_of!(RTCHit, Ng_z) - 8usize];
    ["Offset of field: RTCHit::u"][::core::mem::offset_of!(RTCHit, u) - 12usize];
    ["Offset of field: RTCHit::v"][::core::mem::offset_of!(RTCHit, v) - 16usize];
    [
        "Offset of field: RTCHit::primID",
    ][::core::mem::offset_of!(RTCHit, primID) - 20usize];
    [
        "Offset of field: RTCHit::geomID",
    ][::core::mem::offset_of!(RTCHit, geomID) - 24usize];
    [
        "Offset of field: RTCHit::instID",
    ][::core::mem::offset_of!(RTCHit, instID) - 28usize];
    [
        "Offset of field: RTCHit::instPrimID",
    ][::core::mem::offset_of!(RTCHit, instPrimID) - 32usize];
};
#[repr(C)]
#[repr(align(16))]
#[derive(Debug, Copy, Clone)]
pub struct RTCRayHit {
    pub ray: RTCRay,
    pub hit: RTCHit,
}
#[allow(clippy::unnecessary_operation, clippy::identity_op)]
const _: () = {
    ["Size of RTCRayHit"][::core::mem::size_of::<RTCRayHit>() - 96usize];
    ["Alignment of RTCRayHit"][::core::mem::align_of::<RTCRayHit>() - 16usize];
    [
        "Offset of field: RTCRayHit::ray",
    ][::core::mem::offset_of!(RTCRayHit, ray) - 0usize];
    [
        "Offset of field: RTCRayHit::hit",
    ][::core::mem::offset_of!(RTCRayHit, hit) - 48usize];
};
#[repr(C)]
#[repr(align(16))]
#[derive(Debug, Copy, Clone)]
pub struct RTCRay4 {
    pub org_x: [f32; 4usize],
    pub org_y: [f32; 4usize],
    pub org_z: [f32; 4usize],
    pub tnear: [f32; 4usize],
    pub dir_x: [f32; 4usize],
    pub dir_y: [f32; 4usize],
    pub dir_z: [f32; 4usize],
    pub time: [f32; 4usize],
    pub tfar: [f32; 4usize],
    pub mask: [::core::ffi::c_uint; 4usize],
    pub id: [::core::ffi::c_uint; 4usize],
    pub flags: [::core::ffi::c_uint; 4usize],
}
#[allow(clippy::unnecessary_operation, clippy::identity_op)]
const _: () = {
    ["Size of RTCRay4"][::core::mem::size_of::<RTCRay4>() - 192usize];
    ["Alignment of RTCRay4"][::core::mem::align_of::<RTCRay4>() - 16usize];
    [
        "Offset of field: RTCRay4::org_x",
    ][::core::mem::offset_of!(RTCRay4, org_x) - 0usize];
    [
        "Offset of field: RTCRay4::org_y",
    ][::core::mem::offset_of!(RTCRay4, org_y) - 16usize];
    [
        "Offset of field: RTCRay4::org_z",
    ][::core::mem::offset_of!(RTCRay4, org_z) - 32usize];
    [
        "Offset of field: RTCRay4::tnear",
    ][::core::mem::offset_of!(RTCRay4, tnear) - 48usize];
    [
        "Offset of field: RTCRay4::dir_x",
    ][::core::mem::offset_of!(RTCRay4, dir_x) - 64usize];
    [
        "Offset of field: RTCRay4::dir_y",
    ][::core::mem::offset_of!(RTCRay4, dir_y) - 80usize];
    [
        "Offset of field: RTCRay4::dir_z",
    ][::core::mem::offset_of!(RTCRay4, dir_z) - 96usize];
    [
        "Offset of field: RTCRay4::time",
    ][::core::mem::offset_of!(RTCRay4, time) - 112usize];
    [
        "Offset of field: RTCRay4::tfar",
    ][::core::mem::offset_of!(RTCRay4, tfar) - 128usize];
    [
        "Offset of field: RTCRay4::mask",
    ][::core::mem::offset_of!(RTCRay4, mask) - 144usize];
    ["Offset of field: RTCRay4::id"][::core::mem::offset_of!(RTCRay4, id) - 160usize];
    [
        "Offset of field: RTCRay4::flags",
    ][::core::mem::offset_of!(RTCRay4, flags) - 176usize];
};
#[repr(C)]
#[repr(align(16))]
#[derive(Debug, Copy, Clone)]
pub struct RTCHit4 {
    pub Ng_x: [f32; 4usize],
    pub Ng_y: [f32; 4usize],
    pub Ng_z: [f32; 4usize],
    pub u: [f32; 4usize],
    pub v: [f32; 4usize],
    pub primID: [::core::ffi::c_uint; 4usize],
    pub geomID: [::core::ffi::c_uint; 4usize],
    pub instID: [[::core::ffi::c_uint; 4usize]; 1usize],
    pub instPrimID: [[::core::ffi::c_uint; 4usize]; 1usize],
}
#[allow(clippy::unnecessary_operation, clippy::identity_op)]
const _: () = {
    ["Size of RTCHit4"][::core::mem::size_of::<RTCHit4>() - 144usize];
    ["Alignment of RTCHit4"][::core::mem::align_of::<RTCHit4>() - 16usize];
    ["Offset of field: RTCHit4::Ng_x"][::core::mem::offset_of!(RTCHit4, Ng_x) - 0usize];
    ["Offset of field: RTCHit4::Ng_y"][::core::mem::offset_of!(RTCHit4, Ng_y) - 16usize];
    ["Offset of field: RTCHit4::Ng_z"][::core::mem::offset_of!(RTCHit4, Ng_z) - 32usize];
    ["Offset of field: RTCHit4::u"][::core::mem::offset_of!(RTCHit4, u) - 48usize];
    ["Offset of field: RTCHit4::v"][::core::mem::offset_of!(RTCHit4, v) - 64usize];
    [
        "Offset of field: RTCHit4::primID",
    ][::core::mem::offset_of!(RTCHit4, primID) - 80usize];
    [
        "Offset of field: RTCHit4::geomID",
    ][::core::mem::offset_of!(RTCHit4, geomID) - 96usize];
    [
        "Offset of field: RTCHit4::instID",
    ][::core::mem::offset_of!(RTCHit4, instID) - 112usize];
    [
        "Offset of field: RTCHit4::instPrimID",
    ][::core::mem::offset_of!(RTCHit4, instPrimID) - 128usize];
};
#[repr(C)]
#[repr(align(32))]
#[derive(Debug, Copy, Clone)]
pub struct RTCRay8 {
    pub org_x: [f32; 8usize],
    pub org_y: [f32; 8usize],
    pub org_z: [f32; 8usize],
    pub tnear: [f32; 8usize],
    pub dir_x: [f32; 8usize],
    pub dir_y: [f32; 8usize],
    pub dir_z: [f32; 8usize],
    pub time: [f32; 8usize],
    pub tfar: [f32; 8usize],
    pub mask: [::core::ffi::c_uint; 8usize],
    pub id: [::core::ffi::c_uint; 8usize],
    pub flags: [::core::ffi::c_uint; 8usize],
}
#[allow(clippy::unnecessary_operation, clippy::identity_op)]
const _: () = {
    ["Size of RTCRay8"][::core::mem::size_of::<RTCRay8>() - 384usize];
    ["Alignment of RTCRay8"][::core::mem::align_of::<RTCRay8>() - 32usize];
    [
        "Offset of field: RTCRay8::org_x",
    ][::core::mem::offset_of!(RTCRay8, org_x) - 0usize];
    [
        "Offset of field: RTCRay8::org_y",
    ][::core::mem::offset_of!(RTCRay8, org_y) - 32usize];
    [
        "Offset of field: RTCRay8::org_z",
    ][::core::mem::offset_of!(RTCRay8, org_z) - 64usize];
    [
        "Offset of field: RTCRay8::tnear",
    ][::core::mem::offset_of!(RTCRay8, tnear) - 96usize];
    [
        "Offset of field: RTCRay8::dir_x",
    ][::core::mem::offset_of!(RTCRay8, dir_x) - 128usize];
    [
        "Offset of field: RTCRay8::dir_y",
    ][::core::mem::offset_of!(RTCRay8, dir_y) - 160usize];
    [
        "Offset of field: RTCRay8::dir_z",
    ][::core::mem::offset_of!(RTCRay8, dir_z) - 192usize];
    [
        "Offset of field: RTCRay8::time",
    ][::core::mem::offset_of!(RTCRay8, time) - 224usize];
    [
        "Offset of field: RTCRay8::tfar",
    ][::core::mem::offset_of!(RTCRay8, tfar) - 256usize];
    [
        "Offset of field: RTCRay8::mask",
    ][::core::mem::offset_of!(RTCRay8, mask) - 288usize];
    ["Offset of field: RTCRay8::id"][::core::mem::offset_of!(RTCRay8, id) - 320usize];
    [
        "Offset of field: RTCRay8::flags",
    ][::core::mem::offset_of!(RTCRay8, flags) - 352usize];
};
#[repr(C)]
#[repr(align(32))]
#[derive(Debug, Copy, Clone)]
pub struct RTCHit8 {
    pub Ng_x: [f32; 8usize],
    pub Ng_y: [f32; 8usize],
    pub Ng_z: [f32; 8usize],
    pub u: [f32; 8usize],
    pub v: [f32; 8usize],
    pub primID: [::core::ffi::c_uint; 8usize],
    pub geomID: [::core::ffi::c_uint; 8usize],
    pub instID: [[::core::ffi::c_uint; 8usize]; 1usize],
    pub instPrimID: [[::core::ffi::c_uint; 8usize]; 1usize],
}
#[allow(clippy::unnecessary_operation, clippy::identity_op)]
const _: () = {
    ["Size of RTCHit8"][::core::mem::size_of::<RTCHit8>() - 288usize];
    ["Alignment of RTCHit8"][::core::mem::align_of::<RTCHit8>() - 32usize];
    ["Offset of field: RTCHit8::Ng_x"][::core::mem::offset_of!(RTCHit8, Ng_x) - 0usize];
    ["Offset of field: RTCHit8::Ng_y"][::core::mem::offset_of!(RTCHit8, Ng_y) - 32usize];
    ["Offset of field: RTCHit8::Ng_z"][::core::mem::offset_of!(RTCHit8, Ng_z) - 64usize];
    ["Offset of field: RTCHit8::u"][::core::mem::offset_of!(RTCHit8, u) - 96usize];
    ["Offset of field: RTCHit8::v"][::core::mem::offset_of!(RTCHit8, v) - 128usize];
    [
        "Offset of field: RTCHit8::primID",
    ][::core::mem::offset_of!(RTCHit8, primID) - 160usize];
    [
        "Offset of field: RTCHit8::geomID",
    ][::core::mem::offset_of!(RTCHit8, geomID) - 192usize];
    [
        "Offset of field: RTCHit8::instID",
    ][::core::mem::offset_of!(RTCHit8, instID) - 224usize];
    [
        "Offset of field: RTCHit8::instPrimID",
    ][::core::mem::offset_of!(RTCHit8, instPrimID) - 256usize];
};
#[repr(C)]
#[repr(align(64))]
#[derive(Debug, Copy, Clone)]
pub struct RTCRay16 {
    pub org_x: [f32; 16usize],
    pub org_y: [f32; 16usize],
    pub org_z: [f32; 16usize],
    pub tnear: [f32; 16usize],
    pub dir_x: [f32; 16usize],
    pub dir_y: [f32; 16usize],
    pub dir_z: [f32; 16usize],
    pub time: [f32; 16usize],
    pub tfar: [f32; 16usize],
    pub mask: [::core::ffi::c_uint; 16usize],
    pub id: [::core::ffi::c_uint; 16usize],
    pub flags: [::core::ffi::c_uint; 16usize],
}
#[allow(clippy::unnecessary_operation, clippy::identity_op)]
const _: () = {
    ["Size of RTCRay16"][::core::mem::size_of::<RTCRay16>() - 768usize];
    ["Alignment of RTCRay16"][::core::mem::align_of::<RTCRay16>() - 64usize];
    [
        "Offset of field: RTCRay16::org_x",
    ][::core::mem::offset_of!(RTCRay16, org_x) - 0usize];
    [
        "Offset of field: RTCRay16::org_y",
    ][::core::mem::offset_of!(RTCRay16, org_y) - 64usize];
    [
        "Offset of field: RTCRay16::org_z",
    ][::core::mem::offset_of!(RTCRay16, org_z) - 128usize];
    [
        "Offset of field: RTCRay16::tnear",
    ][::core::mem::offset_of!(RTCRay16, tnear) - 192usize];
    [
        "Offset of field: RTCRay16::dir_x",
    ][::core::mem::offset_of!(RTCRay16, dir_x) - 256usize];
    [
        "Offset of field: RTCRay16::dir_y",
    ][::core::mem::offset_of!(RTCRay16, dir_y) - 320usize];
    [
        "Offset of field: RTCRay16::dir_z",
    ][::core::mem::offset_of!(RTCRay16, dir_z) - 384usize];
    [
        "Offset of field: RTCRay16::time",
    ][::core::mem::offset_of!(RTCRay16, time) - 448usize];
    [
        "Offset of field: RTCRay16::tfar",
    ][::core::mem::offset_of!(RTCRay16, tfar) - 512usize];
    [
        "Offset of field: RTCRay16::mask",
    ][::core::mem::offset_of!(RTCRay16, mask) - 576usize];
    ["Offset of field: RTCRay16::id"][::core::mem::offset_of!(RTCRay16, id) - 640usize];
    [
        "Offset of field: RTCRay16::flags",
    ][::core::mem::offset_of!(RTCRay16, flags) - 704usize];
};
#[repr(C)]
#[repr(align(64))]
#[derive(Debug, Copy, Clone)]
pub struct RTCHit16 {
    pub Ng_x: [f32; 16usize],
    pub Ng_y: [f32; 16usize],
    pub Ng_z: [f32; 16usize],
    pub u: [f32; 16usize],
    pub v: [f32; 16usize],
    pub primID: [::core::ffi::c_uint; 16usize],
    pub geomID: [::core::ffi::c_uint; 16usize],
    pub instID: [[::core::ffi::c_uint; 16usize]; 1usize],
    pub instPrimID: [[::core::ffi::c_uint; 16usize]; 1usize],
}
#[allow(clippy::unnecessary_operation, clippy::identity_op)]
const _: () = {
    ["Size of RTCHit16"][::core::mem::size_of::<RTCHit16>() - 576usize];
    ["Alignment of RTCHit16"][::core::mem::align_of::<RTCHit16>() - 64usize];
    [
        "Offset of field: RTCHit16::Ng_x",
    ][::core::mem::offset_of!(RTCHit16, Ng_x) - 0usize];
    [
        "Offset of field: RTCHit16::Ng_y",
    ][::core::mem::offset_of!(RTCHit16, Ng_y) - 64usize];
    [
        "Offset of field: RTCHit16::Ng_z",
    ][::core::mem::offset_of!(RTCHit16, Ng_z) - 128usize];
    ["Offset of field: RTCHit16::u"][::core::mem::offset_of!(RTCHit16, u) - 192usize];
    ["Offset of field: RTCHit16::v"][::core::mem::offset_of!(RTCHit16, v) - 256usize];
    [
        "Offset of field: RTCHit16::primID",
    ][::core::mem::offset_of!(RTCHit16, primID) - 320usize];
    [
        "Offset of field: RTCHit16::geomID",
    ][::core::mem::offset_of!(RTCHit16, geomID) - 384usize];
    [
        "Offset of field: RTCHit16::instID",
    ][::core::mem::offset_of!(RTCHit16, instID) - 448usize];
    [
        "Offset of field: RTCHit16::instPrimID",
    ][::core::mem::offset_of!(RTCHit16, instPrimID) - 512usize];
};
impl RTCDeviceProperty {
    pub const RTC_DEVICE_PROPERTY_VERSION: RTCDeviceProperty = RTCDeviceProperty(0);
    pub const RTC_DEVICE_PROPERTY_NATIVE_RAY4_SUPPORTED: RTCDeviceProperty = RTCDeviceProperty(
        32,
    );
    pub const RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED: RTCDeviceProperty = RTCDeviceProperty(
        33,
    );
    pub const RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED: RTCDeviceProperty = RTCDeviceProperty(
        34,
    );
    pub const RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED: RTCDeviceProperty = RTCDeviceProperty(
        64,
    );
    pub const RTC_DEVICE_PROPERTY_BACKFACE_CULLING_ENABLED: RTCDeviceProperty = RTCDeviceProperty(
        65,
    );
    pub const RTC_DEVICE_PROPERTY_FILTER_FUNCTION_SUPPORTED: RTCDeviceProperty = RTCDeviceProperty(
        66,
    );
    pub const RTC_DEVICE_PROPERTY_IGNORE_INVALID_RAYS_ENABLED: RTCDeviceProperty = RTCDeviceProperty(
        67,
    );
    pub const RTC_DEVICE_PROPERTY_COMPACT_POLYS_ENABLED: RTCDeviceProperty = RTCDeviceProperty(
        68,
    );
    pub const RTC_DEVICE_PROPERTY_TRIANGLE_GEOMETRY_SUPPORTED: RTCDeviceProperty = RTCDeviceProperty(
        96,
    );
}
#[repr(transparent)]
#[derive(Debug, Copy, Clone, Hash, PartialEq, Eq)]
pub struct RTCDeviceProperty(pub ::core::ffi::c_uint);
impl RTCError {
    pub const RTC_ERROR_NONE: RTCError = RTCError(0);
    pub const RTC_ERROR_UNKNOWN: RTCError = RTCError(1);
    pub const RTC_ERROR_INVALID_ARGUMENT: RTCError = RTCError(2);
    pub const RTC_ERROR_INVALID_OPERATION: RTCError = RTCError(3);
    pub const RTC_ERROR_OUT_OF_MEMORY: RTCError = RTCError(4);
    pub const RTC_ERROR_UNSUPPORTED_CPU: RTCError = RTCError(5);
    pub const RTC_ERROR_CANCELLED: RTCError = RTCError(6);
    pub const RTC_ERROR_LEVEL_ZERO_RAYTRACING_SUPPORT_MISSING: RTCError = RTCError(7);
}
#[repr(transparent)]
#[derive(Debug, Copy, Clone, Hash, PartialEq, Eq)]
pub struct RTCError(pub ::core::ffi::c_uint);
impl RTCSceneFlags {
    pub const RTC_SCENE_FLAG_NONE: RTCSceneFlags = RTCSceneFlags(0);
    pub const RTC_SCENE_FLAG_DYNAMIC: RTCSceneFlags = RTCSceneFlags(1);
    pub const RTC_SCENE_FLAG_COMPACT: RTCSceneFlags = RTCSceneFlags(2);
    pub const RTC_SCENE_FLAG_ROBUST: RTCSceneFlags = RTCSceneFlags(4);
    pub const RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS: RTCSceneFlags = RTCSceneFlags(
        8,
    );
}
#[repr(transparent)]
#[derive(Debug, Copy, Clone, Hash, PartialEq, Eq)]
pub struct RTCSceneFlags(pub ::core::ffi::c_uint);
impl RTCBuildQuality {
    pub const RTC_BUILD_QUALITY_LOW: RTCBuildQuality = RTCBuildQuality(0);
    pub const RTC_BUILD_QUALITY_MEDIUM: RTCBuildQuality = RTCBuildQuality(1);
    pub const RTC_BUILD_QUALITY_HIGH: RTCBuildQuality = RTCBuildQuality(2);
}
#[repr(transparent)]
#[derive(Debug, Copy, Clone, Hash, PartialEq, Eq)]
pub struct RTCBuildQuality(pub ::core::ffi::c_uint);
impl RTCGeometryType {
    pub const RTC_GEOMETRY_TYPE_TRIANGLE: RTCGeometryType = RTCGeometryType(0);
}
#[repr(transparent)]
#[derive(Debug, Copy, Clone, Hash, PartialEq, Eq)]
pub struct RTCGeometryType(pub ::core::ffi::c_uint);
impl RTCBufferType {
    pub const RTC_BUFFER_TYPE_INDEX: RTCBufferType = RTCBufferType(0);
    pub const RTC_BUFFER_TYPE_VERTEX: RTCBufferType = RTCBufferType(1);
}
#[repr(transparent)]
#[derive(Debug, Copy, Clone, Hash, PartialEq, Eq)]
pub struct RTCBufferType(pub ::core::ffi::c_uint);
impl RTCFormat {
    pub const RTC_FORMAT_UINT3: RTCFormat = RTCFormat(20483);
    pub const RTC_FORMAT_FLOAT3: RTCFormat = RTCFormat(36867);
}
#[repr(transparent)]
#[derive(Debug, Copy, Clone, Hash, PartialEq, Eq)]
pub struct RTCFormat(pub ::core::ffi::c_uint);
impl RTCRayQueryFlags {
    pub const RTC_RAY_QUERY_FLAG_NONE: RTCRayQueryFlags = RTCRayQueryFlags(0);
    pub const RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER: RTCRayQueryFlags = RTCRayQueryFlags(
        2,
    );
    pub const RTC_RAY_QUERY_FLAG_COHERENT: RTCRayQueryFlags = RTCRayQueryFlags(65536);
}
#[repr(transparent)]
#[derive(Debug, Copy, Clone, Hash, PartialEq, Eq)]
pub struct RTCRayQueryFlags(pub ::core::ffi::c_uint);
impl RTCFeatureFlags {
    pub const RTC_FEATURE_FLAG_NONE: RTCFeatureFlags = RTCFeatureFlags(0);
    pub const RTC_FEATURE_FLAG_ALL: RTCFeatureFlags = RTCFeatureFlags(4294967295);
}
#[repr(transparent)]
#[derive(Debug, Copy, Clone, Hash, PartialEq, Eq)]
pub struct RTCFeatureFlags(pub ::core::ffi::c_uint);
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct RTCRayQueryContext {
    pub instID: [::core::ffi::c_uint; 1usize],
    pub instPrimID: [::core::ffi::c_uint; 1usize],
}
#[allow(clippy::unnecessary_operation, clippy::identity_op)]
const _: () = {
    [
        "Size of RTCRayQueryContext",
    ][::core::mem::size_of::<RTCRayQueryContext>() - 8usize];
    [
        "Alignment of RTCRayQueryContext",
    ][::core::mem::align_of::<RTCRayQueryContext>() - 4usize];
    [
        "Offset of field: RTCRayQueryContext::instID",
    ][::core::mem::offset_of!(RTCRayQueryContext, instID) - 0usize];
    [
        "Offset of field: RTCRayQueryContext::instPrimID",
    ][::core::mem::offset_of!(RTCRayQueryContext, instPrimID) - 4usize];
};
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct RTCFilterFunctionNArguments {
    pub valid: *mut ::core::ffi::c_int,
    pub geometryUserPtr: *mut ::core::ffi::c_void,
    pub context: *mut RTCRayQueryContext,
    pub ray: *mut RTCRayN,
    pub hit: *mut RTCHitN,
    pub N: ::core::ffi::c_uint,
}
#[allow(clippy::unnecessary_operation, clippy::identity_op)]
const _: () = {
    [
        "Size of RTCFilterFunctionNArguments",
    ][::core::mem::size_of::<RTCFilterFunctionNArguments>() - 48usize];
    [
        "Alignment of RTCFilterFunctionNArguments",
    ][::core::mem::align_of::<RTCFilterFunctionNArguments>() - 8usize];
    [
        "Offset of field: RTCFilterFunctionNArguments::valid",
    ][::core::mem::offset_of!(RTCFilterFunctionNArguments, valid) - 0usize];
    [
        "Offset of field: RTCFilterFunctionNArguments::geometryUserPtr",
    ][::core::mem::offset_of!(RTCFilterFunctionNArguments, geometryUserPtr) - 8usize];
    [
        "Offset of field: RTCFilterFunctionNArguments::context",
    ][::core::mem::offset_of!(RTCFilterFunctionNArguments, context) - 16usize];
    [
        "Offset of field: RTCFilterFunctionNArguments::ray",
    ][::core::mem::offset_of!(RTCFilterFunctionNArguments, ray) - 24usize];
    [
        "Offset of field: RTCFilterFunctionNArguments::hit",
    ][::core::mem::offset_of!(RTCFilterFunctionNArguments, hit) - 32usize];
    [
        "Offset of field: RTCFilterFunctionNArguments::N",
    ][::core::mem::offset_of!(RTCFilterFunctionNArguments, N) - 40usize];
};
pub type RTCFilterFunctionN = ::core::option::Option<
    unsafe extern "C" fn(args: *const RTCFilterFunctionNArguments),
>;
#[repr(C)]
#[derive(Debug)]
pub struct RTCIntersectFunctionNArguments {
    _unused: [u8; 0],
}
pub type RTCIntersectFunctionN = ::core::option::Option<
    unsafe extern "C" fn(args: *const RTCIntersectFunctionNArguments),
>;
#[repr(C)]
#[derive(Debug)]
pub struct RTCOccludedFunctionNArguments {
    _unused: [u8; 0],
}
pub type RTCOccludedFunctionN = ::core::option::Option<
    unsafe extern "C" fn(args: *const RTCOccludedFunctionNArguments),
>;
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct RTCIntersectArguments {
    pub flags: RTCRayQueryFlags,
    pub feature_mask: RTCFeatureFlags,
    pub context: *mut RTCRayQueryContext,
    pub filter: RTCFilterFunctionN,
    pub intersect: RTCIntersectFunctionN,
}
#[allow(clippy::unnecessary_operation, clippy::identity_op)]
const _: () = {
    [
        "Size of RTCIntersectArguments",
    ][::core::mem::size_of::<RTCIntersectArguments>() - 32usize];
    [
        "Alignment of RTCIntersectArguments",
    ][::core::mem::align_of::<RTCIntersectArguments>() - 8usize];
    [
        "Offset of field: RTCIntersectArguments::flags",
    ][::core::mem::offset_of!(RTCIntersectArguments, flags) - 0usize];
    [
        "Offset of field: RTCIntersectArguments::feature_mask",
    ][::core::mem::offset_of!(RTCIntersectArguments, feature_mask) - 4usize];
    [
        "Offset of field: RTCIntersectArguments::context",
    ][::core::mem::offset_of!(RTCIntersectArguments, context) - 8usize];
    [
        "Offset of field: RTCIntersectArguments::filter",
    ][::core::mem::offset_of!(RTCIntersectArguments, filter) - 16usize];
    [
        "Offset of field: RTCIntersectArguments::intersect",
    ][::core::mem::offset_of!(RTCIntersectArguments, intersect) - 24usize];
};
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct RTCOccludedArguments {
    pub flags: RTCRayQueryFlags,
    pub feature_mask: RTCFeatureFlags,
    pub context: *mut RTCRayQueryContext,
    pub filter: RTCFilterFunctionN,
    pub occluded: RTCOccludedFunctionN,
}
#[allow(clippy::unnecessary_operation, clippy::identity_op)]
const _: () = {
    [
        "Size of RTCOccludedArguments",
    ][::core::mem::size_of::<RTCOccludedArguments>() - 32usize];
    [
        "Alignment of RTCOccludedArguments",
    ][::core::mem::align_of::<RTCOccludedArguments>() - 8usize];
    [
        "Offset of field: RTCOccludedArguments::flags",
    ][::core::mem::offset_of!(RTCOccludedArguments, flags) - 0usize];
    [
        "Offset of field: RTCOccludedArguments::feature_mask",
    ][::core::mem::offset_of!(RTCOccludedArguments, feature_mask) - 4usize];
    [
        "Offset of field: RTCOccludedArguments::context",
    ][::core::mem::offset_of!(RTCOccludedArguments, context) - 8usize];
    [
        "Offset of field: RTCOccludedArguments::filter",
    ][::core::mem::offset_of!(RTCOccludedArguments, filter) - 16usize];
    [
        "Offset of field: RTCOccludedArguments::occluded",
    ][::core::mem::offset_of!(RTCOccludedArguments, occluded) - 24usize];
};
pub type RTCErrorFunction = ::core::option::Option<
    unsafe extern "C" fn(
        userPtr: *mut ::core::ffi::c_void,
        code: RTCError,
        str_: *const ::core::ffi::c_char,
    ),
>;
pub type RTCMemoryMonitorFunction = ::core::option::Option<
    unsafe extern "C" fn(ptr: *mut ::core::ffi::c_void, bytes: isize, post: bool) -> bool,
>;
pub type RTCProgressMonitorFunction = ::core::option::Option<
    unsafe extern "C" fn(ptr: *mut ::core::ffi::c_void, n: f64) -> bool,
>;
pub type RTCGetDeviceLastErrorMessageFunction = ::core::option::Option<
    unsafe extern "C" fn(device: RTCDevice) -> *const ::core::ffi::c_char,
>;
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct RTCRayN {
    pub _address: u8,
}
#[repr(C)]
#[derive(Debug, Copy, Clone)]
pub struct RTCHitN {
    pub _address: u8,
}
pub struct Embree {
    __library: ::libloading::Library,
    pub rtcNewDevice: unsafe extern "C" fn(
        config: *const ::core::ffi::c_char,
    ) -> RTCDevice,
    pub rtcReleaseDevice: unsafe extern "C" fn(device: RTCDevice),
    pub rtcGetDeviceProperty: unsafe extern "C" fn(
        device: RTCDevice,
        prop: RTCDeviceProperty,
    ) -> isize,
    pub rtcGetDeviceError: unsafe extern "C" fn(device: RTCDevice) -> RTCError,
    pub rtcSetDeviceErrorFunction: unsafe extern "C" fn(
        device: RTCDevice,
        error: RTCErrorFunction,
        userPtr: *mut ::core::ffi::c_void,
    ),
    pub rtcSetDeviceMemoryMonitorFunction: unsafe extern "C" fn(
        device: RTCDevice,
        memoryMonitor: RTCMemoryMonitorFunction,
        userPtr: *mut ::core::ffi::c_void,
    ),
    pub rtcNewGeometry: unsafe extern "C" fn(
        device: RTCDevice,
        type_: RTCGeometryType,
    ) -> RTCGeometry,
    pub rtcReleaseGeometry: unsafe extern "C" fn(geometry: RTCGeometry),
    pub rtcCommitGeometry: unsafe extern "C" fn(geometry: RTCGeometry),
    pub rtcSetGeometryMask: unsafe extern "C" fn(
        geometry: RTCGeometry,
        mask: ::core::ffi::c_uint,
    ),
    pub rtcSetNewGeometryBuffer: unsafe extern "C" fn(
        geometry: RTCGeometry,
        type_: RTCBufferType,
        slot: ::core::ffi::c_uint,
        format: RTCFormat,
        byteStride: usize,
        itemCount: usize,
    ) -> *mut ::core::ffi::c_void,
    pub rtcSetSharedGeometryBuffer: unsafe extern "C" fn(
        geometry: RTCGeometry,
        type_: RTCBufferType,
        slot: ::core::ffi::c_uint,
        format: RTCFormat,
        ptr: *const ::core::ffi::c_void,
        byteOffset: usize,
        byteStride: usize,
        itemCount: usize,
    ),
    pub rtcSetGeometryBuildQuality: unsafe extern "C" fn(
        geometry: RTCGeometry,
        quality: RTCBuildQuality,
    ),
    pub rtcNewScene: unsafe extern "C" fn(device: RTCDevice) -> RTCScene,
    pub rtcReleaseScene: unsafe extern "C" fn(scene: RTCScene),
    pub rtcAttachGeometry: unsafe extern "C" fn(
        scene: RTCScene,
        geometry: RTCGeometry,
    ) -> ::core::ffi::c_uint,
    pub rtcSetSceneFlags: unsafe extern "C" fn(scene: RTCScene, flags: RTCSceneFlags),
    pub rtcSetSceneBuildQuality: unsafe extern "C" fn(
        scene: RTCScene,
        quality: RTCBuildQuality,
    ),
    pub rtcSetSceneProgressMonitorFunction: unsafe extern "C" fn(
        scene: RTCScene,
        progress: RTCProgressMonitorFunction,
        ptr: *mut ::core::ffi::c_void,
    ),
    pub rtcCommitScene: unsafe extern "C" fn(scene: RTCScene),
    pub rtcIntersect1: unsafe extern "C" fn(
        scene: RTCScene,
        rayhit: *mut RTCRayHit,
        args: *mut RTCIntersectArguments,
    ),
    pub rtcOccluded1: unsafe extern "C" fn(
        scene: RTCScene,
        ray: *mut RTCRay,
        args: *mut RTCOccludedArguments,
    ),
    pub rtcOccluded4: unsafe extern "C" fn(
        valid: *const ::core::ffi::c_int,
        scene: RTCScene,
        ray: *mut RTCRay4,
        args: *mut RTCOccludedArguments,
    ),
    pub rtcOccluded8: unsafe extern "C" fn(
        valid: *const ::core::ffi::c_int,
        scene: RTCScene,
        ray: *mut RTCRay8,
        args: *mut RTCOccludedArguments,
    ),
    pub rtcOccluded16: unsafe extern "C" fn(
        valid: *const ::core::ffi::c_int,
        scene: RTCScene,
        ray: *mut RTCRay16,
        args: *mut RTCOccludedArguments,
    ),
}
impl Embree {
    pub unsafe fn new<P>(path: P) -> Result<Self, ::libloading::Error>
    where
        P: AsRef<::std::ffi::OsStr>,
    {
        let path = path.as_ref();
        let library = unsafe { ::libloading::Library::new(path) }?;
        unsafe { Self::from_library(library) }
    }
    pub unsafe fn from_library<L>(library: L) -> Result<Self, ::libloading::Error>
    where
        L: Into<::libloading::Library>,
    {
        let __library = library.into();
        let rtcNewDevice = unsafe { __library.get(b"rtcNewDevice\0") }.map(|sym| *sym)?;
        let rtcReleaseDevice = unsafe { __library.get(b"rtcReleaseDevice\0") }
            .map(|sym| *sym)?;
        let rtcGetDeviceProperty = unsafe { __library.get(b"rtcGetDeviceProperty\0") }
            .map(|sym| *sym)?;
        let rtcGetDeviceError = unsafe { __library.get(b"rtcGetDeviceError\0") }
            .map(|sym| *sym)?;
        let rtcSetDeviceErrorFunction = unsafe {
            __library.get(b"rtcSetDeviceErrorFunction\0")
        }
            .map(|sym| *sym)?;
        let rtcSetDeviceMemoryMonitorFunction = unsafe {
            __library.get(b"rtcSetDeviceMemoryMonitorFunction\0")
        }
            .map(|sym| *sym)?;
        let rtcNewGeometry = unsafe { __library.get(b"rtcNewGeometry\0") }
            .map(|sym| *sym)?;
        let rtcReleaseGeometry = unsafe { __library.get(b"rtcReleaseGeometry\0") }
            .map(|sym| *sym)?;
        let rtcCommitGeometry = unsafe { __library.get(b"rtcCommitGeometry\0") }
            .map(|sym| *sym)?;
        let rtcSetGeometryMask = unsafe { __library.get(b"rtcSetGeometryMask\0") }
            .map(|sym| *sym)?;
        let rtcSetNewGeometryBuffer = unsafe {
            __library.get(b"rtcSetNewGeometryBuffer\0")
        }
            .map(|sym| *sym)?;
        let rtcSetSharedGeometryBuffer = unsafe {
            __library.get(b"rtcSetSharedGeometryBuffer\0")
        }
            .map(|sym| *sym)?;
        let rtcSetGeometryBuildQuality = unsafe {
            __library.get(b"rtcSetGeometryBuildQuality\0")
        }
            .map(|sym| *sym)?;
        let rtcNewScene = unsafe { __library.get(b"rtcNewScene\0") }.map(|sym| *sym)?;
        let rtcReleaseScene = unsafe { __library.get(b"rtcReleaseScene\0") }
            .map(|sym| *sym)?;
        let rtcAttachGeometry = unsafe { __library.get(b"rtcAttachGeometry\0") }
            .map(|sym| *sym)?;
        let rtcSetSceneFlags = unsafe { __library.get(b"rtcSetSceneFlags\0") }
            .map(|sym| *sym)?;
        let rtcSetSceneBuildQuality = unsafe {
            __library.get(b"rtcSetSceneBuildQuality\0")
        }
            .map(|sym| *sym)?;
        let rtcSetSceneProgressMonitorFunction = unsafe {
            __library.get(b"rtcSetSceneProgressMonitorFunction\0")
        }
            .map(|sym| *sym)?;
        let rtcCommitScene = unsafe { __library.get(b"rtcCommitScene\0") }
            .map(|sym| *sym)?;
        let rtcIntersect1 = unsafe { __library.get(b"rtcIntersect1\0") }
            .map(|sym| *sym)?;
        let rtcOccluded1 = unsafe { __library.get(b"rtcOccluded1\0") }.map(|sym| *sym)?;
        let rtcOccluded4 = unsafe { __library.get(b"rtcOccluded4\0") }.map(|sym| *sym)?;
        let rtcOccluded8 = unsafe { __library.get(b"rtcOccluded8\0") }.map(|sym| *sym)?;
        let rtcOccluded16 = unsafe { __library.get(b"rtcOccluded16\0") }
            .map(|sym| *sym)?;
        Ok(Embree {
            __library,
            rtcNewDevice,
            rtcReleaseDevice,
            rtcGetDeviceProperty,
            rtcGetDeviceError,
            rtcSetDeviceErrorFunction,
            rtcSetDeviceMemoryMonitorFunction,
            rtcNewGeometry,
            rtcReleaseGeometry,
            rtcCommitGeometry,
            rtcSetGeometryMask,
            rtcSetNewGeometryBuffer,
            rtcSetSharedGeometryBuffer,
            rtcSetGeometryBuildQuality,
            rtcNewScene,
            rtcReleaseScene,
            rtcAttachGeometry,
            rtcSetSceneFlags,
            rtcSetSceneBuildQuality,
            rtcSetSceneProgressMonitorFunction,
            rtcCommitScene,
            rtcIntersect1,
            rtcOccluded1,
            rtcOccluded4,
            rtcOccluded8,
            rtcOccluded16,
        })
    }
    pub unsafe fn rtcNewDevice(&self, config: *const ::core::ffi::c_char) -> RTCDevice {
        unsafe { (self.rtcNewDevice)(config) }
    }
    pub unsafe fn rtcReleaseDevice(&self, device: RTCDevice) {
        unsafe { (self.rtcReleaseDevice)(device) }
    }
    pub unsafe fn rtcGetDeviceProperty(
        &self,
        device: RTCDevice,
        prop: RTCDeviceProperty,
    ) -> isize {
        unsafe { (self.rtcGetDeviceProperty)(device, prop) }
    }
    pub unsafe fn rtcGetDeviceError(&self, device: RTCDevice) -> RTCError {
        unsafe { (self.rtcGetDeviceError)(device) }
    }
    pub unsafe fn rtcSetDeviceErrorFunction(
        &self,
        device: RTCDevice,
        error: RTCErrorFunction,
        userPtr: *mut ::core::ffi::c_void,
    ) {
        unsafe { (self.rtcSetDeviceErrorFunction)(device, error, userPtr) }
    }
    pub unsafe fn rtcSetDeviceMemoryMonitorFunction(
        &self,
        device: RTCDevice,
        memoryMonitor: RTCMemoryMonitorFunction,
        userPtr: *mut ::core::ffi::c_void,
    ) {
        unsafe {
            (self.rtcSetDeviceMemoryMonitorFunction)(device, memoryMonitor, userPtr)
        }
    }
    pub unsafe fn rtcNewGeometry(
        &self,
        device: RTCDevice,
        type_: RTCGeometryType,
    ) -> RTCGeometry {
        unsafe { (self.rtcNewGeometry)(device, type_) }
    }
    pub unsafe fn rtcReleaseGeometry(&self, geometry: RTCGeometry) {
        unsafe { (self.rtcReleaseGeometry)(geometry) }
    }
    pub unsafe fn rtcCommitGeometry(&self, geometry: RTCGeometry) {
        unsafe { (self.rtcCommitGeometry)(geometry) }
    }
    pub unsafe fn rtcSetGeometryMask(
        &self,
        geometry: RTCGeometry,
        mask: ::core::ffi::c_uint,
    ) {
        unsafe { (self.rtcSetGeometryMask)(geometry, mask) }
    }
    pub unsafe fn rtcSetNewGeometryBuffer(
        &self,
        geometry: RTCGeometry,
        type_: RTCBufferType,
        slot: ::core::ffi::c_uint,
        format: RTCFormat,
        byteStride: usize,
        itemCount: usize,
    ) -> *mut ::core::ffi::c_void {
        unsafe {
            (self
                .rtcSetNewGeometryBuffer)(
                geometry,
                type_,
                slot,
                format,
                byteStride,
                itemCount,
            )
        }
    }
    pub unsafe fn rtcSetSharedGeometryBuffer(
        &self,
        geometry: RTCGeometry,
        type_: RTCBufferType,
        slot: ::core::ffi::c_uint,
        format: RTCFormat,
        ptr: *const ::core::ffi::c_void,
        byteOffset: usize,
        byteStride: usize,
        itemCount: usize,
    ) {
        unsafe {
            (self
                .rtcSetSharedGeometryBuffer)(
                geometry,
                type_,
                slot,
                format,
                ptr,
                byteOffset,
                byteStride,
                itemCount,
            )
        }
    }
    pub unsafe fn rtcSetGeometryBuildQuality(
        &self,
        geometry: RTCGeometry,
        quality: RTCBuildQuality,
    ) {
        unsafe { (self.rtcSetGeometryBuildQuality)(geometry, quality) }
    }
    pub unsafe fn rtcNewScene(&self, device: RTCDevice) -> RTCScene {
        unsafe { (self.rtcNewScene)(device) }
    }
    pub unsafe fn rtcReleaseScene(&self, scene: RTCScene) {
        unsafe { (self.rtcReleaseScene)(scene) }
    }
    pub unsafe fn rtcAttachGeometry(
        &self,
        scene: RTCScene,
        geometry: RTCGeometry,
    ) -> ::core::ffi::c_uint {
        unsafe { (self.rtcAttachGeometry)(scene, geometry) }
    }
    pub unsafe fn rtcSetSceneFlags(&self, scene: RTCScene, flags: RTCSceneFlags) {
        unsafe { (self.rtcSetSceneFlags)(scene, flags) }
    }
    pub unsafe fn rtcSetSceneBuildQuality(
        &self,
        scene: RTCScene,
        quality: RTCBuildQuality,
    ) {
        unsafe { (self.rtcSetSceneBuildQuality)(scene, quality) }
    }
    pub unsafe fn rtcSetSceneProgressMonitorFunction(
        &self,
        scene: RTCScene,
        progress: RTCProgressMonitorFunction,
        ptr: *mut ::core::ffi::c_void,
    ) {
        unsafe { (self.rtcSetSceneProgressMonitorFunction)(scene, progress, ptr) }
    }
    pub unsafe fn rtcCommitScene(&self, scene: RTCScene) {
        unsafe { (self.rtcCommitScene)(scene) }
    }
    pub unsafe fn rtcIntersect1(
        &self,
        scene: RTCScene,
        rayhit: *mut RTCRayHit,
        args: *mut RTCIntersectArguments,
    ) {
        unsafe { (self.rtcIntersect1)(scene, rayhit, args) }
    }
    pub unsafe fn rtcOccluded1(
        &self,
        scene: RTCScene,
        ray: *mut RTCRay,
        args: *mut RTCOccludedArguments,
    ) {
        unsafe { (self.rtcOccluded1)(scene, ray, args) }
    }
    pub unsafe fn rtcOccluded4(
        &self,
        valid: *const ::core::ffi::c_int,
        scene: RTCScene,
        ray: *mut RTCRay4,
        args: *mut RTCOccludedArguments,
    ) {
        unsafe { (self.rtcOccluded4)(valid, scene, ray, args) }
    }
    pub unsafe fn rtcOccluded8(
        &self,
        valid: *const ::core::ffi::c_int,
        scene: RTCScene,
        ray: *mut RTCRay8,
        args: *mut RTCOccludedArguments,
    ) {
        unsafe { (self.rtcOccluded8)(valid, scene, ray, args) }
    }
    pub unsafe fn rtcOccluded16(
        &self,
        valid: *const ::core::ffi::c_int,
        scene: RTCScene,
        ray: *mut RTCRay16,
        args: *mut RTCOccludedArguments,
    ) {
        unsafe { (self.rtcOccluded16)(valid, scene, ray, args) }
    }
}
