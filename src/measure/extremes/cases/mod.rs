//! The extremes, one by one.

mod aim;
mod crowd;
mod place;

use super::mesh::{Exactly, lattice, rounded, soup};
use super::shot::{Range, through};
use crate::exact::random::Random;
use crate::geometry::{Ray, Triangle};

/// Triangles of a mesh, where nothing else is said: brute force and the verdicts stay quick.
const FEW: usize = 300;

/// A mesh and rays.
pub struct Situation {
    /// The mesh.
    pub triangles: Vec<Triangle>,
    /// The rays.
    pub rays: Vec<Ray>,
}

type Make = Box<dyn Fn(&mut Random, usize) -> Situation + Send + Sync>;

/// One thing that is stressed.
pub struct Case {
    /// Its name.
    pub name: String,
    /// In words.
    pub what: String,
    /// Makes the mesh and so many rays.
    pub(super) make: Make,
}

impl Case {
    fn new(
        name: impl Into<String>,
        what: impl Into<String>,
        make: impl Fn(&mut Random, usize) -> Situation + Send + Sync + 'static,
    ) -> Self {
        Self { name: name.into(), what: what.into(), make: Box::new(make) }
    }

    /// Shoots at a mesh.
    fn shots(
        name: impl Into<String>,
        what: impl Into<String>,
        mesh: impl Fn(&mut Random) -> Vec<Triangle> + Send + Sync + 'static,
        shot: impl Fn(&Range, &mut Random) -> Ray + Send + Sync + 'static,
    ) -> Self {
        Self::new(name, what, move |random, count| {
            let triangles = mesh(random);
            let rays = shoot(&triangles, random, count, &shot);
            Situation { triangles, rays }
        })
    }

    /// Its random numbers depend on its name alone.
    pub(super) fn seed(&self) -> u64 {
        self.name.bytes().fold(0, |seed: u64, byte| {
            seed.wrapping_mul(0x0100_0000_01b3).wrapping_add(u64::from(byte))
        })
    }
}

fn shoot(
    triangles: &[Triangle],
    random: &mut Random,
    count: usize,
    shot: impl Fn(&Range, &mut Random) -> Ray,
) -> Vec<Ray> {
    let range = Range::new(triangles);
    (0..count).map(|_| shot(&range, random)).collect()
}

/// Every case.
#[must_use]
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    place::scales(&mut cases);
    place::places(&mut cases);
    place::shapes(&mut cases);
    aim::aims(&mut cases);
    aim::ends(&mut cases);
    crowd::crowds(&mut cases);
    crowd::closed(&mut cases);
    crowd::adversaries(&mut cases);
    cases
}

fn soup_of_few(random: &mut Random) -> Vec<Exactly> {
    soup(random, FEW, 0.3)
}

fn plain(random: &mut Random) -> Vec<Triangle> {
    rounded(&soup_of_few(random))
}

fn on_lattice(random: &mut Random) -> Vec<Triangle> {
    rounded(&lattice(random, FEW))
}

fn at_target(range: &Range, random: &mut Random) -> Ray {
    through(range.anywhere(random), range.target(random), random)
}
