//! glTF files: `.glb`, and `.gltf` with buffers inside or beside it.
//!
//! Of the gltf crate only its description of the JSON is used: its accessors and its validation panic
//! on damaged files, and it reads node transforms in single precision. Images, animations and skins
//! are not read.

mod container;
mod material;
mod nodes;

use std::path::Path;

use ::gltf::json::{
    Index, Root,
    accessor::{ComponentType, Type as Dimensions},
    camera, extensions,
    mesh::{Mesh, Mode, Primitive, Semantic},
    validation::Checked,
};
use glam::{DAffine3, DVec3, Vec3};

use super::{
    Camera, Draft, DraftTriangle, Light, SceneError,
    load::{empty_draft, malformed, read_file},
    material::{Surroundings, from_extras},
    memory,
    placement::Placement,
};
use container::Container;
pub(super) use container::MAGIC;
use nodes::NodeTransforms;

/// Reads a GLB or glTF file.
pub(super) fn read(path: &Path) -> Result<Draft, SceneError> {
    let bytes = read_file(path)?;
    let mut draft = empty_draft(path);
    draft.up = Some(DVec3::Y);
    draft.choose_surroundings = true;
    Container::open(path, &bytes)
        .and_then(|container| Reader { container, draft }.read())
        .map_err(|problem| malformed(path, problem))
}

/// What is wrong, for [`SceneError::Malformed`].
type Problem = String;

/// An item that the file names by index.
fn item<'a, T>(list: &'a [T], index: usize, kind: &str) -> Result<&'a T, Problem> {
    list.get(index)
        .ok_or_else(|| format!("{kind} {index} is used, but the file has only {}", list.len()))
}

struct Reader<'a> {
    container: Container<'a>,
    draft: Draft,
}

