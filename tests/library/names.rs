//! Names.

use std::fmt::{Debug, Display};
use std::str::FromStr;

use clap::ValueEnum;
use serde::Serialize;
use umbra::exact::Verdict;
use umbra::occlusion::{Backend, Test};
use umbra::render::Order;
use umbra::shadow::{Combination, Method, Outcome};

fn read_back<T>(all: &[T])
where
    T: Copy + Debug + Display + PartialEq + FromStr<Err: Debug> + Serialize,
{
    for one in all {
        assert_eq!(one.to_string().parse::<T>().unwrap(), *one);
        assert_eq!(serde_json::to_value(one).unwrap(), one.to_string());
    }
}

#[test]
fn names_read_back_and_others_are_refused_with_those_there_are() {
    read_back(&Backend::ALL);
    read_back(&Test::ALL);
    read_back(&Order::ALL);
    let combinations = ["trace", "shaft", "shaft+light-buffer+cache-tree-tolerance"];
    read_back(&combinations.map(|name| name.parse::<Combination>().unwrap()));
    let refused = "octree".parse::<Backend>().unwrap_err().to_string();
    assert_eq!(
        refused,
        "there is no engine 'octree'; give one of grid, embree, bvh2, cwbvh, brute"
    );
}

/// Options take the names that messages and statistics print, in their order.
fn taken_as_printed<T: Display + ValueEnum>(all: &[T]) {
    let taken = T::value_variants().iter().map(|one| one.to_possible_value().unwrap());
    let taken: Vec<String> = taken.map(|value| value.get_name().to_owned()).collect();
    assert_eq!(taken, all.iter().map(T::to_string).collect::<Vec<_>>());
}

#[test]
fn the_command_line_takes_the_names_that_are_printed() {
    taken_as_printed(&Backend::ALL);
    taken_as_printed(&Test::ALL);
    taken_as_printed(&Order::ALL);
    taken_as_printed(&Method::ALL);
}

#[test]
fn outcomes_and_verdicts_are_printed_in_words() {
    assert_eq!(Outcome::VerdictLit.to_string(), "verdict-lit");
    assert_eq!(Verdict::Tie.to_string(), "tie");
}
