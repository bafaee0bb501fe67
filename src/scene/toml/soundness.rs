//! What the fields of a description may be: numbers from which no picture can come are refused, with
//! their line and what to give, rather than rendered.

use ::toml::de::{DeTable, DeValue};
use glam::DVec3;

use Step::{Element, Key};

use super::{CameraEntry, Description, LightEntry, MeshEntry};
use crate::scene::Material;

const PLACE: &str = "give three numbers within ±3.4e38";
const BRIGHTNESS: &str = "give three numbers from 0 to 3.4e38";
const ALBEDO: &str = "give three numbers from 0 up, of which 1 is all of the light";
const SHARE: &str = "give three numbers from 0 to 1";
const APART: &str = "give a place other than that of position";

/// A step from a table to what is in it.
#[derive(Clone, Copy)]
pub(super) enum Step<'a> {
    /// To the value of a key.
    Key(&'a str),
    /// To an element of a list.
    Element(usize),
}

/// The line, counted from 1, in which the value at the end of the path begins.
pub(super) fn line(text: &str, path: &[Step]) -> usize {
    let start = place(text, path).map_or(0, |place| place.start);
    1 + text[..start].matches('\n').count()
}

/// Where in the text the value at the end of the path is.
fn place(text: &str, path: &[Step]) -> Option<std::ops::Range<usize>> {
    let root = DeValue::Table(DeTable::parse(text).ok()?.into_inner());
    let (mut value, mut place) = (&root, None);
    for step in path {
        let next = match *step {
            Key(key) => value.get(key)?,
            Element(index) => value.get(index)?,
        };
        (value, place) = (next.get_ref(), Some(next.span()));
    }
    place
}

/// One table of a description, of which fields are checked.
struct Table<'a> {
    text: &'a str,
    /// For messages; empty for the fields before all tables.
    name: String,
    path: Vec<Step<'a>>,
}

impl Table<'_> {
    /// Refuses a field that is not sound.
    fn demand(&self, field: &str, is_sound: bool, advice: &str) -> Result<(), String> {
        if is_sound {
            return Ok(());
        }
        let path: Vec<Step> = self.path.iter().copied().chain([Key(field)]).collect();
        let written = place(self.text, &path).map_or("", |place| &self.text[place]);
        let written = written.split_whitespace().collect::<Vec<_>>().join(" ");
        let (line, name) = (line(self.text, &path), &self.name);
        Err(format!("line {line}: {name}{field} = {written} makes no sense; {advice}"))
    }
}

/// Refuses a description with a field that makes no sense, with the line and what to give.
pub(super) fn check(text: &str, description: &Description) -> Result<(), String> {
    let top = Table { text, name: String::new(), path: Vec::new() };
    let exposure = description.exposure.is_none_or(|factor| factor > 0.0 && factor.is_finite());
    top.demand("exposure", exposure, "give a number above 0, or leave it out")?;
    top.demand("ambient", description.ambient.is_none_or(is_brightness), BRIGHTNESS)?;
    top.demand("background", description.background.is_none_or(is_brightness), BRIGHTNESS)?;
    top.demand(
        "up",
        description.up.is_none_or(is_direction),
        "give three numbers that are not all 0",
    )?;
    if let Some(camera) = &description.camera {
        let table = Table { text, name: "camera: ".to_owned(), path: vec![Key("camera")] };
        check_camera(&table, camera)?;
        // Where the file says nothing of it, another one is taken for a view along it.
        let view = DVec3::from(camera.target) - DVec3::from(camera.position);
        let across = |up: [f64; 3]| DVec3::from(up).normalize().cross(view.normalize()).length();
        let advice = "the camera looks along it; give another direction";
        top.demand("up", description.up.is_none_or(|up| across(up) > 1e-9), advice)?;
    }
    for (name, material) in &description.materials {
        let path = vec![Key("materials"), Key(name)];
        check_material(&Table { text, name: format!("materials.{name}: "), path }, material)?;
    }
    for (index, mesh) in description.mesh.iter().enumerate() {
        let path = vec![Key("mesh"), Element(index)];
        check_mesh(&Table { text, name: format!("mesh {}: ", index + 1), path }, mesh)?;
    }
    for (index, light) in description.light.iter().enumerate() {
        let path = vec![Key("light"), Element(index)];
        check_light(&Table { text, name: format!("light {}: ", index + 1), path }, light)?;
    }
    Ok(())
}

