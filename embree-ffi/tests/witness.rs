//! An independent witness of the ABI: `embree4-sys` 0.0.12, made by others from Embree 4.2's own headers.
//!
//! What we share with it must have the layout, values and signatures it states. What 4.3 changed is asserted too.
//! `embree-ffi/ci.sh` runs this; it needs libclang, and Embree under the name the linker looks for.

use std::{any::type_name, collections::BTreeSet};

use embree_ffi::bindings as ours;
use embree4_sys as theirs;

/// A type's name without the crate it is from.
fn bare<T: ?Sized>() -> String {
    type_name::<T>().replace("embree4_sys::", "").replace("embree_ffi::bindings::", "")
}

fn field<S, T>(_: fn(&S) -> &T) -> (usize, String) {
    (size_of::<T>(), bare::<T>())
}

/// Both structures, field by field: place, size, type. Gives their sizes and alignments, ours first.
macro_rules! compare {
    ($name:ident { $($field:ident),+ $(,)? }) => {{
        $(
            let at = (std::mem::offset_of!(ours::$name, $field), std::mem::offset_of!(theirs::$name, $field));
            assert_eq!(at.0, at.1, concat!(stringify!($name), "::", stringify!($field)));
            let ours = field(|value: &ours::$name| &value.$field);
            assert_eq!(ours, field(|value: &theirs::$name| &value.$field), concat!(stringify!($name), "::", stringify!($field)));
        )+
        assert_eq!(align_of::<ours::$name>(), align_of::<theirs::$name>(), stringify!($name));
        (size_of::<ours::$name>(), size_of::<theirs::$name>())
    }};
}

macro_rules! same {
    ($name:ident $fields:tt) => {{
        let (ours, theirs) = compare!($name $fields);
        assert_eq!(ours, theirs, stringify!($name));
    }};
}

#[test]
fn rays_and_arguments_are_as_they_were_in_4_2() {
    same!(RTCRay { org_x, org_y, org_z, tnear, dir_x, dir_y, dir_z, time, tfar, mask, id, flags });
    same!(RTCRay4 { org_x, org_y, org_z, tnear, dir_x, dir_y, dir_z, time, tfar, mask, id, flags });
    same!(RTCRay8 { org_x, org_y, org_z, tnear, dir_x, dir_y, dir_z, time, tfar, mask, id, flags });
    same!(RTCRay16 {
        org_x,
        org_y,
        org_z,
        tnear,
        dir_x,
        dir_y,
        dir_z,
        time,
        tfar,
        mask,
        id,
        flags
    });
    same!(RTCFilterFunctionNArguments { valid, geometryUserPtr, context, ray, hit, N });
    same!(RTCIntersectArguments { flags, feature_mask, context, filter, intersect });
    same!(RTCOccludedArguments { flags, feature_mask, context, filter, occluded });
}

#[test]
fn hits_and_contexts_grew_in_4_3_behind_what_they_had() {
    assert_eq!(compare!(RTCHit { Ng_x, Ng_y, Ng_z, u, v, primID, geomID, instID }), (48, 32));
    assert_eq!(compare!(RTCHit4 { Ng_x, Ng_y, Ng_z, u, v, primID, geomID, instID }), (144, 128));
    assert_eq!(compare!(RTCHit8 { Ng_x, Ng_y, Ng_z, u, v, primID, geomID, instID }), (288, 256));
    assert_eq!(compare!(RTCHit16 { Ng_x, Ng_y, Ng_z, u, v, primID, geomID, instID }), (576, 512));
    assert_eq!((size_of::<ours::RTCRayHit>(), size_of::<theirs::RTCRayHit>()), (96, 80));
    assert_eq!(
        std::mem::offset_of!(ours::RTCRayHit, hit),
        std::mem::offset_of!(theirs::RTCRayHit, hit)
    );
    assert_eq!(compare!(RTCRayQueryContext { instID }), (8, 4));
}

/// Our name and number beside theirs.
macro_rules! constants {
    ($($kind:ident: $($ours:ident = $theirs:expr),+;)+) => {
        $(
            assert_eq!(size_of::<ours::$kind>(), size_of::<theirs::$kind>());
            $(assert_eq!(ours::$kind::$ours.0, $theirs, stringify!($ours));)+
        )+
    };
}

