//! MTL files, read by tobj.
//!
//! tobj refuses a whole MTL file for one bad line and panics on a colour of fewer than three numbers,
//! so it is given only the lines that we use and that are sound.

use std::{
    collections::{HashMap, HashSet},
    path::{Path, PathBuf},
};

use glam::Vec3;

use super::{
    Draft, Material,
    load::read_plain,
    material::listed,
    text::{UTF_16, before_comment, is_utf_16, number, number_words, text_of, without_mark},
};

/// The MTL files that an OBJ file names. Each is read once, however often it is named.
pub(super) struct Libraries<'a> {
    folder: &'a Path,
    /// Whether there is such a file, of those that were looked for.
    is_there: HashMap<PathBuf, bool>,
    /// The names that are noted as missing.
    missing: HashSet<String>,
}

impl<'a> Libraries<'a> {
    pub(super) fn of(obj: &'a Path) -> Self {
        let folder = obj.parent().unwrap_or(Path::new(""));
        Self { folder, is_there: HashMap::new(), missing: HashSet::new() }
    }

    /// Reads what an `mtllib` line names: one file, whose name may hold spaces, or several, before a
    /// comment perhaps. Those that were read and those that are missing are noted in the draft.
    pub(super) fn read(&mut self, names: &str, draft: &mut Draft) -> Vec<Material> {
        let mut materials = Vec::new();
        let uncommented = before_comment(names);
        if [names, uncommented].iter().any(|name| self.open(name, &mut materials, draft)) {
            return materials;
        }
        for name in uncommented.split_whitespace() {
            if !self.open(name, &mut materials, draft) && self.missing.insert(name.to_owned()) {
                let note = format!("material file '{name}' cannot be read: plain grey instead");
                draft.notes.push(note);
            }
        }
        materials
    }

    /// Adds the materials of a file, unless it was read before; whether there is such a file.
    fn open(&mut self, name: &str, materials: &mut Vec<Material>, draft: &mut Draft) -> bool {
        let path = self.folder.join(name.replace('\\', "/"));
        if let Some(&is_there) = self.is_there.get(&path) {
            return is_there;
        }
        let bytes = read_plain(&path, u64::MAX).ok().map(without_mark);
        self.is_there.insert(path.clone(), bytes.is_some());
        let Some(bytes) = bytes else { return false };
        draft.files.push(path);
        if is_utf_16(&bytes) {
            draft.notes.push(format!("material file '{name}': {UTF_16}"));
            return true;
        }
        materials.extend(parse(name, &text_of(&bytes), draft));
        true
    }
}

/// The materials of a text. Lines that we use but cannot read are noted, all in one note.
fn parse(name: &str, text: &str, draft: &mut Draft) -> Vec<Material> {
    let (mut sound, mut unread) = (String::new(), Vec::new());
    for (number, line) in (1..).zip(text.lines()) {
        if line.trim_start().starts_with("map_") {
            draft.note("textures are left out: plain colours instead");
        }
        match sound_line(line) {
            Ok(line) => sound.push_str(&line),
            Err(problem) => unread.push(format!("line {number}: {problem}")),
        }
    }
    if let [first, others @ ..] = &unread[..] {
        let more = match others.len() {
            0 => String::new(),
            1 => ", and so is 1 other line".to_owned(),
            count => format!(", and so are {count} other lines"),
        };
        draft.notes.push(format!("material file '{name}', {first}; it is left out{more}"));
    }
    // Nothing is left in the text that tobj could refuse; if it does, all is plain grey.
    let (materials, _) = tobj::load_mtl_buf(&mut sound.as_bytes()).unwrap_or_default();
    let some = |is_one: fn(&tobj::Material) -> bool| materials.iter().any(is_one);
    if some(|mtl| mtl.dissolve_texture.is_some()) {
        draft.note("what a texture cuts out (map_d) is solid here");
    }
    if some(glows_by_texture) {
        draft.note("what glows by a texture (map_Ke) is dark here");
    }
    if some(|mtl| {
        mtl.illumination_model == Some(GLASS) && opacity(mtl) == 1.0 && filter(mtl).is_some()
    }) {
        draft.note("'Tf' is left out beside 'illum 4', as programs differ in what it means: give 'd' for glass");
    }
    let solid: Vec<String> =
        materials.iter().filter(|mtl| is_solid_by_tr(mtl)).map(|mtl| mtl.name.clone()).collect();
    if !solid.is_empty() {
        draft.note(format!(
            "opaque, for 'Tr' of 1 or more without 'd' is written for what is solid, too: {}; write 'd 0' for what is invisible",
            listed(&solid)
        ));
    }
    materials.iter().map(material).collect()
}

