//! The node graph: transforms in f64, and a walk ahead that finds cycles and counts triangles.

use ::gltf::json::{Index, Node, Root, mesh::Primitive, mesh::Semantic, validation::Checked};
use glam::{DAffine3, DMat4, DQuat, DVec3};
use serde::Deserialize;

use super::{Problem, item, mode, triangles_in};

/// Most node placements that are walked: a graph of shared nodes grows exponentially with its depth.
const MOST_PLACEMENTS: u64 = 100_000_000;

/// The transforms of all nodes as the file writes them, in f64: the gltf crate rounds them to f32.
#[derive(Deserialize)]
pub(super) struct NodeTransforms {
    #[serde(default)]
    nodes: Vec<NodeTransform>,
    /// The first node that each is a child of.
    #[serde(skip)]
    parents: Vec<Option<usize>>,
}

#[derive(Deserialize)]
#[serde(default)]
struct NodeTransform {
    matrix: Option<[f64; 16]>,
    translation: [f64; 3],
    rotation: [f64; 4],
    scale: [f64; 3],
}

impl Default for NodeTransform {
    fn default() -> Self {
        Self {
            matrix: None,
            translation: [0.0; 3],
            rotation: [0.0, 0.0, 0.0, 1.0],
            scale: [1.0; 3],
        }
    }
}

impl NodeTransforms {
    pub(super) fn of(json: &[u8], root: &Root) -> Result<Self, Problem> {
        let mut transforms: Self =
            serde_json::from_slice(json).map_err(|e| format!("the JSON part is damaged: {e}"))?;
        debug_assert_eq!(transforms.nodes.len(), root.nodes.len());
        transforms.parents = vec![None; root.nodes.len()];
        for (node, parent) in root.nodes.iter().zip(0..) {
            for child in node.children.iter().flatten() {
                // Those that are not there are refused where children are walked.
                if let Some(first) = transforms.parents.get_mut(child.value()) {
                    first.get_or_insert(parent);
                }
            }
        }
        Ok(transforms)
    }

    /// From the node to the world, along its parents: a skin names joints wherever they stand, even where
    /// [`count_triangles`] does not come.
    pub(super) fn world(&self, node: usize) -> Result<DAffine3, Problem> {
        let (mut world, mut top) = (self.local(node), node);
        for _ in 0..self.parents.len() {
            let Some(parent) = self.parents[top] else { return Ok(world) };
            (world, top) = (self.local(parent) * world, parent);
        }
        Err(format!("node {top} is below itself"))
    }

    /// From the node to its parent.
    pub(super) fn local(&self, node: usize) -> DAffine3 {
        let transform = &self.nodes[node];
        match &transform.matrix {
            Some(columns) => DAffine3::from_mat4(DMat4::from_cols_array(columns)),
            None => {
                let rotation = DQuat::from_array(transform.rotation);
                let turn = if rotation.length_squared() > 0.0 {
                    rotation.normalize()
                } else {
                    DQuat::IDENTITY
                };
                DAffine3::from_scale_rotation_translation(
                    DVec3::from(transform.scale),
                    turn,
                    DVec3::from(transform.translation),
                )
            }
        }
    }
}

/// Triangles and placements below each node.
pub(super) struct Counts(Vec<Option<Count>>);

#[derive(Clone, Copy, Default)]
struct Count {
    triangles: u64,
    placements: u64,
}

impl Counts {
    pub(super) fn below(&self, nodes: &[Index<Node>]) -> u64 {
        nodes
            .iter()
            .filter_map(|node| self.0.get(node.value())?.as_ref())
            .map(|c| c.triangles)
            .sum()
    }
}

/// Counts what these nodes and those below them hold; refuses cycles.
pub(super) fn count_triangles(root: &Root, nodes: &[Index<Node>]) -> Result<Counts, Problem> {
    let mut counts: Vec<Option<Count>> = vec![None; root.nodes.len()];
    let mut on_path = vec![false; root.nodes.len()];
    for start in nodes.iter().map(Index::value) {
        item(&root.nodes, start, "node")?;
        let mut waiting = vec![start];
        while let Some(&node) = waiting.last() {
            let children = root.nodes[node].children.as_deref().unwrap_or_default();
            if counts[node].is_some() {
                waiting.pop();
            } else if on_path[node] {
                counts[node] = Some(count_node(root, node, &counts)?);
                on_path[node] = false;
                waiting.pop();
            } else {
                on_path[node] = true;
                for child in children.iter().map(Index::value) {
                    item(&root.nodes, child, "node")?;
                    if on_path[child] {
                        return Err(format!("node {child} is below itself"));
                    }
                    waiting.push(child);
                }
            }
        }
    }
    Ok(Counts(counts))
}

/// The node's own triangles and those of its children, which are counted already.
fn count_node(root: &Root, node: usize, counts: &[Option<Count>]) -> Result<Count, Problem> {
    let mut count = Count { triangles: 0, placements: 1 };
    if let Some(mesh) = root.nodes[node].mesh {
        for (place, primitive) in
            item(&root.meshes, mesh.value(), "mesh")?.primitives.iter().enumerate()
        {
            mode(primitive).map_err(|problem| problem_of(mesh.value(), place, &problem))?;
            let triangles = triangle_count(root, primitive)? as u64;
            count.triangles = count.triangles.saturating_add(triangles);
        }
    }
    for child in root.nodes[node].children.iter().flatten() {
        let below = counts[child.value()].unwrap_or_default();
        count.triangles = count.triangles.saturating_add(below.triangles);
        count.placements = count.placements.saturating_add(below.placements);
    }
    if count.placements > MOST_PLACEMENTS {
        return Err(format!("{} placed nodes are too many", count.placements));
    }
    Ok(count)
}

/// Whether a primitive says where its corners are.
pub(super) fn has_positions(primitive: &Primitive) -> bool {
    primitive.attributes.contains_key(&Checked::Valid(Semantic::Positions))
}

/// How many triangles the primitive is made of.
pub(super) fn triangle_count(root: &Root, primitive: &Primitive) -> Result<usize, Problem> {
    let mode = mode(primitive)?;
    let positions = primitive.attributes.get(&Checked::Valid(Semantic::Positions)).copied();
    let Some(positions) = positions else { return Ok(0) };
    let corners = primitive.indices.unwrap_or(positions);
    let corners = item(&root.accessors, corners.value(), "accessor")?.count.0;
    Ok(triangles_in(mode, corners as usize))
}

/// Says which primitive has a problem, of the mesh of that index.
pub(super) fn problem_of(mesh: usize, primitive: usize, problem: &str) -> Problem {
    format!("primitive {primitive} of mesh {mesh} {problem}")
}
