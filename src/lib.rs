//! Does light reach this point? Exact and fast occlusion queries for triangle scenes.
//!
//! One direction of dependence, ground floor first:
//!
//! | module | holds |
//! | --- | --- |
//! | [`geometry`] | rays, triangles, boxes, parametric surfaces |
//! | [`exact`] | certified predicates and the oracle |
//! | [`occlusion`] | the backends: grid, Embree, obvhs' trees, brute force |
//! | [`scene`] | triangles with materials, lights, a camera; loaders; built-in scenes |

pub mod cli;
pub mod exact;
pub mod geometry;
pub mod occlusion;
pub mod render;
pub mod scene;
pub mod shadow;
