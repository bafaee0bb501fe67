//! The bytes of a glTF file: JSON and buffers; every length is checked before it is used.

use std::{
    borrow::Cow,
    path::{Path, PathBuf},
};

use ::gltf::json::{Asset, Root};
use serde_json::{Value, json};

use super::Problem;
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
    pub(super) buffers: Vec<Cow<'a, [u8]>>,
    /// The files that hold buffers.
    pub(super) files: Vec<PathBuf>,
}

impl<'a> Container<'a> {
    pub(super) fn open(path: &Path, bytes: &'a [u8]) -> Result<Self, Problem> {
        let must_be_binary = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("glb"));
        let (json, blob) =
            if must_be_binary || bytes.starts_with(MAGIC) { split(bytes)? } else { (bytes, None) };
        let root = read_json(json)?;
        check_version(&root.asset)?;
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
}

/// Reads the JSON.
///
/// The gltf crate demands two fields that glTF does not: the nodes of a scene, and the node that an animation moves.
/// Where they are missing, there are none, and channels that move none are left out, as all animations are.
fn read_json(json: &[u8]) -> Result<Root, Problem> {
    let error = match Root::from_slice(json) {
        Ok(root) => return Ok(root),
        Err(error) => error,
    };
    let mut document: Value =
        serde_json::from_slice(json).map_err(|error| format!("not glTF JSON: {error}"))?;
    for scene in elements_of(&mut document, "scenes") {
        if let Some(scene) = scene.as_object_mut() {
            scene.entry("nodes").or_insert(json!([]));
        }
    }
    for animation in elements_of(&mut document, "animations") {
        if let Some(channels) = animation.get_mut("channels").and_then(Value::as_array_mut) {
            channels.retain(|channel| channel.pointer("/target/node").is_some());
        }
    }
    Root::from_slice(document.to_string().as_bytes()).map_err(|other| {
        // The mended text has other lines, and so other places.
        let placeless = |error: &serde_json::Error| {
            let told = error.to_string();
            told.rsplit_once(" at line ").map_or(told.clone(), |(problem, _)| problem.to_owned())
        };
        let (was, is) = (placeless(&error), placeless(&other));
        format!("not glTF JSON: {}", if was == is { error.to_string() } else { is })
    })
}

fn elements_of<'a>(document: &'a mut Value, list: &str) -> impl Iterator<Item = &'a mut Value> {
    document.get_mut(list).and_then(Value::as_array_mut).into_iter().flatten()
}

/// Refuses a file that was written, or must be read, by another version than 2.0.
fn check_version(asset: &Asset) -> Result<(), Problem> {
    let version = &asset.version;
    if version.split('.').next() != Some("2") {
        return Err(format!(
            "the file is of glTF version '{version}'; umbra reads version 2: convert it"
        ));
    }
    match &asset.min_version {
        Some(least) if least != "2.0" => Err(format!(
            "the file needs a reader of glTF version '{least}'; umbra reads 2.0: export it for that"
        )),
        _ => Ok(()),
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
