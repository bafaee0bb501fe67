//! Each trap of Embree's C interface, and what became of it here.

mod common;

use std::{num::NonZeroU32, process::Command, sync::Arc};

use common::*;
use embree_ffi::{
    BuildQuality, Coherence, DeviceConfig, Error, Hit, Isa, Lanes, Mesh, Ray, RayPacket,
    SceneBuilder, SceneOptions, Verdict, bindings,
};

/// Embree reads 16 bytes at the last vertex of 12. It gets its own, padded copy: so it does not matter what lies behind
/// the caller's vertices, nor whether they still exist.
#[test]
fn vertices_need_no_padding_and_are_copied() {
    for options in [SceneOptions::default(), SceneOptions::default().compact(true)] {
        let device = device();
        let mut builder = SceneBuilder::new(&device, options).unwrap();
        let mut vertices = square(0.0).to_vec().into_boxed_slice();
        builder.add(Mesh::new(&vertices, &SQUARE)).unwrap();
        vertices.fill([f32::NAN; 3]);
        drop(vertices);
        let scene = builder.commit().unwrap();
        assert!(scene.occluded(&up(true)));
        assert!(!scene.occluded(&up(false)));
    }
}

/// The same where the last vertex ends with its page and the next page must not be read.
#[test]
#[cfg(target_os = "linux")]
fn vertices_may_end_at_the_end_of_readable_memory() {
    use std::ffi::{c_int, c_void};
    unsafe extern "C" {
        fn mmap(
            at: *mut c_void,
            length: usize,
            protection: c_int,
            flags: c_int,
            file: c_int,
            offset: i64,
        ) -> *mut c_void;
        fn mprotect(at: *mut c_void, length: usize, protection: c_int) -> c_int;
        fn munmap(at: *mut c_void, length: usize) -> c_int;
    }
    const PAGE: usize = 65536;
    let (read_and_write, private_and_anonymous) = (3, 0x22);
    let vertices = square(0.0);
    // SAFETY: two pages of our own, of which the second is closed; the slice ends where it begins.
    unsafe {
        let pages =
            mmap(std::ptr::null_mut(), 2 * PAGE, read_and_write, private_and_anonymous, -1, 0);
        assert_ne!(pages as isize, -1);
        assert_eq!(mprotect(pages.byte_add(PAGE), PAGE, 0), 0);
        let place = pages.byte_add(PAGE - size_of_val(&vertices)).cast::<[f32; 3]>();
        place.copy_from_nonoverlapping(vertices.as_ptr(), 4);
        let mut builder = SceneBuilder::new(&device(), SceneOptions::default()).unwrap();
        builder.add(Mesh::new(std::slice::from_raw_parts(place, 4), &SQUARE)).unwrap();
        assert!(builder.commit().unwrap().occluded(&up(true)));
        munmap(pages, 2 * PAGE);
    }
}

/// Corners of 16 bytes need no copy; whoever owns them is kept until the scene is gone.
#[test]
fn corners_may_be_read_in_place_as_long_as_the_scene_lives() {
    let (vertices, indices) = soup(2000);
    let padded = |index: u32| {
        let [x, y, z] = vertices[index as usize];
        [x, y, z, f32::NAN]
    };
    let corners: Vec<[[f32; 4]; 3]> = indices.iter().map(|corners| corners.map(padded)).collect();
    let device = device();
    for options in [
        SceneOptions::default(),
        SceneOptions::default().robust(true),
        SceneOptions::default().compact(true),
    ] {
        let owner = Arc::new(corners.clone());
        let mut builder = SceneBuilder::new(&device, options).unwrap();
        let all = NonZeroU32::MAX;
        // SAFETY: the owner's corners are never changed.
        let added = unsafe { builder.add_in_place(&owner, all, owner.clone()) };
        assert_eq!(added.unwrap(), 0);
        let scene = builder.commit().unwrap();
        let weak = Arc::downgrade(&owner);
        drop(owner);
        let copied = soup_scene(&device, options);
        for ray in segments(2000) {
            assert_eq!(scene.occluded(&ray), copied.occluded(&ray));
        }
        assert!(weak.upgrade().is_some(), "the scene keeps them");
        drop(scene);
        assert!(weak.upgrade().is_none(), "and lets them go");
    }
}