impl Reader<'_> {
    fn read(mut self) -> Result<Draft, Problem> {
        let root = std::mem::take(&mut self.container.root);
        self.draft.files.append(&mut self.container.files);
        check_extensions(&root)?;
        self.draft.materials = root.materials.iter().map(material::material).collect();
        // What has no material is plain grey.
        self.draft.materials.push(Default::default());
        let transforms = NodeTransforms::of(self.container.json, root.nodes.len())?;
        let counts = nodes::count_triangles(&root)?;
        let scene = match (root.scene, &root.scenes[..]) {
            (Some(scene), scenes) => item(scenes, scene.value(), "scene")?,
            (None, [first, ..]) => first,
            (None, []) => return Err("the file has no scene".to_owned()),
        };
        self.read_extras(scene);
        let count = counts.below(&scene.nodes);
        memory::check(count)?;
        self.draft.triangles.reserve(count as usize);
        let mut waiting: Vec<(usize, DAffine3)> =
            scene.nodes.iter().rev().map(|n| (n.value(), DAffine3::IDENTITY)).collect();
        while let Some((index, parent)) = waiting.pop() {
            let node = item(&root.nodes, index, "node")?;
            let world = parent * transforms.local(index);
            if let Some(mesh) = node.mesh {
                self.read_mesh(&root, item(&root.meshes, mesh.value(), "mesh")?, world)?;
            }
            if let Some(index) = node.camera {
                self.read_camera(&root, index.value(), world)?;
            }
            if let Some(lights) =
                node.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref())
            {
                self.read_light(&root, lights.light.value(), world)?;
            }
            waiting.extend(node.children.iter().flatten().rev().map(|n| (n.value(), world)));
        }
        self.note_what_is_left_out(&root);
        Ok(self.draft)
    }

    /// What umbra itself wrote beside the standard fields.
    fn read_extras(&mut self, scene: &::gltf::json::Scene) {
        let Some(surroundings) = from_extras::<Surroundings>(&scene.extras) else { return };
        self.draft.ambient = surroundings.ambient.into();
        self.draft.background = surroundings.background.into();
        self.draft.exposure = surroundings.exposure;
        self.draft.choose_surroundings = false;
    }

    fn read_mesh(&mut self, root: &Root, mesh: &Mesh, world: DAffine3) -> Result<(), Problem> {
        let placement = Placement::new(world);
        for primitive in &mesh.primitives {
            if nodes::triangle_count(root, primitive)? > 0 {
                self.read_primitive(root, primitive, &placement)?;
            } else if has_triangles(mode(primitive)?) {
                self.note("a primitive has fewer than three corners: it is left out");
            }
        }
        Ok(())
    }

    fn read_primitive(
        &mut self,
        root: &Root,
        primitive: &Primitive,
        placement: &Placement,
    ) -> Result<(), Problem> {
        let vectors = |semantic: Semantic, what: &str| {
            let Some(index) = primitive.attributes.get(&Checked::Valid(semantic)) else {
                return Ok(None);
            };
            let wanted = (Dimensions::Vec3, &[ComponentType::F32][..]);
            self.container.elements(root, index.value(), wanted, what).map(Some)
        };
        let positions =
            vectors(Semantic::Positions, "positions")?.ok_or("a primitive has no positions")?;
        let normals = vectors(Semantic::Normals, "normals")?;
        let integers = [ComponentType::U8, ComponentType::U16, ComponentType::U32];
        let indices = primitive
            .indices
            .map(|index: Index<_>| {
                let wanted = (Dimensions::Scalar, &integers[..]);
                self.container.elements(root, index.value(), wanted, "indices")
            })
            .transpose()?;
        let material = match primitive.material {
            Some(index) => {
                item(&root.materials, index.value(), "material")?;
                index.value()
            }
            None => root.materials.len(),
        };
        let count = indices.as_ref().map_or(positions.count, |indices| indices.count);
        let vertex = |i| indices.as_ref().map_or(i, |indices| indices.index(i));
        for corners in corners_of(mode(primitive)?, count) {
            let corners = corners.map(vertex);
            if corners.iter().any(|&corner| corner >= positions.count) {
                self.draft.dropped.out_of_range += 1;
                continue;
            }
            let normal = |corner| match &normals {
                Some(normals) if corner < normals.count => normals.vector(corner),
                _ => Vec3::ZERO,
            };
            self.draft.triangles.push(placement.place(&DraftTriangle {
                corners: corners.map(|corner| positions.vector(corner).as_dvec3()),
                normals: corners.map(normal),
                material: material as u32,
            }));
        }
        if mode(primitive)? == Mode::Triangles && !count.is_multiple_of(3) {
            let last = if count % 3 == 1 { "the last is" } else { "the last 2 are" };
            self.note(&format!(
                "a primitive has {count} corners, not three for each triangle: {last} left out"
            ));
        }
        Ok(())
    }

    /// Takes the first perspective camera.
    fn read_camera(&mut self, root: &Root, index: usize, world: DAffine3) -> Result<(), Problem> {
        use camera::Type;
        let camera = item(&root.cameras, index, "camera")?;
        match (camera.type_, &camera.perspective) {
            (Checked::Valid(Type::Perspective), Some(perspective))
                if self.draft.camera.is_none() =>
            {
                let axes = world.matrix3;
                self.draft.camera = Some(Camera::facing(
                    world.translation,
                    -axes.z_axis,
                    axes.y_axis,
                    f64::from(perspective.yfov),
                ));
            }
            (Checked::Valid(Type::Perspective), Some(_)) => {}
            (Checked::Valid(Type::Perspective), None) => {
                return Err(format!(
                    "camera {index} is a perspective one without 'perspective'; give it 'yfov' and 'znear' there"
                ));
            }
            (Checked::Valid(Type::Orthographic), _) => {
                self.note("an orthographic camera is left out");
            }
            (Checked::Invalid, _) => {
                return Err(format!(
                    "camera {index} is of an unknown type; give 'perspective' or 'orthographic'"
                ));
            }
        }
        Ok(())
    }

    /// Takes a light of KHR_lights_punctual: it shines along -Z of its node.
    fn read_light(&mut self, root: &Root, index: usize, world: DAffine3) -> Result<(), Problem> {
        use extensions::scene::khr_lights_punctual::{Light as Lamp, Type};
        let lamps: &[Lamp] = root.as_ref();
        let lamp = item(lamps, index, "light")?;
        let backwards = world.matrix3.z_axis.normalize_or(DVec3::Z);
        let position = world.translation;
        let intensity = lamp.intensity * Vec3::from(lamp.color);
        self.draft.lights.push(match (lamp.type_, &lamp.spot) {
            (Checked::Valid(Type::Directional), _) => {
                Light::Directional { direction: backwards, irradiance: intensity }
            }
            (Checked::Valid(Type::Point), _) => Light::Point { position, intensity },
            (Checked::Valid(Type::Spot), Some(cone))
                if cone.inner_cone_angle > cone.outer_cone_angle =>
            {
                return Err(format!(
                    "light {index} has an innerConeAngle of {}, more than its outerConeAngle of {}; give less",
                    cone.inner_cone_angle, cone.outer_cone_angle
                ));
            }
            (Checked::Valid(Type::Spot), Some(cone)) => Light::Spot {
                position,
                axis: -backwards,
                intensity,
                inner: f64::from(cone.inner_cone_angle),
                outer: f64::from(cone.outer_cone_angle),
            },
            (Checked::Valid(Type::Spot), None) => {
                return Err(format!("light {index} is a spot without a cone"));
            }
            (Checked::Invalid, _) => return Err(format!("light {index} is of an unknown type")),
        });
        if lamp.range.is_some() {
            self.note("the range of lights is left out: they reach everywhere");
        }
        Ok(())
    }

    fn note(&mut self, text: &str) {
        if !self.draft.notes.iter().any(|note| note == text) {
            self.draft.notes.push(text.to_owned());
        }
    }

    fn note_what_is_left_out(&mut self, root: &Root) {
        if !root.textures.is_empty() {
            self.note("textures are left out: plain colours instead");
        }
        if !root.animations.is_empty() || !root.skins.is_empty() {
            self.note("animations and skins are left out: meshes stand as they are stored");
        }
        let masked = root.materials.iter().filter(|material| material::is_masked(material)).count();
        if masked > 0 {
            self.note(&format!("{masked} materials with a cut-out mask are solid here"));
        }
        let shapeless = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
        if shapeless.filter_map(|p| mode(p).ok()).any(|mode| !has_triangles(mode)) {
            self.note("points and lines are left out");
        }
    }
}

