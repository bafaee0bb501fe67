//! Asks a loaded Embree whether it was built the way our structures assume: no function reports that.
//!
//! A build with more instance levels has a longer `RTCHit` and another `RTCRayQueryContext`, under the same version and
//! soname. So one triangle is hit with a context and into a buffer much larger than ours, and the words that changed
//! tell both layouts: one level copies the context's first word to the hit, more levels read a depth there.

use crate::bindings::*;

/// Words in the buffer; the ray is the first twelve.
const WORDS: usize = 96;
const RAY: usize = 12;
const UNTOUCHED: u32 = 0xabab_abab;
/// Instance 0 to a library of one level; to others a stack of depth 0, so that they write "none" instead.
const INSTANCE: u32 = 0;
const INSTANCE_PRIMITIVE: u32 = 7;

#[repr(C, align(64))]
struct Buffer([u32; WORDS]);

/// `Err` says what is different.
pub(crate) fn check(api: &Embree) -> Result<(), String> {
    // SAFETY: every handle is used while alive and released once; the buffers are as large as Embree is told, and the
    // ray's buffer larger than any RTCRayHit of up to 32 instance levels.
    unsafe {
        let device = api.rtcNewDevice(c"".as_ptr());
        if device.is_null() {
            return Err("it makes no device on this machine".into());
        }
        let outcome = check_features(api, device).and_then(|()| check_hit(api, device));
        api.rtcReleaseDevice(device);
        outcome
    }
}

/// Without these, answers would silently be others than asked for.
///
/// # Safety
/// The device is alive.
unsafe fn check_features(api: &Embree, device: RTCDevice) -> Result<(), String> {
    for (property, lack) in [
        (RTCDeviceProperty::RTC_DEVICE_PROPERTY_TRIANGLE_GEOMETRY_SUPPORTED, "triangles"),
        (RTCDeviceProperty::RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED, "ray masks"),
        (RTCDeviceProperty::RTC_DEVICE_PROPERTY_FILTER_FUNCTION_SUPPORTED, "filter functions"),
    ] {
        // SAFETY: the caller's device is alive.
        if unsafe { api.rtcGetDeviceProperty(device, property) } == 0 {
            return Err(format!("it was built without {lack}"));
        }
    }
    Ok(())
}

/// # Safety
/// The device is alive.
unsafe fn check_hit(api: &Embree, device: RTCDevice) -> Result<(), String> {
    let mut buffer = Buffer([UNTOUCHED; WORDS]);
    let ray: [f32; 9] = [0.25, 0.25, -1.0, 0.0, 0.0, 0.0, 1.0, 0.0, f32::INFINITY];
    for (word, value) in buffer.0.iter_mut().zip(ray) {
        *word = value.to_bits();
    }
    buffer.0[9..RAY].copy_from_slice(&[!0, 0, 0]);
    let geometry_id = RAY + 6;
    buffer.0[geometry_id] = !0;
    let mut context = [UNTOUCHED; WORDS];
    context[..2].copy_from_slice(&[INSTANCE, INSTANCE_PRIMITIVE]);
    let mut arguments = RTCIntersectArguments {
        flags: RTCRayQueryFlags::RTC_RAY_QUERY_FLAG_NONE,
        feature_mask: RTCFeatureFlags::RTC_FEATURE_FLAG_ALL,
        context: (&raw mut context).cast(),
        filter: None,
        intersect: None,
    };
    // SAFETY: as in `check`; nine floats and three indices are what the buffers were made for.
    unsafe {
        let scene = api.rtcNewScene(device);
        let geometry = api.rtcNewGeometry(device, RTCGeometryType::RTC_GEOMETRY_TYPE_TRIANGLE);
        let vertex = RTCBufferType::RTC_BUFFER_TYPE_VERTEX;
        let index = RTCBufferType::RTC_BUFFER_TYPE_INDEX;
        let corners =
            api.rtcSetNewGeometryBuffer(geometry, vertex, 0, RTCFormat::RTC_FORMAT_FLOAT3, 12, 3);
        let indices =
            api.rtcSetNewGeometryBuffer(geometry, index, 0, RTCFormat::RTC_FORMAT_UINT3, 12, 1);
        if !corners.is_null() && !indices.is_null() {
            corners
                .cast::<[f32; 9]>()
                .write_unaligned([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
            indices.cast::<[u32; 3]>().write_unaligned([0, 1, 2]);
            api.rtcCommitGeometry(geometry);
            api.rtcAttachGeometry(scene, geometry);
            api.rtcCommitScene(scene);
            api.rtcIntersect1(scene, (&raw mut buffer).cast(), &raw mut arguments);
        }
        api.rtcReleaseGeometry(geometry);
        api.rtcReleaseScene(scene);
    }
    judge(&buffer.0)
}

/// `instID` and, unless instance arrays were left out, `instPrimID` came from the context; nothing behind was written.
fn judge(words: &[u32; WORDS]) -> Result<(), String> {
    let hit = &words[RAY..];
    if (hit[5], hit[6]) != (0, 0) {
        return Err("it misses the one triangle of the layout test".into());
    }
    let instance_primitive = hit[8] == INSTANCE_PRIMITIVE || hit[8] == UNTOUCHED;
    if hit[7] != INSTANCE || !instance_primitive || hit[9..].iter().any(|&word| word != UNTOUCHED) {
        return Err("its RTCHit is not the default one (was it built with RTC_MAX_INSTANCE_LEVEL_COUNT above 1?)".into());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(instances: &[u32]) -> [u32; WORDS] {
        let mut words = [UNTOUCHED; WORDS];
        words[RAY + 5..RAY + 7].fill(0);
        words[RAY + 7..RAY + 7 + instances.len()].copy_from_slice(instances);
        words
    }

    #[test]
    fn one_instance_level_with_or_without_instance_arrays_is_accepted() {
        assert_eq!(judge(&written(&[INSTANCE])), Ok(()));
        assert_eq!(judge(&written(&[INSTANCE, INSTANCE_PRIMITIVE])), Ok(()));
    }

    #[test]
    fn more_instance_levels_are_refused() {
        for words in 2..=64 {
            assert!(judge(&written(&vec![!0; words])).is_err());
        }
        assert!(judge(&written(&[])).is_err());
    }
}
