//! Shadow methods and the memory limit on the command line.

mod common;

use std::fs;

use common::command::{TRIANGLE, assert_refusal, refused, run, said, umbra};
use serde_json::Value;
use tempfile::TempDir;

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("triangle.obj"), TRIANGLE).unwrap();
    folder
}

fn method_refused(arguments: &str, told: &[&str]) {
    let line = format!("render triangle.obj -o out.png {arguments}");
    refused(folder().path(), &line, told);
}

#[test]
fn combinations_that_make_no_sense_are_refused_with_the_reason_and_the_names() {
    let names = ["voxel-occlusion", "shadow-polygons", "object-cache", "cache-tree", "woo"];
    for (method, reason) in [
        ("woo+cache-tree", "woo and cache-tree are both memories"),
        ("trace+woo", "trace is the backend alone"),
        ("voxel-occlusion+voxel-occlusion", "voxel-occlusion twice"),
        ("voxel-occlusion+nothing", "there is no shadow method 'nothing'"),
    ] {
        let told: Vec<&str> = names.iter().chain([&reason]).copied().collect();
        method_refused(&format!("--shadows {method}"), &told);
    }
    for (method, reason) in [
        ("nonsense", "there is no shadow method 'nonsense'"),
        ("auto+shaft", "auto stands alone"),
        ("shaft + auto", "auto stands alone"),
    ] {
        let arguments = ["render", "triangle.obj", "-o", "out.png", "--shadows", method];
        let output = umbra(folder().path()).args(arguments).output().unwrap();
        assert_refusal(&output, &[reason, "give auto; or trace", "voxel-occlusion"]);
    }
    for command in ["compare", "tradeoff"] {
        let line = format!("{command} triangle.obj --methods trace,auto");
        let told = &["--methods", "auto chooses among the methods", "give trace, or verdicts"];
        refused(folder().path(), &line, told);
    }
    let output = run(folder().path(), "paper --quick --verdicts cache-tree");
    assert_refusal(&output, &["cache-tree is no verdict; give verdicts (shaft, "]);
    assert!(!said(&output).contains("memory"), "{}", said(&output));
    let exclude = "--shadows voxel-occlusion+woo --self-shadow exclude";
    let folder = folder();
    let output = run(folder.path(), &format!("render triangle.obj -o out.png {exclude}"));
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("voxel-occlusion+woo counts the triangle"), "{}", said(&output));
}

#[test]
fn sizes_of_memory_that_are_none_are_refused() {
    for size in ["lots", "-1", "12X", "", "M", "nan"] {
        method_refused(&format!("--memory={size}"), &["--memory", "512M"]);
    }
    let too_much = ["--memory", "no machine has so much"];
    method_refused("--memory 99999999999999999999", &too_much);
    method_refused("--memory 99999999999T", &too_much);
}

#[test]
fn statistics_say_what_each_verdict_took_and_settled() {
    let folder = folder();
    let render = |arguments: &str| -> Value {
        let line =
            format!("render chair-room -o out.png --size 40x30 --stats out.json {arguments}");
        let output = run(folder.path(), &line);
        assert!(output.status.success(), "{}", said(&output));
        let stats = fs::read(folder.path().join("out.json")).unwrap();
        serde_json::from_slice(&stats).unwrap()
    };
    let plain = render("--shadows trace");
    assert_eq!(plain["shadows"], "trace");
    assert_eq!(plain["verdicts"], Value::Array(Vec::new()));
    assert_eq!(plain["version"], env!("CARGO_PKG_VERSION"));
    let scanline =
        render("--shadows cache-tree --order scanline --retest not-cell --depth 3 --uniform");
    for (key, usual, given) in [
        ("order", "tiles".into(), "scanline".into()),
        ("depth", 5.into(), 3.into()),
        ("self_shadow", "offset".into(), "offset".into()),
        ("retest", "again".into(), "not-cell".into()),
        ("tree_depth", 10.into(), 10.into()),
        ("reset_scanlines", false.into(), false.into()),
        ("uniform", false.into(), true.into()),
        ("lazy", false.into(), false.into()),
        ("grid", Value::Null, Value::Null),
        ("memory_limit", Value::Null, Value::Null),
    ] {
        let expected: [Value; 2] = [usual, given];
        assert_eq!([&plain[key], &scanline[key]], expected.each_ref(), "{key}");
    }
    assert!((plain["tolerance"].as_f64().unwrap() - 0.05).abs() < 1e-6);
    let stats = render("--shadows shadow-polygons+voxel-occlusion+woo");
    assert_eq!(stats["shadows"], "voxel-occlusion+shadow-polygons+woo");
    let mut asked = stats["counts"]["shadows"]["queries"].as_u64().unwrap();
    let verdicts = stats["verdicts"].as_array().unwrap();
    assert_eq!(verdicts.len(), 2);
    for (verdict, name) in verdicts.iter().zip(["voxel-occlusion", "shadow-polygons"]) {
        let number = |key: &str| verdict[key].as_u64().unwrap();
        assert_eq!(verdict["verdict"], name);
        assert_eq!(number("lit") + number("blocked") + number("passed_on"), asked);
        assert!(verdict["build_seconds"].as_f64().unwrap() > 0.0 && number("bytes") > 0);
        asked = number("passed_on");
    }
    let blocked = |stats: &Value| stats["counts"]["shadows"]["blocked"].clone();
    assert_eq!(blocked(&stats), blocked(&plain));
}

