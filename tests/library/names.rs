//! Names.

use std::fmt::{Debug, Display};
use std::str::FromStr;

use serde::Serialize;
use umbra::exact::Verdict;
use umbra::occlusion::{Backend, Test};
use umbra::render::Order;
use umbra::shadow::{Combination, Outcome};

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

#[test]
fn outcomes_and_verdicts_are_printed_in_words() {
    assert_eq!(Outcome::VerdictLit.to_string(), "verdict-lit");
    assert_eq!(Verdict::Tie.to_string(), "tie");
}