#[test]
fn constants_have_the_values_of_4_2() {
    constants! {
        RTCDeviceProperty:
            RTC_DEVICE_PROPERTY_VERSION = theirs::RTCDeviceProperty::VERSION as u32,
            RTC_DEVICE_PROPERTY_NATIVE_RAY4_SUPPORTED = theirs::RTCDeviceProperty::NATIVE_RAY4_SUPPORTED as u32,
            RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED = theirs::RTCDeviceProperty::NATIVE_RAY8_SUPPORTED as u32,
            RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED = theirs::RTCDeviceProperty::NATIVE_RAY16_SUPPORTED as u32,
            RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED = theirs::RTCDeviceProperty::RAY_MASK_SUPPORTED as u32,
            RTC_DEVICE_PROPERTY_BACKFACE_CULLING_ENABLED = theirs::RTCDeviceProperty::BACKFACE_CULLING_ENABLED as u32,
            RTC_DEVICE_PROPERTY_FILTER_FUNCTION_SUPPORTED = theirs::RTCDeviceProperty::FILTER_FUNCTION_SUPPORTED as u32,
            RTC_DEVICE_PROPERTY_IGNORE_INVALID_RAYS_ENABLED = theirs::RTCDeviceProperty::IGNORE_INVALID_RAYS_ENABLED as u32,
            RTC_DEVICE_PROPERTY_COMPACT_POLYS_ENABLED = theirs::RTCDeviceProperty::COMPACT_POLYS_ENABLED as u32,
            RTC_DEVICE_PROPERTY_TRIANGLE_GEOMETRY_SUPPORTED = theirs::RTCDeviceProperty::TRIANGLE_GEOMETRY_SUPPORTED as u32;
        RTCError:
            RTC_ERROR_NONE = theirs::RTCError::NONE as u32,
            RTC_ERROR_UNKNOWN = theirs::RTCError::UNKNOWN as u32,
            RTC_ERROR_INVALID_ARGUMENT = theirs::RTCError::INVALID_ARGUMENT as u32,
            RTC_ERROR_INVALID_OPERATION = theirs::RTCError::INVALID_OPERATION as u32,
            RTC_ERROR_OUT_OF_MEMORY = theirs::RTCError::OUT_OF_MEMORY as u32,
            RTC_ERROR_UNSUPPORTED_CPU = theirs::RTCError::UNSUPPORTED_CPU as u32,
            RTC_ERROR_CANCELLED = theirs::RTCError::CANCELLED as u32;
        RTCSceneFlags:
            RTC_SCENE_FLAG_NONE = theirs::RTCSceneFlags::NONE.0,
            RTC_SCENE_FLAG_DYNAMIC = theirs::RTCSceneFlags::DYNAMIC.0,
            RTC_SCENE_FLAG_COMPACT = theirs::RTCSceneFlags::COMPACT.0,
            RTC_SCENE_FLAG_ROBUST = theirs::RTCSceneFlags::ROBUST.0,
            RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS = theirs::RTCSceneFlags::FILTER_FUNCTION_IN_ARGUMENTS.0;
        RTCBuildQuality:
            RTC_BUILD_QUALITY_LOW = theirs::RTCBuildQuality::LOW as u32,
            RTC_BUILD_QUALITY_MEDIUM = theirs::RTCBuildQuality::MEDIUM as u32,
            RTC_BUILD_QUALITY_HIGH = theirs::RTCBuildQuality::HIGH as u32;
        RTCGeometryType:
            RTC_GEOMETRY_TYPE_TRIANGLE = theirs::RTCGeometryType::TRIANGLE as u32;
        RTCBufferType:
            RTC_BUFFER_TYPE_INDEX = theirs::RTCBufferType::INDEX as u32,
            RTC_BUFFER_TYPE_VERTEX = theirs::RTCBufferType::VERTEX as u32;
        RTCFormat:
            RTC_FORMAT_UINT3 = theirs::RTCFormat::UINT3 as u32,
            RTC_FORMAT_FLOAT3 = theirs::RTCFormat::FLOAT3 as u32;
        RTCRayQueryFlags:
            RTC_RAY_QUERY_FLAG_NONE = theirs::RTCRayQueryFlags::NONE.0,
            RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER = theirs::RTCRayQueryFlags::INVOKE_ARGUMENT_FILTER.0,
            RTC_RAY_QUERY_FLAG_COHERENT = theirs::RTCRayQueryFlags::COHERENT.0;
        RTCFeatureFlags:
            RTC_FEATURE_FLAG_NONE = theirs::RTCFeatureFlags::RTC_FEATURE_FLAG_NONE.0,
            RTC_FEATURE_FLAG_ALL = theirs::RTCFeatureFlags::RTC_FEATURE_FLAG_ALL.0;
    }
}

/// Each function: its type in our table, its type by their declaration. Gives the names.
macro_rules! functions {
    ($($name:ident($($parameter:tt),*)),+ $(,)?) => {{
        $(
            let (_, ours) = field(|api: &ours::Embree| &api.$name);
            let theirs = { fn name<T>(_: T) -> String { bare::<T>() } name(theirs::$name as unsafe extern "C" fn($($parameter),*) -> _) };
            assert_eq!(ours, theirs, stringify!($name));
        )+
        BTreeSet::from([$(stringify!($name)),+])
    }};
}

#[test]
fn functions_have_the_signatures_of_4_2() {
    let compared = functions![
        rtcNewDevice(_),
        rtcReleaseDevice(_),
        rtcGetDeviceProperty(_, _),
        rtcGetDeviceError(_),
        rtcSetDeviceErrorFunction(_, _, _),
        rtcSetDeviceMemoryMonitorFunction(_, _, _),
        rtcNewGeometry(_, _),
        rtcReleaseGeometry(_),
        rtcCommitGeometry(_),
        rtcSetGeometryMask(_, _),
        rtcSetNewGeometryBuffer(_, _, _, _, _, _),
        rtcSetSharedGeometryBuffer(_, _, _, _, _, _, _, _),
        rtcSetGeometryBuildQuality(_, _),
        rtcNewScene(_),
        rtcReleaseScene(_),
        rtcAttachGeometry(_, _),
        rtcSetSceneFlags(_, _),
        rtcSetSceneBuildQuality(_, _),
        rtcSetSceneProgressMonitorFunction(_, _, _),
        rtcCommitScene(_),
        rtcIntersect1(_, _, _),
        rtcOccluded1(_, _, _),
        rtcOccluded4(_, _, _, _),
        rtcOccluded8(_, _, _, _),
        rtcOccluded16(_, _, _, _),
    ];
    let table = include_str!("../src/bindings.rs")
        .lines()
        .filter_map(|line| line.strip_prefix("    pub rtc"));
    let ours: BTreeSet<String> = table
        .filter_map(|line| Some(format!("rtc{}", line.split_once(": unsafe extern")?.0)))
        .collect();
    assert_eq!(
        compared,
        ours.iter().map(String::as_str).collect(),
        "every function of ours has its witness"
    );
}

#[test]
fn the_layouts_of_4_2_are_what_we_refuse_to_run() {
    assert_eq!((theirs::RTC_VERSION_MAJOR, theirs::RTC_VERSION_MINOR), (4, 2));
}
