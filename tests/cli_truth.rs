//! `umbra certify` and `umbra extremes`, run as a user runs them.

mod common;

use std::fs;

use common::command::{refused, run, said};

#[test]
fn certify_counts_every_query_of_the_classes_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(
        folder.path(),
        "certify --queries 3000 --classes sliver,grazing --threads 1 --stats certified.json",
    );
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let table = String::from_utf8(output.stdout).unwrap();
    assert!(table.contains("sliver") && table.contains("grazing") && !table.contains("lattice"));
    let text = fs::read_to_string(folder.path().join("certified.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["classes"].as_array().unwrap().len(), 2);
    let all = &json["all"];
    let number = |name: &str| all[name].as_u64().unwrap();
    assert_eq!(number("queries"), 6000);
    assert_eq!(number("blocked") + number("clear") + number("ties"), 6000);
    assert_eq!(number("by_filter") + number("by_double") + number("by_expansion"), 6000);
    assert_eq!((number("by_oracle"), number("wrong")), (60, 0));
}

#[test]
fn certify_stops_when_its_time_is_over() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(folder.path(), "certify --queries 1000000000000 --seconds 1 --stats s.json");
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let text = fs::read_to_string(folder.path().join("s.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let queries = json["all"]["queries"].as_u64().unwrap();
    assert!((1..1_000_000_000_000).contains(&queries), "{queries}");
}

#[test]
fn the_time_that_certify_takes_does_not_grow_with_the_queries_it_may_put() {
    let folder = tempfile::tempdir().unwrap();
    let line = format!("certify --queries {} --classes grazing --seconds 1", u64::MAX);
    let start = std::time::Instant::now();
    let output = run(folder.path(), &line);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let seconds = start.elapsed().as_secs();
    assert!(seconds < 60, "{seconds} s");
}

#[test]
fn extremes_prints_a_line_a_case_and_writes_every_engine_and_test() {
    let folder = tempfile::tempdir().unwrap();
    let line =
        "extremes --queries 200 --cases at-edges,signed-zero --backends grid,cwbvh --stats s.json";
    let output = run(folder.path(), line);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    assert_eq!(String::from_utf8(output.stdout).unwrap().lines().count(), 3);
    let text = fs::read_to_string(folder.path().join("s.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let cases = json["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 2);
    for case in cases {
        let answers = case["answers"].as_array().unwrap();
        assert_eq!(answers.len(), 2 * 4, "two engines, four tests");
        assert!(answers.iter().all(|answers| answers["unlike_brute"] == 0));
        assert_eq!(case["rays"], 200);
    }
}

#[cfg(feature = "embree")]
#[test]
fn extremes_says_whom_it_leaves_out() {
    let folder = tempfile::tempdir().unwrap();
    let line = "extremes --queries 10 --cases grazing --backends grid,embree --tests watertight";
    let output = run(folder.path(), line);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let told = "left out: embree watertight: embree has no test 'watertight'";
    assert!(said(&output).contains(told), "{}", said(&output));
    let output = run(folder.path(), "extremes --queries 10 --cases grazing --backends embree");
    assert!(!said(&output).contains("left out"), "{}", said(&output));
}

#[test]
fn what_makes_no_sense_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refuse = |line: &str, told: &[&str]| refused(folder.path(), line, told);
    refuse("certify --queries 0", &["--queries", "at least 1"]);
    refuse("certify --seconds 0", &["--seconds", "at least 1"]);
    refuse("certify --classes silver", &["silver", "sliver"]);
    refuse("certify --threads 0", &["--threads", "1 to 1024"]);
    refuse("certify --stats nowhere/s.json", &["nowhere"]);
    refuse("extremes --queries 0", &["--queries", "at least 1"]);
    let nobody = "extremes --queries 10 --cases grazing --backends embree --tests exact";
    refuse(nobody, &["nothing to test", "embree has no test 'exact'"]);
    refuse("extremes --cases at-corners", &["at-corners", "at-vertices"]);
    refuse("extremes --stats nowhere/s.json", &["nowhere"]);
}
