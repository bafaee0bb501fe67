#![doc = include_str!("../README.md")]
//! # Modules
//!
//! One direction of dependence, ground floor first: [`geometry`], [`exact`], [`scene`], [`occlusion`],
//! [`shadow`], [`render`], [`measure`], [`cli`]; beside them [`whole_file`].

pub use glam;

pub mod cli;
pub mod exact;
pub mod geometry;
mod large_pages;
pub mod measure;
pub mod occlusion;
pub mod render;
pub mod scene;
pub mod shadow;
pub mod whole_file;
mod words;
