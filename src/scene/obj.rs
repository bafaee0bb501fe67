//! OBJ files.
//!
//! Read here rather than by tobj: tobj refuses a whole file for one face with an index out of range,
//! without saying where, and cuts every polygon into a fan. MTL files go through tobj (`mtl.rs`).
//!
//! Two passes over the text: the first takes the vertices, the second the faces, which may name
//! vertices that come later. Lines, points and curves are left out with a note; groups and texture coordinates are
//! skipped.

use std::{borrow::Cow, collections::HashMap, path::Path};

use glam::{DVec3, Vec3};

use super::{
    Draft, DraftTriangle, Material, SceneError,
    gltf::MAGIC as GLB_MAGIC,
    load::{empty_draft, malformed, read_file},
    material::listed,
    mtl::Libraries,
    polygon::triangulate,
    text::{before_comment, number, number_words, text_of},
};

/// Reads an OBJ file and its MTL files.
pub(super) fn read(path: &Path) -> Result<Draft, SceneError> {
    let bytes = read_file(path)?;
    if bytes.starts_with(GLB_MAGIC) {
        return Err(malformed(path, "this is no OBJ but a GLB; name it .glb"));
    }
    if let Some(place) = bytes.iter().position(|&byte| byte == 0) {
        return Err(malformed(
            path,
            format!("this is no OBJ: byte {place} is 0, so it is no text"),
        ));
    }
    let text = text_of(&bytes);
    let text = join_continued(&text);
    let mut materials = Materials::default();
    let mut draft = empty_draft(path);
    (draft.choose_ambient, draft.choose_background) = (true, true);
    let vertices = read_vertices(path, &text, &mut materials, &mut draft)?;
    read_faces(path, &text, &vertices, &mut materials, &mut draft)?;
    if !materials.undefined.is_empty() {
        draft.notes.push(format!(
            "used but defined nowhere, so plain grey: {}",
            listed(&materials.undefined)
        ));
    }
    draft.materials = materials.list;
    Ok(draft)
}

#[derive(Default)]
struct Vertices {
    positions: Vec<DVec3>,
    normals: Vec<Vec3>,
}

#[derive(Default)]
struct Materials {
    list: Vec<Material>,
    by_name: HashMap<String, u32>,
    /// The names that go on after a `#`, by what stands before it; none where there are several.
    by_name_before_comment: HashMap<String, Option<String>>,
    undefined: Vec<String>,
}

impl Materials {
    fn add(&mut self, material: Material) -> u32 {
        let index = self.list.len() as u32;
        self.by_name.insert(material.name.clone(), index);
        self.list.push(material);
        index
    }

    /// Adds what an MTL file defines.
    fn define(&mut self, material: Material) {
        let (name, short) = (&material.name, before_comment(&material.name));
        if short != name {
            let meant = self.by_name_before_comment.entry(short.to_owned());
            let meant = meant.or_insert_with(|| Some(name.clone()));
            if meant.as_ref() != Some(name) {
                *meant = None;
            }
        }
        self.add(material);
    }

    /// The material of that name, made plain grey if there is none.
    ///
    /// Nothing tells a comment after a name from the `#` of names such as `Material #25`: so names are
    /// looked for as they stand, then without what may be a comment, here or where they are defined; on both sides only where
    /// white space follows the `#`, lest `Material #26` be `Material #25`.
    fn named(&mut self, name: &str) -> u32 {
        let short = before_comment(name);
        let after = name[short.len()..].trim_start().strip_prefix('#').unwrap_or_default();
        let is_number = after.starts_with(|first: char| !first.is_whitespace());
        let commented = || {
            let defined = self.by_name_before_comment.get(short).filter(|_| !is_number);
            self.by_name.get(defined?.as_ref()?)
        };
        let shortened =
            || if short.is_empty() { None } else { self.by_name.get(short).or_else(commented) };
        let found = self.by_name.get(name).or_else(shortened);
        found.copied().unwrap_or_else(|| {
            self.undefined.push(name.to_owned());
            self.add(Material { name: name.to_owned(), ..Material::default() })
        })
    }
}

/// Joins each line that ends in `\` with the next one. Blank lines follow, as many as went, so that those
/// below keep their numbers. A comment goes no further than its line.
fn join_continued(text: &str) -> Cow<'_, str> {
    if !text.contains('\\') {
        return Cow::Borrowed(text);
    }
    let mut joined = String::with_capacity(text.len());
    let mut gone = 0;
    for line in text.lines() {
        let is_comment = gone == 0 && line.trim_start().starts_with('#');
        match line.trim_end().strip_suffix('\\') {
            Some(part) if !is_comment => {
                joined.extend([part, " "]);
                gone += 1;
            }
            _ => {
                joined.push_str(line);
                joined.extend(std::iter::repeat_n('\n', gone + 1));
                gone = 0;
            }
        }
    }
    Cow::Owned(joined)
}

/// Keyword and rest of each line that is not a comment, with its number from 1.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str, &str)> {
    text.lines().enumerate().filter_map(|(index, line)| {
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        (!keyword.is_empty() && !keyword.starts_with('#')).then_some((
            index + 1,
            keyword,
            rest.trim_start(),
        ))
    })
}