/// A scene of low quality is built quickly only where its geometries are, too: otherwise it is the tree of medium quality.
#[test]
fn low_quality_builds_another_tree_than_medium() {
    let bytes = |quality| {
        let device = device();
        let scene = soup_scene(&device, SceneOptions::default().quality(quality));
        let bytes = device.memory_used();
        drop(scene);
        bytes
    };
    assert_ne!(bytes(BuildQuality::Low), bytes(BuildQuality::Medium));
}

/// A mask of 0 sees nothing, and a zeroed ray has one. Here a mask is all ones, or a `NonZeroU32`.
#[test]
fn no_ray_has_a_mask_of_zero() {
    assert_eq!(Ray::new([0.0; 3], [1.0; 3]).mask(), !0);
    assert_eq!(Ray::between([0.0; 3], [1.0; 3]).mask(), !0);
    let one = NonZeroU32::new(1).unwrap();
    assert_eq!(Ray::new([0.0; 3], [1.0; 3]).with_mask(one).mask(), 1);
    // A packet's lanes, set or not, have one too: rays written into the public rows are seen.
    let scene = stack(&device(), &[0.0], SceneOptions::default());
    let mut packet = RayPacket::<4>::default();
    packet.origin = [[0.5; 4], [0.25; 4], [-1.0; 4]];
    packet.direction[2] = [1.0; 4];
    packet.tfar = [9.0; 4];
    assert_eq!(
        scene.packets(Coherence::Incoherent).unwrap().occluded(&Lanes::ALL, &mut packet),
        0b1111
    );
}

/// Without kernels for 8 or 16 rays Embree treats the packet as a ray and hit packet, and writes behind it.
#[test]
fn wide_packets_without_native_support_are_refused_not_run() {
    for isa in available() {
        let scene =
            stack(&device_with(DeviceConfig::default().isa(isa)), &[0.0], SceneOptions::default());
        let properties = scene.device().properties();
        assert_eq!(properties.native_packets_of_8, isa >= Isa::Avx);
        assert_eq!(properties.native_packets_of_16, isa >= Isa::Avx512);
        assert_eq!(scene.packets::<8>(Coherence::Coherent).is_ok(), isa >= Isa::Avx);
        assert_eq!(scene.packets::<16>(Coherence::Coherent).is_ok(), isa >= Isa::Avx512);
    }
}

/// What lies behind a packet stays as it was, at every width this machine can run.
#[test]
fn packets_are_not_written_beyond_their_end() {
    #[repr(C)]
    struct Guarded<const N: usize>(RayPacket<N>, [u64; 128]);
    fn check<const N: usize>()
    where
        embree_ffi::Width<N>: embree_ffi::PacketWidth<N>,
    {
        for heights in [&[][..], &[0.0], &[0.0, 1.0, 2.0, 3.0, 4.0]] {
            let scene = stack(&device(), heights, SceneOptions::default().packet_filters(true));
            let mut guarded =
                Guarded(RayPacket::<N>::from_rays(&[up(true); N]).0, [0xabab_abab_abab_abab; 128]);
            let Ok(packets) = scene.packets::<N>(Coherence::Incoherent) else { continue };
            packets.occluded(&Lanes::ALL, &mut guarded.0);
            guarded.0.tfar = [9.0; N];
            scene
                .filtered_packets::<N>(Coherence::Coherent)
                .unwrap()
                .occluders(&Lanes::ALL, &mut guarded.0);
            assert_eq!(guarded.1, [0xabab_abab_abab_abab; 128]);
        }
    }
    check::<4>();
    check::<8>();
    check::<16>();
}

/// Embree demands 16, 32 and 64 bytes and checks only in its debug builds. Here the types are so aligned.
#[test]
fn rays_and_lanes_are_aligned_wherever_they_lie() {
    #[repr(C)]
    struct Askew<T>(u8, T);
    assert_eq!(std::mem::offset_of!(Askew<Ray>, 1) % 16, 0);
    assert_eq!(std::mem::offset_of!(Askew<RayPacket<4>>, 1) % 16, 0);
    assert_eq!(std::mem::offset_of!(Askew<RayPacket<8>>, 1) % 32, 0);
    assert_eq!(std::mem::offset_of!(Askew<RayPacket<16>>, 1) % 64, 0);
    assert_eq!(std::mem::offset_of!(Askew<Lanes<8>>, 1) % 32, 0);
    assert_eq!(std::mem::offset_of!(Askew<Lanes<16>>, 1) % 64, 0);
    let scene = stack(&device(), &[0.0], SceneOptions::default());
    let mut rays: Vec<Askew<Ray>> = (0..50).map(|count| Askew(count, up(true))).collect();
    for Askew(_, ray) in &mut rays {
        scene.occluded1(ray);
        assert!(ray.is_occluded());
    }
}