/// Refuses what changes the shape of things in a way we do not know.
fn check_extensions(root: &Root) -> Result<(), Problem> {
    let harmless = |name: &str| {
        ["KHR_lights_", "KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_"]
            .iter()
            .any(|prefix| name.starts_with(prefix))
    };
    match root.extensions_required.iter().find(|name| !harmless(name)) {
        Some(name) => Err(format!(
            "the file needs the glTF extension {name}, which umbra does not read; export it without"
        )),
        None => Ok(()),
    }
}

fn mode(primitive: &Primitive) -> Result<Mode, Problem> {
    match primitive.mode {
        Checked::Valid(mode) => Ok(mode),
        Checked::Invalid => Err("a primitive has an unknown mode".to_owned()),
    }
}

fn has_triangles(mode: Mode) -> bool {
    matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)
}

/// How many triangles `count` vertices make.
fn triangles_in(mode: Mode, count: usize) -> usize {
    match mode {
        Mode::Triangles => count / 3,
        Mode::TriangleStrip | Mode::TriangleFan => count.saturating_sub(2),
        _ => 0,
    }
}

/// The corners of each triangle, as places in the list of vertices.
fn corners_of(mode: Mode, count: usize) -> impl Iterator<Item = [usize; 3]> {
    (0..triangles_in(mode, count)).map(move |i| match mode {
        Mode::TriangleStrip => [i, i + 1 + i % 2, i + 2 - i % 2],
        Mode::TriangleFan => [i + 1, i + 2, 0],
        _ => [3 * i, 3 * i + 1, 3 * i + 2],
    })
}
