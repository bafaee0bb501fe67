//! The vertices of a primitive: as stored, moved by morph targets and by the joints of a skin.

use ::gltf::json::{
    Index, Root,
    accessor::{Accessor, ComponentType, Type as Dimensions},
    mesh::{Primitive, Semantic},
    validation::Checked,
};
use glam::{DAffine3, DMat3, DVec3, Vec3};

use super::{Problem, container::Container, elements::Elements, left_out::QUANTIZED, too_few};
use crate::scene::{DraftTriangle, placement::Placement};
use crate::words::counted;

/// What vectors are made of: f32, and with KHR_mesh_quantization short integers, too.
const VECTOR_KINDS: [ComponentType; 5] = [
    ComponentType::F32,
    ComponentType::I8,
    ComponentType::U8,
    ComponentType::I16,
    ComponentType::U16,
];

/// How the vertices of a mesh come into the world.
pub(super) struct Pose<'a> {
    /// From its node.
    pub(super) world: DAffine3,
    /// How much of each morph target is added.
    pub(super) weights: &'a [f32],
    /// Where each joint of its skin takes what hangs on it.
    pub(super) joints: Option<Vec<DAffine3>>,
}

/// The vertices of one primitive in their pose.
pub(super) struct Vertices<'a> {
    pub(super) count: usize,
    positions: Elements<'a>,
    normals: Option<Elements<'a>>,
    /// What is added to positions and to normals, and how much of it.
    targets: Vec<(f64, [Option<Elements<'a>>; 2])>,
    /// On which joints each vertex hangs, and by how much: four in each set.
    bonds: Vec<[Elements<'a>; 2]>,
    pose: &'a Pose<'a>,
    /// The pose of whatever hangs on no joint.
    placement: Placement,
}

impl<'a> Vertices<'a> {
    pub(super) fn of(
        container: &'a Container,
        root: &Root,
        primitive: &Primitive,
        pose: &'a Pose,
    ) -> Result<Self, Problem> {
        let read = |index: Index<Accessor>, dimensions, kinds: &[ComponentType], what: &str| {
            container.elements(root, index.value(), (dimensions, kinds), what)
        };
        let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).copied();
        let is_quantized = root.extensions_used.iter().any(|name| name == QUANTIZED);
        let numbers = &VECTOR_KINDS[..if is_quantized { VECTOR_KINDS.len() } else { 1 }];
        let vectors = |index: Option<Index<Accessor>>, what: &str| {
            index.map(|at| read(at, Dimensions::Vec3, numbers, what)).transpose()
        };
        let positions = vectors(attribute(Semantic::Positions), "positions")?
            .ok_or("a primitive has no positions")?;
        let normals = vectors(attribute(Semantic::Normals), "normals")?;
        let count = positions.count;
        let for_all = |elements: &Elements, what: &str| match elements.count < count {
            true => Err(format!(
                "a primitive has {count} positions, but {} {what}; export the file again",
                elements.count
            )),
            false => Ok(()),
        };

        let mut targets = Vec::new();
        let stored = primitive.targets.as_deref().unwrap_or_default();
        // Without any, all are 0.
        if !pose.weights.is_empty() && pose.weights.len() < stored.len() {
            return Err(format!(
                "a mesh has {} for {}; give one for each",
                counted(pose.weights.len() as u64, "weight"),
                counted(stored.len() as u64, "morph target")
            ));
        }
        for (&weight, target) in pose.weights.iter().zip(stored) {
            if weight == 0.0 {
                continue;
            }
            let moved = [
                vectors(target.positions, "morph target")?,
                vectors(target.normals, "morph target")?,
            ];
            moved.iter().flatten().try_for_each(|moved| for_all(moved, "in a morph target"))?;
            targets.push((f64::from(weight), moved));
        }

        let mut bonds = Vec::new();
        if let Some(joints) = &pose.joints {
            let (integers, shares) = (
                [ComponentType::U8, ComponentType::U16],
                [ComponentType::F32, ComponentType::U8, ComponentType::U16],
            );
            for set in 0.. {
                let (Some(places), Some(weights)) =
                    (attribute(Semantic::Joints(set)), attribute(Semantic::Weights(set)))
                else {
                    break;
                };
                let places = read(places, Dimensions::Vec4, &integers, "joints")?;
                let weights = read(weights, Dimensions::Vec4, &shares, "weights")?;
                for_all(&places, "with joints")?;
                for_all(&weights, "with weights")?;
                let beyond = (0..count)
                    .flat_map(|vertex| [0, 1, 2, 3].map(|at| places.integer(vertex, at)))
                    .find(|&joint| joint >= joints.len());
                if let Some(joint) = beyond {
                    return Err(format!(
                        "joint {joint} is used, but the skin has {}",
                        too_few(joints.len())
                    ));
                }
                bonds.push([places, weights]);
            }
        }
        let placement = Placement::new(pose.world);
        Ok(Self { count, positions, normals, targets, bonds, pose, placement })
    }

    /// Whether they hang on joints.
    pub(super) fn are_bound(&self) -> bool {
        !self.bonds.is_empty()
    }

    /// Whether some of them hang on joints by nothing.
    pub(super) fn are_loose(&self) -> bool {
        self.are_bound() && (0..self.count).any(|vertex| self.hold(vertex) == 0.0)
    }

    /// By how much a vertex hangs on joints altogether: 1 but for rounding, if the file is sound.
    fn hold(&self, vertex: usize) -> f64 {
        let shares = |weights: &Elements| [0, 1, 2, 3].map(|at| weights.share(vertex, at));
        self.bonds.iter().flat_map(|[_, weights]| shares(weights)).sum()
    }

    /// The triangle of three of them in the world.
    pub(super) fn triangle(&self, corners: [usize; 3], material: u32) -> DraftTriangle {
        let stored = DraftTriangle {
            corners: corners.map(|vertex| self.position(vertex)),
            normals: corners.map(|vertex| self.normal(vertex)),
            material,
        };
        match &self.pose.joints {
            Some(joints) if self.are_bound() => {
                let placements = corners.map(|vertex| Placement::new(self.bond(vertex, joints)));
                Placement::place_each(&placements, &stored)
            }
            _ => self.placement.place(&stored),
        }
    }

    fn position(&self, vertex: usize) -> DVec3 {
        let moved = |(weight, [by, _]): &(f64, [Option<Elements>; 2])| {
            by.as_ref().map(|by| *weight * by.vector(vertex).as_dvec3())
        };
        let stored = self.positions.vector(vertex).as_dvec3();
        self.targets.iter().filter_map(moved).fold(stored, |sum, by| sum + by)
    }

    /// Its normal, or zero.
    fn normal(&self, vertex: usize) -> Vec3 {
        let stored = match &self.normals {
            Some(normals) if vertex < normals.count => normals.vector(vertex),
            _ => return Vec3::ZERO,
        };
        let turned = |(weight, [_, by]): &(f64, [Option<Elements>; 2])| {
            by.as_ref().map(|by| *weight as f32 * by.vector(vertex))
        };
        let mut turned = self.targets.iter().filter_map(turned).peekable();
        match turned.peek() {
            None => stored,
            Some(_) => turned.fold(stored, |sum, by| sum + by).normalize_or_zero(),
        }
    }

    /// The mean of where its joints take it; where it hangs on none, where its node does.
    fn bond(&self, vertex: usize, joints: &[DAffine3]) -> DAffine3 {
        let whole = self.hold(vertex);
        if whole == 0.0 {
            return self.pose.world;
        }
        let mut mean = DAffine3 { matrix3: DMat3::ZERO, translation: DVec3::ZERO };
        for [places, weights] in &self.bonds {
            for at in 0..4 {
                let (joint, weight) =
                    (joints[places.integer(vertex, at)], weights.share(vertex, at));
                mean.matrix3 += weight * joint.matrix3;
                mean.translation += weight * joint.translation;
            }
        }
        // Weights are rounded: they may not add up to 1.
        DAffine3 { matrix3: mean.matrix3 * whole.recip(), translation: mean.translation / whole }
    }
}