/// With the hit of 4.2 (80 bytes in all) Embree 4.3 writes 4 bytes beyond the end. Ours has room, and it is used.
#[test]
fn the_hit_has_room_for_what_4_3_writes() {
    assert_eq!(size_of::<bindings::RTCRayHit>(), 96);
    assert_eq!(
        std::mem::offset_of!(bindings::RTCRayHit, hit)
            + std::mem::offset_of!(bindings::RTCHit, instPrimID),
        80
    );
}

/// With the context of 4.2 (4 bytes) Embree 4.3 reads beyond the end when a filter is called. Ours has 8, then our own.
#[test]
fn a_filter_works_because_the_context_has_the_size_of_4_3() {
    assert_eq!(size_of::<bindings::RTCRayQueryContext>(), 8);
    let scene = stack(&device(), &[0.0], SceneOptions::default());
    let canary = [0xabab_abab_u32; 64];
    let mut calls = 0;
    let blocked = scene.occluded_with(&up(true), |_: &Hit| {
        assert_eq!(canary, [0xabab_abab; 64]);
        calls += 1;
        Verdict::Accept
    });
    assert!(blocked);
    assert_eq!(calls, 1);
}

/// Error 7 is new in 4.3.3: as a Rust enumeration of the known ones it would be undefined behaviour. Here it is a number.
#[test]
fn unknown_numbers_from_embree_are_numbers() {
    assert_eq!(
        bindings::RTCError(7),
        bindings::RTCError::RTC_ERROR_LEVEL_ZERO_RAYTRACING_SUPPORT_MISSING
    );
    assert_ne!(bindings::RTCError(4711), bindings::RTCError::RTC_ERROR_NONE);
}

/// Embree takes an unknown word for SSE2, and drops triangles with bad indices. Neither can be said here.
#[test]
fn what_embree_takes_silently_is_a_type_or_an_error() {
    for isa in Isa::ALL {
        let made = embree_ffi::Device::new(DeviceConfig::default().isa(isa));
        match isa.is_available() {
            true => assert!(made.is_ok()),
            false => assert_eq!(made.unwrap_err(), Error::UnsupportedIsa(isa)),
        }
    }
    let mut builder = SceneBuilder::new(&device(), SceneOptions::default()).unwrap();
    let error = builder.add(Mesh::new(&square(0.0), &[[0, 1, 2], [1, 2, 4]])).unwrap_err();
    assert_eq!(error, Error::IndexOutOfRange { triangle: 1, index: 4, vertices: 4 });
    assert_eq!(error.to_string(), "triangle 1 names vertex 4, but there are only 4 vertices");
}

/// `HIGH` may call a filter twice for one triangle: documented at `BuildQuality::High`; without repetition the set is right.
#[test]
fn gathering_at_every_quality_finds_the_same_triangles() {
    let gather = |quality| {
        let scene = soup_scene(&device(), SceneOptions::default().quality(quality));
        let mut all = Vec::new();
        for (number, ray) in segments(2000).iter().enumerate() {
            scene.occluded_with(ray, |hit| {
                all.push((number, hit.primitive));
                Verdict::Reject
            });
        }
        all.sort_unstable();
        all.dedup();
        all
    };
    let all = gather(BuildQuality::Medium);
    assert!(all.len() > 300);
    assert_eq!(gather(BuildQuality::Low), all);
    assert_eq!(gather(BuildQuality::High), all);
}

/// Without Embree the tests fail rather than skip, and every failure says what is missing in one line.
#[test]
fn without_a_library_a_program_is_told_in_one_line() {
    let nothing = tempfile::tempdir().unwrap();
    let output = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "no_ray_has_a_mask_of_zero"])
        .env("EMBREE_DIR", nothing.path())
        .output()
        .unwrap();
    assert!(!output.status.success());
    let text = String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr);
    let line = text.lines().find(|line| line.contains("Embree is missing")).expect(&text);
    for way in ["EMBREE_DIR", "install Embree 4.3 or later", "python3 -m pip"] {
        assert!(line.contains(way), "{line}");
    }
}
