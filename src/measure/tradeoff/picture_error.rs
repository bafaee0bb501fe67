//! How far a picture is from another, as a screen shows them.

use serde::Serialize;

use crate::render::Film;

/// Differences up to this many of 255 levels are hard to see, even side by side.
const VISIBLE: f32 = 4.0 / 255.0;

/// The error of a picture against a reference of the same size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PictureError {
    /// Root of the mean square difference of sRGB values, in 255 levels.
    pub levels: f64,
    /// Pixels per million that differ by more than four levels in some channel.
    pub visible_per_million: f64,
}

impl PictureError {
    /// Of a picture; both are shown with this exposure.
    ///
    /// # Panics
    /// If the pictures differ in size.
    #[must_use]
    pub fn of(picture: &Film, reference: &Film, exposure: f32) -> Self {
        assert_eq!(
            (picture.width(), picture.height()),
            (reference.width(), reference.height()),
            "pictures of one size"
        );
        let (mut squares, mut visible) = (0.0, 0u64);
        for (shown, true_) in picture.displayed(exposure).zip(reference.displayed(exposure)) {
            let difference = (shown - true_).abs();
            squares += difference.as_dvec3().length_squared();
            visible += u64::from(difference.max_element() > VISIBLE);
        }
        let pixels = picture.pixels().len() as f64;
        Self {
            levels: 255.0 * (squares / (3.0 * pixels)).sqrt(),
            visible_per_million: 1e6 * visible as f64 / pixels,
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn the_error_is_in_levels_of_the_screen() {
        let (black, mut other) = (Film::new(10, 10), Film::new(10, 10));
        assert_eq!(PictureError::of(&black, &other, 1.0), PictureError::default());
        other.set((3, 3), Vec3::ONE);
        let error = PictureError::of(&other, &black, 1.0);
        assert!((error.levels - 25.5).abs() < 1e-4, "one pixel in a hundred by 255: {error:?}");
        assert!((error.visible_per_million - 1e4).abs() < 1e-9);
    }

    #[test]
    fn beyond_white_all_is_alike() {
        let (mut bright, mut brighter) = (Film::new(1, 1), Film::new(1, 1));
        bright.set((0, 0), Vec3::splat(2.0));
        brighter.set((0, 0), Vec3::splat(9.0));
        assert_eq!(PictureError::of(&bright, &brighter, 1.0).levels, 0.0);
        assert!(PictureError::of(&bright, &brighter, 0.1).levels > 50.0);
    }
}