#[test]
fn auto_says_who_answered_and_why_and_gives_the_same_picture() {
    let folder = folder();
    let render = |arguments: &str| {
        let line =
            format!("render chair-room -o out.png --size 80x60 --stats out.json {arguments}");
        let output = run(folder.path(), &line);
        assert!(output.status.success(), "{}", said(&output));
        let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
        let stats: Value = serde_json::from_slice(&read("out.json")).unwrap();
        (stats, read("out.png"), said(&output))
    };
    let (stats, traced, _) = render("--shadows trace");
    assert_eq!(stats["choices"].as_array().unwrap().len(), 0);
    for (arguments, shafts) in [
        ("", true),
        ("--shadows auto", true),
        ("--order scanline", true),
        ("--test pluecker", false),
        ("--self-shadow exclude", false),
    ] {
        let (stats, picture, said) = render(arguments);
        assert_eq!(stats["shadows"], "auto", "{arguments}");
        assert!(picture == traced || arguments.contains("exclude"), "{arguments}");
        let lights = stats["choices"].as_array().unwrap();
        assert_eq!(lights.len(), 4, "{arguments}");
        let mut queries = 0;
        for light in lights {
            let candidates = light["candidates"].as_array().unwrap();
            let names = candidates.iter().map(|share| share["method"].as_str().unwrap());
            assert_eq!(names.clone().any(|name| name == "shaft"), shafts, "{arguments}");
            assert!(names.clone().any(|name| name == "trace"), "{arguments}");
            for share in candidates {
                assert!(share["reason"].as_str().is_some_and(|reason| reason.contains(' ')));
                queries += share["queries"].as_u64().unwrap();
            }
        }
        assert_eq!(queries, stats["counts"]["shadows"]["queries"].as_u64().unwrap());
        assert!(said.contains("light 0:") && said.contains("ns a query"), "{said}");
    }
}

#[cfg(feature = "embree")]
#[test]
fn over_embree_auto_is_shaft_and_says_so() {
    let folder = folder();
    for (arguments, shafts) in [("", true), ("--self-shadow exclude", false)] {
        let output = run(
            folder.path(),
            &format!(
                "render chair-room -o out.png --size 80x60 --stats out.json --backend embree {arguments}"
            ),
        );
        assert!(output.status.success(), "{}", said(&output));
        let text = fs::read(folder.path().join("out.json")).unwrap();
        let stats: Value = serde_json::from_slice(&text).unwrap();
        assert_eq!(said(&output).contains("auto is shaft"), shafts, "{arguments}");
        assert_eq!(stats["verdicts"].as_array().unwrap().len() == 1, shafts, "{arguments}");
        let queries = &stats["counts"]["shadows"];
        let settled =
            queries["verdict_lit"].as_u64().unwrap() + queries["verdict_blocked"].as_u64().unwrap();
        assert_eq!(settled == queries["queries"].as_u64().unwrap(), shafts, "{arguments}");
    }
}

