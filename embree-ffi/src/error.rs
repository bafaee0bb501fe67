//! Everything that can go wrong, each in one line that says what to do.

use std::{fmt, path::PathBuf};

use crate::{Isa, bindings::RTCError, supply::REMEDY};

/// What went wrong.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// No Embree library was found.
    #[error("Embree is missing ({reason}): {REMEDY}")]
    Missing {
        /// Why there is none.
        reason: String,
    },
    /// A library was found, but it cannot be used.
    #[error("the Embree library {} from {origin} is refused: {reason}", .path.display())]
    Refused {
        /// The library.
        path: PathBuf,
        /// How it was found.
        origin: &'static str,
        /// Why it is refused.
        reason: String,
    },
    /// The processor lacks the instruction set that was asked for.
    #[error("this processor does not have the instruction set {0}")]
    UnsupportedIsa(Isa),
    /// Embree itself reported an error.
    #[error("Embree: {message} ({code})")]
    Embree {
        /// Its kind.
        code: ErrorCode,
        /// Embree's own words.
        message: String,
    },
    /// A triangle names a vertex that does not exist. (Embree would drop the triangle silently.)
    #[error("triangle {triangle} names vertex {index}, but there are only {vertices} vertices")]
    IndexOutOfRange {
        /// Its place in the list.
        triangle: usize,
        /// The vertex it names.
        index: u32,
        /// How many there are.
        vertices: usize,
    },
    /// A mesh has more vertices or triangles than 32 bits can count.
    #[error("{count} {what} in one mesh are more than 32-bit indices can name")]
    TooMany {
        /// Vertices or triangles.
        what: &'static str,
        /// How many.
        count: usize,
    },
    /// The device has no kernels for packets of this width. (Embree would fall back to a loop that overruns the packet.)
    #[error("this device has no native packets of {width} rays: 8 need AVX, 16 need AVX-512")]
    PacketWidth {
        /// Rays in the packet.
        width: usize,
    },
    /// Packets were to be filtered in a scene built without `packet_filters`. (Embree would silently not call the filter.)
    #[error("packets can only be filtered in a scene built with packet_filters(true)")]
    PacketFiltersNotBuilt,
}

/// Embree's kinds of error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ErrorCode {
    /// `RTC_ERROR_UNKNOWN`
    Unknown,
    /// `RTC_ERROR_INVALID_ARGUMENT`
    InvalidArgument,
    /// `RTC_ERROR_INVALID_OPERATION`
    InvalidOperation,
    /// `RTC_ERROR_OUT_OF_MEMORY`; also when a memory monitor said stop.
    OutOfMemory,
    /// `RTC_ERROR_UNSUPPORTED_CPU`
    UnsupportedCpu,
    /// `RTC_ERROR_CANCELLED`: a progress monitor said stop.
    Cancelled,
    /// A number newer than this crate.
    Other(u32),
}

impl ErrorCode {
    pub(crate) fn from_raw(code: RTCError) -> Self {
        match code {
            RTCError::RTC_ERROR_UNKNOWN => Self::Unknown,
            RTCError::RTC_ERROR_INVALID_ARGUMENT => Self::InvalidArgument,
            RTCError::RTC_ERROR_INVALID_OPERATION => Self::InvalidOperation,
            RTCError::RTC_ERROR_OUT_OF_MEMORY => Self::OutOfMemory,
            RTCError::RTC_ERROR_UNSUPPORTED_CPU => Self::UnsupportedCpu,
            RTCError::RTC_ERROR_CANCELLED => Self::Cancelled,
            RTCError(number) => Self::Other(number),
        }
    }
}

impl fmt::Display for ErrorCode {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Unknown => formatter.write_str("unknown error"),
            Self::InvalidArgument => formatter.write_str("invalid argument"),
            Self::InvalidOperation => formatter.write_str("invalid operation"),
            Self::OutOfMemory => formatter.write_str("out of memory"),
            Self::UnsupportedCpu => formatter.write_str("unsupported processor"),
            Self::Cancelled => formatter.write_str("cancelled"),
            Self::Other(number) => write!(formatter, "error {number}"),
        }
    }
}
