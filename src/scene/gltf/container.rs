//! The bytes of a glTF file: JSON, buffers, accessors; every length is checked before it is used.

use std::{
    borrow::Cow,
    path::{Path, PathBuf},
};

use ::gltf::json::{
    Root,
    accessor::{ComponentType, Type as Dimensions},
    validation::Checked,
};
use glam::Vec3;

use super::{Problem, item};
use crate::scene::load::read_plain;

const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;

/// What a GLB begins with.
pub const MAGIC: &[u8] = b"glTF";

/// What a URI begins with that holds the bytes itself.
const DATA: &str = "data:";

/// A glTF file with its buffers.
pub(super) struct Container<'a> {
    pub(super) root: Root,
    pub(super) json: &'a [u8],
    buffers: Vec<Cow<'a, [u8]>>,
    /// The files that hold buffers.
    pub(super) files: Vec<PathBuf>,
}

impl<'a> Container<'a> {
    pub(super) fn open(path: &Path, bytes: &'a [u8]) -> Result<Self, Problem> {
        let must_be_binary = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("glb"));
        let (json, blob) =
            if must_be_binary || bytes.starts_with(MAGIC) { split(bytes)? } else { (bytes, None) };
        let root = Root::from_slice(json).map_err(|e| format!("not glTF JSON: {e}"))?;
        let version = &root.asset.version;
        if version.split('.').next() != Some("2") {
            return Err(format!(
                "the file is of glTF version '{version}'; umbra reads version 2: convert it"
            ));
        }
        let buffers = root
            .buffers
            .iter()
            .enumerate()
            .map(|(index, buffer)| {
                let bytes = match &buffer.uri {
                    Some(uri) => Cow::Owned(read_uri(path, uri, buffer.byte_length.0)?),
                    None => Cow::Borrowed(blob.ok_or("the binary chunk (BIN) is missing")?),
                };
                if (bytes.len() as u64) < buffer.byte_length.0 {
                    return Err(format!(
                        "buffer {index} is cut short: {} bytes of {}",
                        bytes.len(),
                        buffer.byte_length.0
                    ));
                }
                Ok(bytes)
            })
            .collect::<Result<_, Problem>>()?;
        let uris = root.buffers.iter().filter_map(|buffer| buffer.uri.as_deref());
        let files =
            uris.filter(|uri| !uri.starts_with(DATA)).map(|uri| beside(path, uri)).collect();
        Ok(Self { root, json, buffers, files })
    }

    /// The elements of an accessor, if it is of the wanted type and lies within its buffer.
    pub(super) fn elements(
        &self,
        root: &Root,
        index: usize,
        (dimensions, kinds): (Dimensions, &[ComponentType]),
        what: &str,
    ) -> Result<Elements<'_>, Problem> {
        let accessor = item(&root.accessors, index, "accessor")?;
        let wrong = |problem: &str| Err(format!("accessor {index} ({what}) {problem}"));
        if accessor.sparse.is_some() {
            return wrong("is sparse, which umbra does not read");
        }
        let kind = match (accessor.component_type, accessor.type_) {
            (Checked::Valid(kind), Checked::Valid(is)) if is == dimensions => kind.0,
            _ => return wrong("is of the wrong type"),
        };
        if !kinds.contains(&kind) {
            return wrong("is of the wrong type");
        }
        let Some(view) = accessor.buffer_view else { return wrong("has no buffer view") };
        let view = item(&root.buffer_views, view.value(), "buffer view")?;
        item(&root.buffers, view.buffer.value(), "buffer")?;
        let buffer = &self.buffers[view.buffer.value()];

        let size = kind.size() * dimensions.multiplicity();
        let stride = view.byte_stride.as_ref().map_or(size, |stride| stride.0);
        if stride < size {
            return wrong(&format!(
                "has a byteStride of {stride}, less than its elements of {size} bytes; export the file again"
            ));
        }
        let start = view.byte_offset.map_or(0, |offset| offset.0);
        let bytes = slice(buffer, start, view.byte_length.0).and_then(|view| {
            view.get(usize::try_from(accessor.byte_offset.map_or(0, |o| o.0)).ok()?..)
        });
        let count = usize::try_from(accessor.count.0).unwrap_or(usize::MAX);
        let needed = match count {
            0 => Some(0),
            _ => (count - 1).checked_mul(stride).and_then(|last| last.checked_add(size)),
        };
        match (bytes, needed) {
            (Some(bytes), Some(needed)) if needed <= bytes.len() => {
                Ok(Elements { bytes, stride, size: kind.size(), count })
            }
            _ => wrong("reaches beyond the end of its buffer: the file is damaged or cut short"),
        }
    }
}