#[test]
fn what_the_memory_limit_makes_coarser_or_leaves_out_is_said() {
    let folder = folder();
    let render = |arguments: &str| {
        let output =
            run(folder.path(), &format!("render chair-room -o out.png --size 16x12 {arguments}"));
        assert!(output.status.success(), "{}", said(&output));
        (said(&output), fs::read(folder.path().join("out.png")).unwrap())
    };
    let (_, expected) = render("");
    for (arguments, told) in [
        ("--memory 1M", "voxels only, to keep to the memory limit"),
        ("--memory 200k --lazy", "voxels only, to keep to the memory limit"),
        ("--memory 1M --shadows voxel-occlusion", "voxel-occlusion: steps aside"),
        ("--memory 1M --shadows shadow-polygons+woo", "shadow-polygons: steps aside"),
    ] {
        let (said, picture) = render(arguments);
        assert!(said.contains(told), "{arguments}: {said}");
        assert!(picture == expected, "{arguments}");
    }
    let (said, _) = render("--memory 4G --shadows voxel-occlusion+woo");
    assert!(!said.contains("memory limit"), "{said}");
}

#[test]
fn a_limit_that_an_engine_cannot_keep_is_refused_with_one_that_it_can() {
    let folder = folder();
    for (arguments, told) in [
        ("--memory 0", "--memory 0: over this scene grid takes more; give 1M or more"),
        ("--memory 512", "(512 without a unit are bytes: did you mean 512M?)"),
        ("--memory 2.5 --backend bvh2", "over this scene bvh2 takes more; give "),
        ("--memory 100k --backend cwbvh", "--memory 100k: over this scene cwbvh takes more; give "),
    ] {
        let line = format!("render chair-room -o out.png --size 16x12 {arguments}");
        refused(folder.path(), &line, &[told]);
        let said = said(&run(folder.path(), &line));
        let is_bare = arguments.contains("512") || arguments.contains("2.5");
        assert_eq!(said.contains("did you mean"), is_bare, "{said}");
        let least = said.split("give ").nth(1).unwrap().split(' ').next().unwrap();
        let [option, _, engine @ ..] = &arguments.split(' ').collect::<Vec<_>>()[..] else {
            unreachable!("each has a limit");
        };
        let line = format!(
            "render chair-room -o out.png --size 16x12 {option} {least} {}",
            engine.join(" ")
        );
        let output = run(folder.path(), &line);
        assert!(output.status.success(), "{line}");
        fs::remove_file(folder.path().join("out.png")).unwrap();
    }
}

/// The grid grows into room that is given for a verdict, and the advice knows. What lights see is known only once they are
/// asked, so a light buffer may ask for room once more.
#[test]
fn who_follows_the_advice_has_memory_enough() {
    let folder = folder();
    for (method, tries) in [("shaft", 1), ("light-buffer", 3)] {
        let render = |limit: &str| {
            let line = format!("render chair-room -o out.png --size 32x24 --shadows {method}");
            let output = run(folder.path(), &format!("{line} --memory {limit}"));
            assert!(output.status.success(), "{}", said(&output));
            let said = said(&output);
            let advice = said.split("try --memory ").nth(1)?.split(' ').next()?;
            Some(advice.to_owned())
        };
        let mut advice = render("1M");
        assert!(advice.is_some(), "{method} asks for no more than 1M");
        for _ in 0..tries {
            advice = advice.and_then(|limit| render(&limit));
        }
        assert_eq!(advice, None, "{method}");
    }
}

#[cfg(feature = "embree")]
#[test]
fn where_shafts_step_aside_over_embree_its_own_answers_are_not_called_exact() {
    let folder = folder();
    let line = "render chair-room -o out.png --size 16x12 --backend embree --stats out.json";
    assert!(run(folder.path(), line).status.success());
    let stats = fs::read(folder.path().join("out.json")).unwrap();
    let stats: Value = serde_json::from_slice(&stats).unwrap();
    // Room for Embree and a little more, but not for shafts.
    let limit = stats["backend_bytes"].as_u64().unwrap() + (1 << 19);
    let output = run(folder.path(), &format!("{line} --memory {limit}"));
    assert!(output.status.success(), "{}", said(&output));
    let said = said(&output);
    assert!(said.contains("it steps aside") && said.contains("answers are Embree's own"), "{said}");
    assert!(!said.contains("exact;"), "{said}");
}
