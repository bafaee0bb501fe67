//! glTF files: `.glb`, and `.gltf` with buffers inside or beside it.
//!
//! Of the gltf crate only its description of the JSON is used: its accessors and its validation panic
//! on damaged files, and it reads node transforms in single precision. Images and animations are not read.

mod container;
mod elements;
mod left_out;
mod material;
mod nodes;
mod vertices;

use std::path::Path;

use ::gltf::json::{
    Index, Node, Root,
    accessor::{ComponentType, Type as Dimensions},
    camera, extensions,
    mesh::{Mode, Primitive},
    validation::Checked,
};
use glam::{DAffine3, DVec3, Vec3};

use super::{
    Camera, Draft, Light, SceneError,
    load::{empty_draft, malformed, read_file},
    material::{Surroundings, from_extras},
    memory,
};
use container::Container;
pub(super) use container::MAGIC;
use nodes::NodeTransforms;
use vertices::{Pose, Vertices};

/// Reads a GLB or glTF file.
pub(super) fn read(path: &Path) -> Result<Draft, SceneError> {
    let bytes = read_file(path)?;
    let mut draft = empty_draft(path);
    draft.up = Some(DVec3::Y);
    (draft.choose_ambient, draft.choose_background) = (true, true);
    Container::open(path, &bytes)
        .and_then(|container| Reader { container, draft, shapeless: None }.read())
        .map_err(|problem| malformed(path, problem))
}

/// What is wrong, for [`SceneError::Malformed`].
type Problem = String;

/// An item that the file names by index.
fn item<'a, T>(list: &'a [T], index: usize, kind: &str) -> Result<&'a T, Problem> {
    list.get(index)
        .ok_or_else(|| format!("{kind} {index} is used, but the file has {}", too_few(list.len())))
}

/// How many there are, where one beyond them is asked for.
fn too_few(count: usize) -> String {
    if count == 0 { "none".to_owned() } else { format!("only {count}") }
}

struct Reader<'a> {
    container: Container<'a>,
    draft: Draft,
    /// What was said of the first primitive without positions.
    shapeless: Option<String>,
}