fn read_vertices(
    path: &Path,
    text: &str,
    materials: &mut Materials,
    draft: &mut Draft,
) -> Result<Vertices, SceneError> {
    let mut vertices = Vertices::default();
    let mut libraries = Libraries::of(path);
    for (line, keyword, rest) in lines(text) {
        let vector = || {
            let mut words = number_words(rest).map(number);
            let mut coordinate = || words.next().flatten();
            Some(DVec3::new(coordinate()?, coordinate()?, coordinate()?))
        };
        match keyword {
            "v" => {
                // A fourth number alone is a weight.
                if number_words(rest).nth(5).is_some() {
                    draft.note("the colours of vertices are left out: those of materials instead");
                }
                vertices.positions.push(vector().ok_or_else(|| {
                    malformed(
                        path,
                        format!("line {line}: three numbers must follow '{keyword}', not '{rest}'"),
                    )
                })?);
            }
            // A surface does well without its normals, but not without its corners.
            "vn" => vertices.normals.push(vector().map_or(Vec3::NAN, |normal| normal.as_vec3())),
            "mtllib" => {
                for material in libraries.read(rest, draft) {
                    materials.define(material);
                }
            }
            _ => {}
        }
    }
    Ok(vertices)
}

fn read_faces(
    path: &Path,
    text: &str,
    vertices: &Vertices,
    materials: &mut Materials,
    draft: &mut Draft,
) -> Result<(), SceneError> {
    let mut seen = Seen { positions: 0, normals: 0 };
    let (mut material, mut plain) = (None, None);
    let (mut corners, mut positions) = (Vec::new(), Vec::new());
    for (number, keyword, rest) in lines(text) {
        match keyword {
            "v" => seen.positions += 1,
            "vn" => seen.normals += 1,
            "usemtl" if rest.is_empty() => material = None,
            "usemtl" => material = Some(materials.named(rest.trim_end())),
            // What `f` was called once.
            "f" | "fo" => {
                corners.clear();
                for word in number_words(rest) {
                    corners.push(
                        seen.corner(word, vertices).map_err(|problem| {
                            malformed(path, format!("line {number}: {problem}"))
                        })?,
                    );
                }
                let material = material.unwrap_or_else(|| {
                    *plain.get_or_insert_with(|| materials.add(Material::default()))
                });
                positions.clear();
                positions.extend(corners.iter().map_while(|corner| corner.position));
                if corners.iter().any(|corner| corner.is_normal_lost) {
                    draft.note("faces with a normal whose index is out of range are flat");
                }
                if corners.iter().any(|corner| !corner.normal.is_finite()) {
                    draft.note("faces with a normal that is not three finite numbers are flat");
                }
                if positions.len() < corners.len() {
                    draft.dropped.out_of_range += 1;
                } else if !positions.iter().all(|position| position.is_finite()) {
                    draft.dropped.not_finite += 1;
                } else if positions.len() < 3 {
                    draft.dropped.zero_area += 1;
                } else {
                    draft.triangles.extend(triangulate(&positions).into_iter().map(|triangle| {
                        DraftTriangle {
                            corners: triangle.map(|i| positions[i]),
                            normals: triangle.map(|i| corners[i].normal),
                            material,
                        }
                    }));
                }
            }
            "l" | "p" => draft.note("points and lines are left out"),
            "curv" | "curv2" | "surf" | "bzp" | "bsp" | "cdc" | "cdp" => {
                draft.note("curves and free-form surfaces are left out");
            }
            "call" => draft.note("what is in the files that 'call' names is left out"),
            _ => {}
        }
    }
    Ok(())
}

/// How many vertices came before the line at hand: relative indices count back from there.
struct Seen {
    positions: usize,
    normals: usize,
}

/// A corner of a face; no position if its index is out of range.
struct Corner {
    position: Option<DVec3>,
    normal: Vec3,
    /// Whether the index of its normal is out of range.
    is_normal_lost: bool,
}

impl Seen {
    /// Reads `position`, `position/texture`, `position//normal` or `position/texture/normal`.
    fn corner(&self, word: &str, vertices: &Vertices) -> Result<Corner, String> {
        let mut parts = word.split('/').map(|part| {
            part.parse::<i64>().map_err(|_| format!("'{word}' is not a corner of a face"))
        });
        let position = parts.next().expect("split gives at least one part")?;
        let index = match word.split('/').nth(2) {
            None | Some("") => None,
            Some(_) => parts.nth(1).transpose()?,
        };
        let normal = index.and_then(|index| at(&vertices.normals, index, self.normals));
        Ok(Corner {
            position: at(&vertices.positions, position, self.positions),
            normal: normal.unwrap_or(Vec3::ZERO),
            is_normal_lost: index.is_some() && normal.is_none(),
        })
    }
}

/// What the index names: from 1 upwards counts from the start, from -1 downwards back from `seen`.
fn at<T: Copy>(list: &[T], index: i64, seen: usize) -> Option<T> {
    let index = match index {
        0 => return None,
        1.. => index - 1,
        _ => seen as i64 + index,
    };
    list.get(usize::try_from(index).ok()?).copied()
}