fn check_camera(table: &Table, camera: &CameraEntry) -> Result<(), String> {
    table.demand("position", is_place(camera.position), PLACE)?;
    table.demand("target", is_place(camera.target), PLACE)?;
    table.demand("target", are_apart(camera.position, camera.target), APART)?;
    let is_view = camera.field_of_view > 0.0 && camera.field_of_view < 180.0;
    table.demand("field_of_view", is_view, "give degrees above 0 and below 180")
}

fn check_material(table: &Table, material: &Material) -> Result<(), String> {
    table.demand("diffuse", is_brightness(material.diffuse.into()), ALBEDO)?;
    table.demand("highlight", is_brightness(material.highlight.into()), ALBEDO)?;
    table.demand("emission", is_brightness(material.emission.into()), BRIGHTNESS)?;
    table.demand("reflection", is_share(material.reflection.into()), SHARE)?;
    table.demand("transmission", is_share(material.transmission.into()), SHARE)?;
    let is_index = (1.0..=f32::MAX).contains(&material.refraction_index);
    table.demand("refraction_index", is_index, "give 1 or more")?;
    let is_exponent = material.shininess >= 0.0 && material.shininess.is_finite();
    table.demand("shininess", is_exponent, "give a number from 0 up")
}

fn check_mesh(table: &Table, mesh: &MeshEntry) -> Result<(), String> {
    table.demand("scale", is_place(mesh.scale), PLACE)?;
    table.demand("rotate", is_place(mesh.rotate), "give three numbers of degrees")?;
    table.demand("translate", is_place(mesh.translate), PLACE)
}

fn check_light(table: &Table, light: &LightEntry) -> Result<(), String> {
    match *light {
        LightEntry::Point { position, intensity } => {
            table.demand("position", is_place(position), PLACE)?;
            table.demand("intensity", is_brightness(intensity), BRIGHTNESS)
        }
        LightEntry::Spot { position, target, intensity, inner, outer } => {
            table.demand("position", is_place(position), PLACE)?;
            table.demand("target", is_place(target), PLACE)?;
            table.demand("target", are_apart(position, target), APART)?;
            table.demand("intensity", is_brightness(intensity), BRIGHTNESS)?;
            let outer_is_sound = outer > 0.0 && outer <= 180.0;
            table.demand("outer", outer_is_sound, "give degrees above 0 and up to 180")?;
            let inner_is_sound = (0.0..=outer).contains(&inner);
            table.demand("inner", inner_is_sound, "give degrees from 0 to those of outer")
        }
        LightEntry::Directional { from, irradiance } => {
            let advice = "give three numbers that are not all 0: where the light comes from";
            table.demand("from", is_direction(from), advice)?;
            table.demand("irradiance", is_brightness(irradiance), BRIGHTNESS)
        }
    }
}

/// Whether f32, in which everything is rendered, holds the coordinates.
fn is_place(place: [f64; 3]) -> bool {
    DVec3::from(place).as_vec3().is_finite()
}

/// Whether the vector has a length, so that it can be made one of length 1.
fn is_direction(vector: [f64; 3]) -> bool {
    is_place(vector) && DVec3::from(vector).try_normalize().is_some()
}

fn are_apart(position: [f64; 3], target: [f64; 3]) -> bool {
    (DVec3::from(target) - DVec3::from(position)).try_normalize().is_some()
}

fn is_brightness(colour: [f32; 3]) -> bool {
    colour.iter().all(|&channel| channel >= 0.0 && channel.is_finite())
}

fn is_share(colour: [f32; 3]) -> bool {
    colour.iter().all(|channel| (0.0..=1.0).contains(channel))
}
