//! Which Embree a library is, asked of the library itself: the file name and the soname are the same for every 4.x.

use std::{
    ffi::{c_char, c_int, c_void},
    fmt,
    path::Path,
};

/// Embree's version.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Version {
    /// The 4 of 4.3.2.
    pub major: u32,
    /// The 3 of 4.3.2.
    pub minor: u32,
    /// The 2 of 4.3.2.
    pub patch: u32,
}

impl fmt::Display for Version {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        write!(formatter, "{}.{}.{}", self.major, self.minor, self.patch)
    }
}

impl Version {
    /// From Embree's own way of writing it: 40302 is 4.3.2.
    #[must_use]
    pub const fn from_number(number: u32) -> Self {
        Self { major: number / 10_000, minor: number / 100 % 100, patch: number % 100 }
    }

    /// Whether this crate knows it: at least 4.3, below 5.
    ///
    /// # Errors
    /// Says why not.
    pub fn check(self) -> Result<(), String> {
        if self.major < 4 || self.major == 4 && self.minor < 3 {
            return Err(format!(
                "Embree {self} is too old: 4.3 made RTCHit and RTCRayQueryContext larger under the same soname, \
                 so 4.3 or later is needed"
            ));
        }
        if self.major > 4 {
            return Err(format!(
                "Embree {self} is too new: only 4.3 and later of the 4 series are known to this crate"
            ));
        }
        Ok(())
    }
}

/// Asks the library through three functions that have not changed since 4.0.
///
/// # Safety
/// It must be some Embree.
pub unsafe fn version_of(library: &libloading::Library) -> Result<Version, String> {
    type NewDevice = unsafe extern "C" fn(*const c_char) -> *mut c_void;
    type GetDeviceProperty = unsafe extern "C" fn(*mut c_void, c_int) -> isize;
    type ReleaseDevice = unsafe extern "C" fn(*mut c_void);
    // SAFETY: these are the types of these functions in every Embree 4; the device is released once, after its last use.
    unsafe {
        let new_device =
            library.get::<NewDevice>(b"rtcNewDevice\0").map_err(|error| one_line(&error))?;
        let property = library
            .get::<GetDeviceProperty>(b"rtcGetDeviceProperty\0")
            .map_err(|error| one_line(&error))?;
        let release = library
            .get::<ReleaseDevice>(b"rtcReleaseDevice\0")
            .map_err(|error| one_line(&error))?;
        let device = new_device(c"".as_ptr());
        if device.is_null() {
            return Err("it makes no device on this machine".into());
        }
        let number = property(device, 0);
        release(device);
        Ok(Version::from_number(u32::try_from(number).unwrap_or(0)))
    }
}

/// Whether the loader finds `path`, and what it finds is an Embree we accept.
pub fn is_suitable(path: &Path) -> bool {
    // SAFETY: a library of this name is taken to be Embree, which any program linked to it would do.
    let Ok(library) = (unsafe { super::open(path) }) else { return false };
    // SAFETY: as above.
    let suitable = unsafe { version_of(&library) }.is_ok_and(|version| version.check().is_ok());
    // Never unloaded: its task scheduler may have started threads.
    std::mem::forget(library);
    suitable
}

/// An error and its causes without line breaks.
pub fn one_line(error: &dyn std::error::Error) -> String {
    let mut line = error.to_string();
    let mut cause = error.source();
    while let Some(inner) = cause {
        line = format!("{line}: {inner}");
        cause = inner.source();
    }
    line.replace('\n', " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_point_three_and_later_of_the_four_series_are_accepted() {
        for number in [40_300, 40_303, 40_400, 40_401, 49_999] {
            assert_eq!(Version::from_number(number).check(), Ok(()));
        }
    }

    #[test]
    fn older_and_newer_are_refused_with_the_reason() {
        for number in [0, 31_300, 40_000, 40_200, 40_299] {
            assert!(
                Version::from_number(number)
                    .check()
                    .unwrap_err()
                    .contains("RTCRayQueryContext larger")
            );
        }
        assert!(
            Version::from_number(50_000)
                .check()
                .unwrap_err()
                .starts_with("Embree 5.0.0 is too new")
        );
    }
}
