//! Colours that the colour-blind can tell apart: the palette of Okabe and Ito, in sRGB.
//!
//! Okabe & Ito: Color Universal Design, 2002 (revised 2008).

#![allow(missing_docs, reason = "the names say it")]

/// Red, green and blue, 0 to 255.
pub type Srgb = [u8; 3];

pub const ORANGE: Srgb = [230, 159, 0];
pub const SKY_BLUE: Srgb = [86, 180, 233];
pub const BLUISH_GREEN: Srgb = [0, 158, 115];
pub const YELLOW: Srgb = [240, 228, 66];
pub const BLUE: Srgb = [0, 114, 178];
pub const VERMILLION: Srgb = [213, 94, 0];
pub const REDDISH_PURPLE: Srgb = [204, 121, 167];
