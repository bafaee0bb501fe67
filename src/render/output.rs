//! Pictures on disk: PNG with 8 or 16 bits, OpenEXR.

use std::path::{Path, PathBuf};

use glam::Vec3;
use image::{DynamicImage, ImageBuffer, ImageFormat, Rgb};

use super::Film;
use crate::whole_file::write_whole;

/// How a picture is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Picture {
    /// sRGB, 8 bits.
    Png8,
    /// sRGB, 16 bits.
    Png16,
    /// Linear, 32-bit float, exposure not applied.
    OpenExr,
}

/// Why a picture was not written.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// The name does not say what the picture is, or says something else.
    #[error("{path}: {problem}", path = path.display())]
    Kind {
        /// The name.
        path: PathBuf,
        /// What to do.
        problem: String,
    },
    /// The place cannot be written.
    #[error("cannot write {path}: {reason}", path = path.display())]
    Unwritable {
        /// The place.
        path: PathBuf,
        /// What the system said.
        #[source]
        reason: std::io::Error,
    },
}

impl Picture {
    /// The kind that a file name asks for; `bits` (8 or 16) decides between the two of PNG.
    ///
    /// # Errors
    /// [`OutputError::Kind`] if the name ends in neither `.png` nor `.exr`, or a PNG is to have other bits.
    pub fn of(path: &Path, bits: u8) -> Result<Self, OutputError> {
        let wrong = |problem| Err(OutputError::Kind { path: path.to_owned(), problem });
        let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
        match (extension.as_deref(), bits) {
            (Some("png"), 8) => Ok(Self::Png8),
            (Some("png"), 16) => Ok(Self::Png16),
            (Some("png"), _) => wrong(format!("a PNG has 8 or 16 bits a channel, not {bits}")),
            (Some("exr"), _) => Ok(Self::OpenExr),
            _ => wrong("a picture's name must end in .png or .exr".to_owned()),
        }
    }

    /// Whether a file of this name is to hold such a picture.
    fn check(self, path: &Path) -> Result<(), OutputError> {
        let bits = if self == Self::Png16 { 16 } else { 8 };
        if Self::of(path, bits)? == self {
            return Ok(());
        }
        let problem = format!("its name is not that of {self:?}; give another name or kind");
        Err(OutputError::Kind { path: path.to_owned(), problem })
    }
}

/// Share of pixels that automatic exposure lets go white.
const BURNT_OUT: f32 = 0.02;

impl Film {
    /// The exposure that makes all but the brightest pixels fit.
    #[must_use]
    pub fn automatic_exposure(&self) -> f32 {
        let mut brightest: Vec<f32> = self
            .pixels()
            .iter()
            .map(|p| p.max_element())
            .filter(|v| v.is_finite() && *v > 0.0)
            .collect();
        if brightest.is_empty() {
            return 1.0;
        }
        let rank = ((brightest.len() - 1) as f32 * (1.0 - BURNT_OUT)) as usize;
        let (_, white, _) = brightest.select_nth_unstable_by(rank, f32::total_cmp);
        // So dark that the factor would be infinite is black anyway.
        white.recip().min(f32::MAX)
    }
}

/// The sRGB transfer function, from linear 0…1.
fn encode(value: f32) -> f32 {
    let value = value.clamp(0.0, 1.0);
    if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 }
}

impl Film {
    /// What a screen shows of each pixel: sRGB values from 0 to 1, after `exposure`, the factor from film
    /// to picture.
    pub fn displayed(&self, exposure: f32) -> impl Iterator<Item = Vec3> {
        self.pixels().iter().map(move |&pixel| (pixel * exposure).map(encode))
    }
}

/// The bytes of a picture; `exposure` is the factor from film to picture.
///
/// # Panics
/// Without pixels, or with more than the format has room for; no film that was rendered is like that. If the exposure
/// is not a finite number above 0.
#[must_use]
pub fn encode_picture(film: &Film, exposure: f32, kind: Picture) -> Vec<u8> {
    assert!(exposure > 0.0 && exposure.is_finite(), "an exposure of {exposure} makes no picture");
    let (width, height) = (film.width(), film.height());
    let values = || film.displayed(exposure).flat_map(|pixel| pixel.to_array());
    let whole = "film and picture are of one size";
    let (image, format): (DynamicImage, _) = match kind {
        Picture::Png8 => {
            let bytes = values().map(|v| (v * 255.0).round() as u8).collect();
            let buffer = ImageBuffer::<Rgb<u8>, _>::from_raw(width, height, bytes).expect(whole);
            (buffer.into(), ImageFormat::Png)
        }
        Picture::Png16 => {
            let words = values().map(|v| (v * 65535.0).round() as u16).collect();
            let buffer = ImageBuffer::<Rgb<u16>, _>::from_raw(width, height, words).expect(whole);
            (buffer.into(), ImageFormat::Png)
        }
        Picture::OpenExr => {
            let linear = film.pixels().iter().flat_map(|p| p.to_array()).collect();
            let buffer = ImageBuffer::<Rgb<f32>, _>::from_raw(width, height, linear).expect(whole);
            (buffer.into(), ImageFormat::OpenExr)
        }
    };
    let mut encoded = std::io::Cursor::new(Vec::new());
    image.write_to(&mut encoded, format).expect("memory takes any picture");
    encoded.into_inner()
}

/// Writes a picture; `exposure` is the factor from film to picture.
///
/// # Errors
/// If the name is not that of such a picture, or the place cannot be written; what was there is untouched.
///
/// # Panics
/// As [`encode_picture`] does.
pub fn write_picture(
    film: &Film,
    exposure: f32,
    kind: Picture,
    path: &Path,
) -> Result<(), OutputError> {
    kind.check(path)?;
    write_whole(path, &encode_picture(film, exposure, kind))
        .map_err(|reason| OutputError::Unwritable { path: path.to_owned(), reason })
}
