//! The bytes of a glTF file: JSON and buffers; every length is checked before it is used.

use std::{
    borrow::Cow,
    path::{Path, PathBuf},
};

use ::gltf::json::{Asset, Buffer, Root};
use serde_json::{Value, json};

use super::{Problem, item};
use crate::scene::{error::advice, load::read_plain};

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
    /// The buffers, or what is wrong with each: nobody may need it.
    buffers: Vec<Result<Cow<'a, [u8]>, Problem>>,
    /// The files that hold buffers.
    pub(super) files: Vec<PathBuf>,
}

impl<'a> Container<'a> {
    pub(super) fn open(path: &Path, bytes: &'a [u8]) -> Result<Self, Problem> {
        let must_be_binary = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("glb"));
        let is_binary = must_be_binary || bytes.starts_with(MAGIC);
        let (json, blob) = if is_binary { split(bytes)? } else { (bytes, None) };
        let root = read_json(json)?;
        check_version(&root.asset)?;
        let mut files = Vec::new();
        let read = |(index, buffer): (usize, &Buffer)| {
            let bytes = match (&buffer.uri, blob) {
                (Some(uri), _) => Cow::Owned(match data_of(uri) {
                    Some(data) => decode_data(data)?,
                    None => {
                        let bytes = read_beside(path, uri, buffer.byte_length.0)?;
                        files.push(beside(path, uri));
                        bytes
                    }
                }),
                (None, Some(blob)) => Cow::Borrowed(blob),
                (None, None) if is_binary => {
                    return Err("the binary chunk (BIN) is missing".to_owned());
                }
                (None, None) => {
                    return Err(format!(
                        "buffer {index} has no 'uri', as only that of a GLB may; give the name of its file there"
                    ));
                }
            };
            if (bytes.len() as u64) < buffer.byte_length.0 {
                return Err(format!(
                    "buffer {index} is cut short: {} bytes of {}",
                    bytes.len(),
                    buffer.byte_length.0
                ));
            }
            Ok(bytes)
        };
        let buffers = root.buffers.iter().enumerate().map(read).collect();
        Ok(Self { root, json, buffers, files })
    }

    /// The bytes of a buffer that somebody needs.
    pub(super) fn buffer(&self, index: usize) -> Result<&[u8], Problem> {
        item(&self.buffers, index, "buffer")?.as_deref().map_err(Problem::clone)
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
    mend_versions(&mut document)?;
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

/// Writes as text what should be. Of another version nothing else can be told: in glTF 1.0 lists have names for numbers.
fn mend_versions(document: &mut Value) -> Result<(), Problem> {
    for version in ["version", "minVersion"] {
        let Some(version) = document.get_mut("asset").and_then(|asset| asset.get_mut(version))
        else {
            continue;
        };
        if version.is_number() {
            *version = version.to_string().into();
        }
    }
    let meshes = document.get("meshes");
    match document.pointer("/asset/version").and_then(Value::as_str) {
        Some(version) => check_written_by(version),
        // What may be missing there.
        None if meshes.is_some_and(Value::is_object) => check_written_by("1.0"),
        None => Ok(()),
    }
}

fn check_written_by(version: &str) -> Result<(), Problem> {
    if version.split('.').next() == Some("2") {
        return Ok(());
    }
    Err(format!("the file is of glTF version '{version}'; umbra reads version 2: convert it"))
}

/// Refuses a file that was written, or must be read, by another version than 2.0.
fn check_version(asset: &Asset) -> Result<(), Problem> {
    check_written_by(&asset.version)?;
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
    let there = bytes.len();
    let Some(bytes) = bytes.get(HEADER..length) else {
        return Err(match length < HEADER {
            true => wrong_length(length, there),
            false => format!("the GLB is cut short: {there} bytes of {length}"),
        });
    };
    let cut = || match length < there {
        true => wrong_length(length, there),
        false => "the GLB is cut short within a chunk".to_owned(),
    };
    let ([kind, json], rest) = chunk(bytes).ok_or_else(cut)?;
    if kind != b"JSON" {
        return Err("the first chunk of the GLB is not JSON".to_owned());
    }
    let blob = match rest {
        [] => None,
        _ => {
            let ([kind, blob], _) = chunk(rest).ok_or_else(cut)?;
            (kind == b"BIN\0").then_some(blob)
        }
    };
    Ok((json, blob))
}

/// Where the chunks of a GLB go on beyond the length in its header.
fn wrong_length(length: usize, there: usize) -> Problem {
    format!(
        "the header of the GLB says that it has {length} bytes, too few for its chunks, and {there} are there; export the file again"
    )
}

/// The kind and the content of the first chunk, and what follows it.
fn chunk(bytes: &[u8]) -> Option<([&[u8]; 2], &[u8])> {
    let (header, rest) = bytes.split_at_checked(CHUNK_HEADER)?;
    let length = u32::from_le_bytes([header[0], header[1], header[2], header[3]]) as usize;
    let (content, rest) = rest.split_at_checked(length)?;
    Some(([&header[4..], content], rest))
}

/// What a URI holds itself, if it does; schemes are written in any case.
fn data_of(uri: &str) -> Option<&str> {
    let (scheme, data) = uri.split_at_checked(DATA.len())?;
    scheme.eq_ignore_ascii_case(DATA).then_some(data)
}

/// All of a buffer inside the file.
fn decode_data(data: &str) -> Result<Vec<u8>, Problem> {
    let text =
        data.split_once(',').filter(|(kind, _)| kind.to_ascii_lowercase().ends_with(";base64"));
    let bytes = text.and_then(|(_, text)| decode_base64(text));
    bytes.ok_or_else(|| "a data URI is not in base 64; export the file again".to_owned())
}

/// The first `length` bytes of a buffer outside the file.
fn read_beside(gltf: &Path, uri: &str, length: u64) -> Result<Vec<u8>, Problem> {
    let name = decode_percent(uri);
    let shown = shortened(&name);
    if name.contains("://") {
        return Err(format!(
            "cannot read its buffer '{shown}': only files beside it and data URIs are read; save it beside the file"
        ));
    }
    read_plain(&beside(gltf, uri), length)
        .map_err(|reason| format!("cannot read its buffer '{shown}': {reason}{}", advice(&reason)))
}

/// A name for a message: its beginning, if it is long.
fn shortened(name: &str) -> Cow<'_, str> {
    const SHOWN: usize = 60;
    match name.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}...", &name[..end]).into(),
        None => name.into(),
    }
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
