//! A square between a light and the ground: which points lie in its shadow?

use std::process::ExitCode;

use embree_ffi::{Device, DeviceConfig, Error, Mesh, Ray, SceneBuilder, SceneOptions};

fn main() -> ExitCode {
    match draw() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn draw() -> Result<(), Error> {
    let device = Device::new(DeviceConfig::default())?;
    println!("Embree {} from {}", device.library().version(), device.library().path().display());

    let corners = [[-1.0, 1.0, -1.0], [1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]];
    let mut builder = SceneBuilder::new(&device, SceneOptions::default().robust(true))?;
    builder.add(Mesh::new(&corners, &[[0, 1, 2], [0, 2, 3]]))?;
    let scene = builder.commit()?;
    println!("{} bytes", device.memory_used());

    let light = [0.3, 3.0, 0.1];
    for row in -8..=8 {
        let shadow = |column: i32| {
            let point = [column as f32 * 0.17, 0.0, row as f32 * 0.23];
            if scene.occluded(&Ray::between(point, light)) { '#' } else { '.' }
        };
        println!("{}", (-16..=16).map(shadow).collect::<String>());
    }
    Ok(())
}