impl Reader<'_> {
    fn read(mut self) -> Result<Draft, Problem> {
        let root = std::mem::take(&mut self.container.root);
        self.draft.files.append(&mut self.container.files);
        left_out::check_extensions(&root)?;
        self.draft.materials = root.materials.iter().map(material::material).collect();
        // What has no material is plain grey.
        self.draft.materials.push(Default::default());
        let transforms = NodeTransforms::of(self.container.json, &root)?;
        let scene = match (root.scene, &root.scenes[..]) {
            (Some(scene), scenes) => item(scenes, scene.value(), "scene")?,
            (None, [first, ..]) => first,
            (None, []) => {
                return Err(
                    "the file has no scene; give it one whose nodes are to be seen".to_owned()
                );
            }
        };
        self.read_extras(scene);
        let count = nodes::count_triangles(&root, &scene.nodes)?.below(&scene.nodes);
        memory::check(count)?;
        self.draft.triangles.reserve(count as usize);
        let mut waiting: Vec<(usize, DAffine3)> =
            scene.nodes.iter().rev().map(|n| (n.value(), DAffine3::IDENTITY)).collect();
        while let Some((index, parent)) = waiting.pop() {
            let node = item(&root.nodes, index, "node")?;
            let world = parent * transforms.local(index);
            self.read_mesh(&root, node, &transforms, world)?;
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
        if let Some(shapeless) = self.shapeless.filter(|_| count == 0) {
            return Err(format!("{shapeless}, and nothing else is there; give it 'POSITION'"));
        }
        for note in left_out::notes(&root) {
            self.draft.note(note);
        }
        Ok(self.draft)
    }

    /// What umbra itself wrote beside the standard fields.
    fn read_extras(&mut self, scene: &::gltf::json::Scene) {
        let Some(surroundings) = from_extras::<Surroundings>(&scene.extras) else { return };
        self.draft.ambient = surroundings.ambient.into();
        self.draft.background = surroundings.background.into();
        self.draft.exposure = surroundings.exposure;
        (self.draft.choose_ambient, self.draft.choose_background) = (false, false);
    }

    fn read_mesh(
        &mut self,
        root: &Root,
        node: &Node,
        transforms: &NodeTransforms,
        world: DAffine3,
    ) -> Result<(), Problem> {
        let Some(index) = node.mesh else { return Ok(()) };
        let mesh = item(&root.meshes, index.value(), "mesh")?;
        let weights = node.weights.as_ref().or(mesh.weights.as_ref());
        let pose = Pose {
            world,
            weights: weights.map_or(&[], |weights| &weights[..]),
            joints: self.joints(root, node, transforms)?,
        };
        for (place, primitive) in mesh.primitives.iter().enumerate() {
            if !nodes::has_positions(primitive) && has_triangles(mode(primitive)?) {
                let shapeless = nodes::problem_of(index.value(), place, "has no positions");
                self.draft.note(format!("{shapeless}: it is left out"));
                self.shapeless.get_or_insert(shapeless);
            } else if nodes::triangle_count(root, primitive)? > 0 {
                self.read_primitive(root, primitive, &pose)?;
            } else if has_triangles(mode(primitive)?) {
                self.draft.note("a primitive has fewer than three corners: it is left out");
            }
        }
        Ok(())
    }

    /// Where the joints of a node's skin, if it has one, take what hangs on them. They stand in the world: where the
    /// node stands does not matter.
    fn joints(
        &self,
        root: &Root,
        node: &Node,
        transforms: &NodeTransforms,
    ) -> Result<Option<Vec<DAffine3>>, Problem> {
        let Some(skin) = node.skin else { return Ok(None) };
        let skin = item(&root.skins, skin.value(), "skin")?;
        let inverses = skin.inverse_bind_matrices.map(|index| {
            let wanted = (Dimensions::Mat4, &[ComponentType::F32][..]);
            self.container.elements(root, index.value(), wanted, "inverse bind matrices")
        });
        let inverses = inverses.transpose()?;
        let joint = |(place, joint): (usize, &Index<Node>)| {
            item(&root.nodes, joint.value(), "node")?;
            let unbound = match &inverses {
                None => DAffine3::IDENTITY,
                Some(inverses) if place < inverses.count => inverses.affine(place),
                Some(inverses) => {
                    return Err(format!(
                        "a skin has {} joints, but {} inverse bind matrices; export the file again",
                        skin.joints.len(),
                        inverses.count
                    ));
                }
            };
            Ok(transforms.world(joint.value())? * unbound)
        };
        skin.joints.iter().enumerate().map(joint).collect::<Result<_, Problem>>().map(Some)
    }

    fn read_primitive(
        &mut self,
        root: &Root,
        primitive: &Primitive,
        pose: &Pose,
    ) -> Result<(), Problem> {
        let vertices = Vertices::of(&self.container, root, primitive, pose)?;
        let is_unbound = pose.joints.is_some() && !vertices.are_bound();
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
        let count = indices.as_ref().map_or(vertices.count, |indices| indices.count);
        let vertex = |i| indices.as_ref().map_or(i, |indices| indices.index(i));
        for corners in corners_of(mode(primitive)?, count) {
            let corners = corners.map(vertex);
            if corners.iter().any(|&corner| corner >= vertices.count) {
                self.draft.dropped.out_of_range += 1;
            } else {
                self.draft.triangles.push(vertices.triangle(corners, material as u32));
            }
        }
        if pose.weights.len() > primitive.targets.as_deref().unwrap_or_default().len() {
            self.draft
                .note("a mesh has more weights than morph targets: those beyond are left out");
        }
        if vertices.are_loose() {
            self.draft
                .note("corners of a skinned mesh hang on no joint: they stand where its node does");
        }
        if is_unbound {
            self.draft.note("a primitive of a skinned mesh has no joints and weights: it stands where its node does");
        }
        if mode(primitive)? == Mode::Triangles && !count.is_multiple_of(3) {
            self.draft.note(format!(
                "a primitive has {count} corners, not three for each triangle: the last {} left out",
                match count % 3 {
                    1 => "one is".to_owned(),
                    more => format!("{more} are"),
                }
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
                self.draft.note("an orthographic camera is left out");
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
            (Checked::Invalid, _) => {
                self.draft.note(format!("light {index} is of an unknown type: it is left out"));
                return Ok(());
            }
        });
        if lamp.range.is_some() {
            self.draft.note("the range of lights is left out: they reach everywhere");
        }
        Ok(())
    }
}

fn mode(primitive: &Primitive) -> Result<Mode, Problem> {
    match primitive.mode {
        Checked::Valid(mode) => Ok(mode),
        Checked::Invalid => Err("has an unknown mode; give one from 0 to 6".to_owned()),
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
