//! How the cost of a shadow ray grows: with triangles, lights, samples and threads; ours beside Embree's.
//!
//! `cargo bench --bench growth -- FOLDER ROUNDS CURVE…` measures the curves named (`triangles`, `lights`, `samples`, `threads`; all
//! of them if none is), and writes each as `growth-CURVE.csv`, `.svg` and `.with-building.svg` into the folder. *Everything
//! built* is a second pass over the same queries; *building included* is preparing and the first pass: of the
//! grid for `trace`, of clusters for `shaft` and `light-buffer`, of both for `auto`, of Embree's BVH for Embree. A
//! contender that takes too long for one point is left out of those after it, and a scene that memory does not hold
//! ends its curve; both are said.
//!
//! `sharing` is no curve: it takes the time of each unit of work by itself, and says how long so many threads would take for all of them
//! together, if they did not slow each other down.

#[path = "../common/mod.rs"]
mod common;
mod curves;
mod figures;
mod sharing;

use std::path::Path;

const USAGE: &str = "cargo bench --bench growth -- FOLDER ROUNDS CURVE…, like docs 3 triangles lights samples threads sharing";

const SHARING: &str = "sharing";

fn main() {
    let arguments: Vec<String> =
        std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    let [folder, rounds, wanted @ ..] = &arguments[..] else {
        // Among all benches: it takes too long, and writes files.
        println!("growth: not measured unasked; {USAGE}");
        return;
    };
    let (folder, rounds) = (Path::new(folder), rounds.parse().expect(USAGE));
    assert!(folder.is_dir(), "there is no folder {}: {USAGE}", folder.display());
    for name in wanted {
        let is_known = name == SHARING || curves::ALL.iter().any(|curve| curve.name == name);
        assert!(is_known, "no curve {name}: {USAGE}");
    }
    for curve in &curves::ALL {
        if wanted.is_empty() || wanted.iter().any(|name| name == curve.name) {
            let points = (curve.measure)(rounds);
            figures::write(folder, curve, &points).expect("the folder can be written");
            println!("\n{}", figures::markdown(curve, &points));
        }
    }
    if wanted.iter().any(|name| name == SHARING) {
        sharing::print(rounds);
    }
}
