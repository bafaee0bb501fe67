//! `umbra scene`: a built-in scene as a file for other tools.

use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::failure::{Failure, say};
use super::numbers::finite;
use super::outputs::{Outputs, check_outputs};
use super::progress::with_word;
use crate::measure::count;
use crate::scene::{self, builtin};

const DETAILS: &str = "\
An .obj gets an .mtl of the same name beside it; a .glb holds materials, lights and camera as well. What
is there already is replaced.

Examples:
  umbra scene drum -o drum.glb
  umbra scene chair-room --tessellation 10 -o room.obj";

/// Writes a built-in scene as OBJ or GLB for other tools
#[derive(Args)]
#[command(after_help = DETAILS)]
pub(super) struct SceneFile {
    /// The scene
    #[arg(value_parser = clap::builder::PossibleValuesParser::new(builtin::NAMES))]
    name: String,
    /// The file to write: .obj or .glb
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// About how many times the triangles of the paper's scene, as far as surfaces allow: 0.01 to 100
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = finite::<f64>)]
    tessellation: f64,
    /// Writes all counts as JSON
    #[arg(long, value_name = "FILE")]
    stats: Option<PathBuf>,
}

#[derive(Serialize)]
struct Report<'a> {
    scene: &'a str,
    tessellation: f64,
    triangles: usize,
    opaque_triangles: u32,
    materials: usize,
    lights: usize,
}

impl SceneFile {
    pub fn run(self) -> Result<(), Failure> {
        let beside = match self.output.extension().and_then(|extension| extension.to_str()) {
            Some(end) if end.eq_ignore_ascii_case("obj") => Some(self.output.with_extension("mtl")),
            Some(end) if end.eq_ignore_ascii_case("glb") => None,
            _ => {
                let output = self.output.display();
                return Err(Failure::Input(format!(
                    "{output}: a scene's name must end in .obj or .glb"
                )));
            }
        };
        let outputs = [Some(&self.output), beside.as_ref(), self.stats.as_ref()];
        let outputs: Vec<&Path> = outputs.into_iter().flatten().map(PathBuf::as_path).collect();
        check_outputs(&outputs, &[])?;
        let (scene, files) = with_word(&format!("writing {}", self.name), || {
            let scene = builtin::draft_at(&self.name, self.tessellation)?.finish()?;
            let files = scene::files(&scene, &self.output)?;
            Ok::<_, scene::SceneError>((scene, files))
        })?;
        let (triangles, materials, lights) =
            (scene.triangles.len(), scene.materials.len(), scene.lights.len());
        let mut outputs = Outputs::default();
        files.into_iter().for_each(|file| outputs.push(file));
        if let Some(stats) = &self.stats {
            let report = Report {
                scene: &self.name,
                tessellation: self.tessellation,
                triangles,
                opaque_triangles: scene.triangles.opaque_count(),
                materials,
                lights,
            };
            outputs.add_json(stats, &report)?;
        }
        outputs.finish()?;
        let [triangles, materials, lights] =
            [(triangles, "triangle"), (materials, "material"), (lights, "light")]
                .map(|(number, one)| count(number as u64, one));
        say!("{}: {triangles}, {materials}, {lights}", self.name);
        Ok(())
    }
}
