//! `umbra tradeoff`: speed against accuracy, measured, plotted and reported.

use std::path::{Path, PathBuf};

use clap::Args;

use super::failure::{Failure, say};
use super::options::{check_outputs, load_scene, parse_size, pool_of, write_json, write_text};
use super::output::print;
use super::progress::with_bar;
use crate::measure::contender::Choice;
use crate::measure::tradeoff::{Conditions, csv, measure, page, plot, table};
use crate::occlusion::{Backend, Test};
use crate::render::{Progress, Settings};
use crate::scene::Scene;
use crate::shadow::Method;
