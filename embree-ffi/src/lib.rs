#![doc = include_str!("../README.md")]

#[allow(
    missing_docs,
    non_camel_case_types,
    non_snake_case,
    clippy::missing_safety_doc,
    clippy::too_many_arguments,
    clippy::type_complexity,
    clippy::undocumented_unsafe_blocks,
    clippy::useless_transmute
)]
#[doc(hidden)]
#[rustfmt::skip]
pub mod bindings;

mod device;
mod error;
mod filter;
mod layout;
mod library;
mod monitor;
mod packet;
mod query;
mod ray;
mod scene;
mod supply;

pub use device::{Device, DeviceConfig, DeviceProperties, Isa};
pub use error::{Error, ErrorCode};
pub use filter::Verdict;
pub use library::Library;
pub use packet::{Coherence, FilteredPackets, Lanes, PacketWidth, Packets, RayPacket, Width};
pub use ray::{Hit, Ray};
pub use scene::{BuildQuality, Mesh, Scene, SceneBuilder, SceneOptions};
pub use supply::Version;
