//! What packets of rays are told.

mod common;

use common::*;
use embree_ffi::{
    Coherence, DeviceConfig, Error, Isa, Lanes, PacketWidth, Ray, RayPacket, Scene, SceneOptions,
    Verdict, Width,
};

fn robust() -> SceneOptions {
    SceneOptions::default().robust(true).packet_filters(true)
}

/// Each packet as its rays would be told one by one.
fn agrees<const N: usize>(scene: &Scene, coherence: Coherence)
where
    Width<N>: PacketWidth<N>,
{
    let packets = scene.packets::<N>(coherence).unwrap();
    let filtered = scene.filtered_packets::<N>(coherence).unwrap();
    let rays = segments(3 * N * 20 + 1);
    for rays in rays.chunks(N) {
        let (packet, lanes) = RayPacket::<N>::from_rays(rays);
        let expected = rays
            .iter()
            .enumerate()
            .fold(0, |bits, (lane, ray)| bits | u32::from(scene.occluded(ray)) << lane);
        let mut asked = packet;
        assert_eq!(packets.occluded(&lanes, &mut asked), expected);
        for lane in 0..N {
            assert_eq!(asked.tfar[lane] == f32::NEG_INFINITY, expected >> lane & 1 == 1);
        }
        let occluders = filtered.occluders(&lanes, &mut packet.clone());
        for (lane, occluder) in occluders.iter().enumerate() {
            assert_eq!(occluder.is_some(), expected >> lane & 1 == 1);
            if let Some(occluder) = occluder {
                assert!(scene.occluded_with(&rays[lane], |hit| {
                    match hit.primitive == occluder.primitive {
                        true => Verdict::Accept,
                        false => Verdict::Reject,
                    }
                }));
            }
        }
        let rejected = filtered.occluded_with(&lanes, &mut packet.clone(), |_, _| Verdict::Reject);
        assert_eq!(rejected, 0);
    }
}

#[test]
fn packets_of_every_width_agree_with_single_rays_on_every_instruction_set() {
    for isa in available() {
        let device = device_with(DeviceConfig::default().isa(isa));
        let scene = soup_scene(&device, robust());
        for coherence in [Coherence::Incoherent, Coherence::Coherent] {
            agrees::<4>(&scene, coherence);
            if isa >= Isa::Avx {
                agrees::<8>(&scene, coherence);
            }
            if isa >= Isa::Avx512 {
                agrees::<16>(&scene, coherence);
            }
        }
    }
}

#[test]
fn inactive_lanes_are_neither_answered_nor_written() {
    let scene = stack(&device(), &[0.0], robust());
    let packets = scene.packets::<4>(Coherence::Incoherent).unwrap();
    let (packet, _) = RayPacket::<4>::from_rays(&[up(true); 4]);
    let mut asked = packet;
    assert_eq!(packets.occluded(&Lanes::from_fn(|lane| lane % 2 == 1), &mut asked), 0b1010);
    assert_eq!(asked.tfar[0].to_bits(), packet.tfar[0].to_bits());
    assert_eq!(asked.tfar[2].to_bits(), packet.tfar[2].to_bits());
    // A packet that was not set anew: its blocked lanes are dead, not blocked again.
    assert_eq!(packets.occluded(&Lanes::ALL, &mut asked), 0b0101);
}

#[test]
fn a_packet_starts_as_rays_that_hit_nothing() {
    let scene = stack(&device(), &[0.0], robust());
    let packets = scene.packets::<4>(Coherence::Coherent).unwrap();
    assert_eq!(packets.occluded(&Lanes::ALL, &mut RayPacket::default()), 0);
}

#[test]
fn a_packet_filter_is_told_lane_and_hit() {
    let scene = stack(&device(), &[0.0, 1.0, 2.0], robust());
    let rays: [Ray; 4] = std::array::from_fn(|lane| up(true).with_interval(0.0, lane as f32 + 0.5));
    let (mut packet, lanes) = RayPacket::<4>::from_rays(&rays);
    let mut seen = [0; 4];
    let filtered = scene.filtered_packets(Coherence::Incoherent).unwrap();
    filtered.occluded_with(&lanes, &mut packet, |lane, hit| {
        assert_eq!(hit.t, hit.geometry as f32 + 1.0);
        assert_eq!(hit.normal, [0.0, 0.0, 4.0]);
        seen[lane] += 1;
        Verdict::Reject
    });
    assert_eq!(seen, [0, 1, 2, 3]);
}

#[test]
fn packets_without_kernels_for_them_are_an_error_that_says_so() {
    let scene = stack(&device_with(DeviceConfig::default().isa(Isa::Sse2)), &[0.0], robust());
    assert!(scene.packets::<4>(Coherence::Coherent).is_ok());
    assert_eq!(
        scene.packets::<8>(Coherence::Coherent).unwrap_err(),
        Error::PacketWidth { width: 8 }
    );
    let error = scene.filtered_packets::<16>(Coherence::Coherent).unwrap_err();
    assert_eq!(
        error.to_string(),
        "this device has no native packets of 16 rays: 8 need AVX, 16 need AVX-512"
    );
}

#[test]
fn filtering_packets_of_a_scene_not_built_for_it_is_an_error() {
    let scene = stack(&device(), &[0.0], SceneOptions::default());
    assert_eq!(
        scene.filtered_packets::<4>(Coherence::Incoherent).unwrap_err(),
        Error::PacketFiltersNotBuilt
    );
}