fn slice(bytes: &[u8], start: u64, length: u64) -> Option<&[u8]> {
    let start = usize::try_from(start).ok()?;
    bytes.get(start..start.checked_add(usize::try_from(length).ok()?)?)
}

/// Elements of one accessor: checked, so reading one cannot fail.
pub(super) struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    /// Bytes of one component.
    size: usize,
    pub(super) count: usize,
}

impl Elements<'_> {
    fn component(&self, element: usize, component: usize) -> [u8; 4] {
        let at = element * self.stride + component * self.size;
        let mut bytes = [0; 4];
        bytes[..self.size].copy_from_slice(&self.bytes[at..at + self.size]);
        bytes
    }

    /// A vector of three f32.
    pub(super) fn vector(&self, element: usize) -> Vec3 {
        Vec3::from_array([0, 1, 2].map(|axis| f32::from_le_bytes(self.component(element, axis))))
    }

    /// An unsigned integer of one, two or four bytes.
    pub(super) fn index(&self, element: usize) -> usize {
        u32::from_le_bytes(self.component(element, 0)) as usize
    }
}

/// The JSON and the binary chunk of a GLB.
fn split(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), Problem> {
    if !bytes.starts_with(MAGIC) {
        return Err("not a GLB: it does not begin with 'glTF'".to_owned());
    }
    let word = |at: usize| {
        let word = bytes.get(at..at + 4).and_then(|word| word.try_into().ok());
        word.map(u32::from_le_bytes)
            .ok_or_else(|| format!("the GLB is cut short: {} bytes", bytes.len()))
    };
    let (version, length) = (word(4)?, word(8)? as usize);
    if version != 2 {
        return Err(format!("the GLB is of version {version}; umbra reads version 2"));
    }
    let Some(bytes) = bytes.get(HEADER..length) else {
        return Err(format!("the GLB is cut short: {} bytes of {length}", bytes.len()));
    };
    let ([kind, json], rest) = chunk(bytes)?;
    if kind != b"JSON" {
        return Err("the first chunk of the GLB is not JSON".to_owned());
    }
    let blob = match rest {
        [] => None,
        _ => {
            let ([kind, blob], _) = chunk(rest)?;
            (kind == b"BIN\0").then_some(blob)
        }
    };
    Ok((json, blob))
}

/// The kind and the content of the first chunk, and what follows it.
fn chunk(bytes: &[u8]) -> Result<([&[u8]; 2], &[u8]), Problem> {
    let cut = || "the GLB is cut short within a chunk".to_owned();
    let (header, rest) = bytes.split_at_checked(CHUNK_HEADER).ok_or_else(cut)?;
    let length = u32::from_le_bytes([header[0], header[1], header[2], header[3]]) as usize;
    let (content, rest) = rest.split_at_checked(length).ok_or_else(cut)?;
    Ok(([&header[4..], content], rest))
}

/// The first `length` bytes of a buffer outside the file, or all of one inside it in base 64.
fn read_uri(gltf: &Path, uri: &str, length: u64) -> Result<Vec<u8>, Problem> {
    if let Some(data) = uri.strip_prefix(DATA) {
        let text = data.split_once(";base64,").ok_or("a data URI is not in base 64")?.1;
        return decode_base64(text).ok_or_else(|| "a data URI is not in base 64".to_owned());
    }
    read_plain(&beside(gltf, uri), length)
        .map_err(|reason| format!("cannot read its buffer '{}': {reason}", decode_percent(uri)))
}

/// The file that a URI names.
fn beside(gltf: &Path, uri: &str) -> PathBuf {
    gltf.parent().unwrap_or(Path::new("")).join(decode_percent(uri))
}

fn decode_base64(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut count) = (0u32, 0);
    for character in text.trim_end_matches('=').bytes() {
        let value = match character {
            b'A'..=b'Z' => character - b'A',
            b'a'..=b'z' => character - b'a' + 26,
            b'0'..=b'9' => character - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        };
        (bits, count) = (bits << 6 | u32::from(value), count + 6);
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
        }
    }
    Some(bytes)
}

fn decode_percent(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&byte, tail)) = rest.split_first() {
        let code = tail.get(..2).and_then(|hex| std::str::from_utf8(hex).ok());
        match code.and_then(|hex| u8::from_str_radix(hex, 16).ok()) {
            Some(decoded) if byte == b'%' => {
                bytes.push(decoded);
                rest = &tail[2..];
            }
            _ => {
                bytes.push(byte);
                rest = tail;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