/// The line as tobj is to see it: empty unless it is one of those we use. Else what is wrong with it.
fn sound_line(line: &str) -> Result<String, String> {
    let line = line.trim();
    let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    let wrong =
        |wanted: &str| format!("'{line}' should be '{keyword}' and {wanted} within ±3.4e38");
    let numbers = |wanted: &str| {
        // Materials are in f32.
        let is_held = |number: &f64| (*number as f32).is_finite();
        let numbers: Option<Vec<f64>> =
            number_words(rest).map(|word| number(word).filter(is_held)).collect();
        numbers.filter(|numbers| !numbers.is_empty()).ok_or_else(|| wrong(wanted))
    };
    Ok(match keyword {
        "newmtl" if rest.trim().is_empty() => return Err("'newmtl' has no name".to_owned()),
        "newmtl" => format!("newmtl {}\n", rest.trim()),
        "Kd" | "Ks" | "Ke" | "Tf" => match numbers("three numbers")?[..] {
            [red, green, blue, ..] => format!("{keyword} {red} {green} {blue}\n"),
            // One number stands for all three channels.
            [grey] => format!("{keyword} {grey} {grey} {grey}\n"),
            _ => return Err(wrong("three numbers")),
        },
        "Ns" | "Ni" | "d" | "Tr" => format!("{keyword} {}\n", numbers("a number")?[0]),
        "illum" => format!("illum {}\n", numbers("a number")?[0] as u8),
        "map_d" | "map_Ke" => format!("{keyword} {UNREAD}\n"),
        _ => String::new(),
    })
}

/// The illumination model of glass.
const GLASS: u8 = 4;

/// Illumination models that reflect: 3 mirror, 4 glass, 5 Fresnel, 6 and 7 refraction, 8 and 9 as 3
/// and 4 without ray tracing.
fn reflects(model: u8) -> bool {
    (3..=9).contains(&model)
}

/// What stands for the name of a texture.
const UNREAD: &str = "unread";

/// Whether it shines, and a texture says where.
fn glows_by_texture(mtl: &tobj::Material) -> bool {
    mtl.unknown_param.contains_key("map_Ke")
        && mtl.emissive.is_some_and(|emission| emission != [0.0; 3])
}

/// What `Tr` says.
fn transparency(mtl: &tobj::Material) -> Option<f64> {
    mtl.unknown_param.get("Tr")?.parse().ok()
}

/// Whether it would be invisible by `Tr` alone. Programs that take it for opacity write that for whatever is solid, and
/// hardly anybody writes surfaces that are not to be seen.
fn is_solid_by_tr(mtl: &tobj::Material) -> bool {
    mtl.dissolve.is_none() && transparency(mtl).is_some_and(|transparency| transparency >= 1.0)
}

fn opacity(mtl: &tobj::Material) -> f32 {
    let transparency = transparency(mtl).filter(|_| !is_solid_by_tr(mtl));
    let opacity = mtl.dissolve.or(transparency.map(|t| 1.0 - t)).unwrap_or(1.0);
    opacity.clamp(0.0, 1.0) as f32
}

/// The share of light that passes, by its colour.
fn filter(mtl: &tobj::Material) -> Option<Vec3> {
    let mut channels = mtl.unknown_param.get("Tf")?.split_whitespace().map(str::parse);
    let mut channel = || channels.next()?.ok();
    let filter = Vec3::new(channel()?, channel()?, channel()?);
    Some(filter.max(Vec3::ZERO).min(Vec3::ONE))
}

fn material(mtl: &tobj::Material) -> Material {
    let plain = Material::default();
    let colour = |value: Option<[f64; 3]>| value.map(|[r, g, b]| glam::dvec3(r, g, b).as_vec3());
    let share = |value: Vec3| value.max(Vec3::ZERO).min(Vec3::ONE);
    let model = mtl.illumination_model.unwrap_or(2);
    let specular = share(colour(mtl.specular).unwrap_or(Vec3::ZERO));
    let opacity = opacity(mtl);
    // A filter is what a refracting surface lets through; without `d` it alone says how much.
    let filter = filter(mtl).filter(|filter| matches!(model, 6 | 7) && *filter != Vec3::ZERO);
    let (diffused, passed) = match filter {
        Some(filter) if opacity == 1.0 => (1.0 - filter, filter),
        _ => (Vec3::splat(opacity), filter.unwrap_or(Vec3::ONE) * (1.0 - opacity)),
    };
    let refracts = matches!(model, 6 | 7) && passed != Vec3::ZERO;
    Material {
        name: mtl.name.clone(),
        diffuse: diffused * share(colour(mtl.diffuse).unwrap_or(plain.diffuse)),
        reflection: if reflects(model) { specular } else { Vec3::ZERO },
        transmission: passed,
        refraction_index: match mtl.optical_density {
            Some(index) if refracts && index >= 1.0 => index as f32,
            _ => 1.0,
        },
        highlight: if model == 2 { specular } else { Vec3::ZERO },
        shininess: mtl.shininess.map_or(plain.shininess, |exponent| exponent.max(1.0) as f32),
        emission: match glows_by_texture(mtl) {
            true => Vec3::ZERO,
            false => colour(mtl.emissive).unwrap_or(Vec3::ZERO).max(Vec3::ZERO),
        },
    }
}
