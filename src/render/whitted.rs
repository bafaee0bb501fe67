//! Whitted's recursion, generation by generation.
//!
//! All rays of one generation are traced, then all their shadow queries asked light by light, then
//! the next generation is spawned. What a sample gathers is added in one order, by generation, light
//! and place in the ray tree, so the picture does not depend on how samples are batched.
//!
//! Whitted: An Improved Illumination Model for Shaded Display. Communications of the ACM 23(6), 1980.

use std::ops::Range;
use std::sync::atomic::Ordering::Relaxed;

use glam::{DVec2, Vec3};

use super::film::Seen;
use super::order::Place;
use super::shading::{Surface, offset_of};
use super::{Answered, Progress, Settings, Statistics};
use crate::geometry::{Ray, TriangleId};
use crate::occlusion::{Occlusion, Tally};
use crate::scene::{Illumination, Scene};
use crate::shadow::{Answer, Attenuation, Glass, Path, Prepared, ShadowQuery, Shadows};

/// Rays that carry less than this share of a pixel's light are not followed.
const LEAST_THROUGHPUT: f32 = 1.0 / 1024.0;

/// A shadow query of a render, and where it came from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordedQuery {
    /// The query.
    pub query: ShadowQuery,
    /// The light it asks about.
    pub light: u32,
    /// The pixel: column and row.
    pub pixel: Place,
    /// Whether the render found it blocked.
    pub blocked: bool,
}

impl RecordedQuery {
    /// Whether the renderer asks both at once, if they are of one unit: about one light, in one generation.
    #[must_use]
    pub fn is_asked_with(&self, other: &Self) -> bool {
        (self.light, self.query.path.level()) == (other.light, other.query.path.level())
    }
}

/// What one unit of work gives.
#[derive(Debug, Default)]
pub(super) struct Done {
    pub colours: Vec<Vec3>,
    /// By pixel, then by light; empty if no mask was asked for.
    pub seen: Vec<Seen>,
    /// By pixel; empty if not asked for.
    pub answered: Vec<Answered>,
    pub queries: Vec<RecordedQuery>,
    pub statistics: Statistics,
}

/// Renders one unit, by one worker.
pub(super) struct Unit<'a> {
    scene: &'a Scene,
    backend: &'a dyn Occlusion,
    shadows: Box<dyn Shadows + 'a>,
    settings: &'a Settings,
    offset: f64,
    /// Whether shadow rays start on the surface, and leave out the triangle that they start on.
    leaves_out_spawner: bool,
    attenuation: Attenuation,
    /// What finds the transparent triangles that queries meet.
    glass: Option<&'a dyn Glass>,
    /// Queries that are not blocked.
    lit: Vec<ShadowQuery>,
    /// Kept from batch to batch, as all of these, lest every sample allocate its own.
    generation: Vec<Seeing>,
    vertices: Vec<Vertex>,
    /// Radiance that each sample of the batch has gathered.
    gathered: Vec<Vec3>,
    done: Done,
    /// What is asked; of which vertex, and the light that it is about.
    asked: Vec<ShadowQuery>,
    about: Vec<(u32, Illumination)>,
    answers: Vec<Answer>,
}

/// A ray that sees, on its way.
struct Seeing {
    ray: Ray,
    /// Place of its sample in the batch.
    sample: u32,
    throughput: Vec3,
    path: Path,
}

/// A point of a surface that it saw.
struct Vertex {
    surface: Surface,
    /// Where its shadow rays start.
    origin: Vec3,
    triangle: TriangleId,
    sample: u32,
    throughput: Vec3,
    path: Path,
}

#[derive(Clone, Copy)]
enum Kind {
    Reflected,
    Refracted,
}

impl<'a> Unit<'a> {
    pub(super) fn new(
        scene: &'a Scene,
        backend: &'a dyn Occlusion,
        shadows: &'a dyn Prepared,
        settings: &'a Settings,
    ) -> Self {
        Self {
            scene,
            backend,
            shadows: shadows.worker(),
            settings,
            offset: offset_of(scene),
            leaves_out_spawner: shadows.leaves_out_spawner(),
            attenuation: Attenuation::default(),
            glass: shadows.glass(),
            lit: Vec::new(),
            generation: Vec::new(),
            vertices: Vec::new(),
            gathered: Vec::new(),
            done: Done::default(),
            asked: Vec::new(),
            about: Vec::new(),
            answers: Vec::new(),
        }
    }

    pub(super) fn run(mut self, pixels: &[Place], progress: &Progress) -> Done {
        if self.settings.order.batches() {
            self.batch(pixels, 0..pixels.len() * self.samples_a_pixel(), progress);
        } else {
            let mut row = 0..0;
            while row.end < pixels.len() {
                let y = pixels[row.end].1;
                let length = pixels[row.end..].iter().take_while(|pixel| pixel.1 == y).count();
                row = row.end..row.end + length;
                self.stretch(pixels, row.clone(), progress);
            }
        }
        self.finish()
    }

    /// Renders pixels of one scanline that follow each other, each sample by itself.
    pub(super) fn stretch(&mut self, pixels: &[Place], stretch: Range<usize>, progress: &Progress) {
        let before = stretch.start.checked_sub(1).map(|last| pixels[last].1);
        if before.is_some_and(|row| row != pixels[stretch.start].1) {
            self.shadows.begin_scanline();
        }
        let samples = self.samples_a_pixel();
        for sample in stretch.start * samples..stretch.end * samples {
            self.batch(pixels, sample..sample + 1, progress);
        }
    }

    pub(super) fn finish(mut self) -> Done {
        self.done.statistics.shadows = self.shadows.tally();
        self.done.statistics.transparent = self.attenuation.tally;
        self.done
    }

    fn samples_a_pixel(&self) -> usize {
        (self.settings.samples * self.settings.samples) as usize
    }

    /// Renders some of the unit's samples together; they are numbered pixel by pixel.
    fn batch(&mut self, pixels: &[Place], samples: Range<usize>, progress: &Progress) {
        let before = self.done.statistics.rays.total();
        let a_pixel = self.samples_a_pixel();
        if self.settings.mask {
            self.done.seen.resize(pixels.len() * self.scene.lights.len(), Seen::default());
        }
        if self.settings.answers.is_some() {
            self.done.answered.resize(pixels.len(), Answered::default());
        }
        self.gathered.clear();
        self.gathered.resize(samples.len(), Vec3::ZERO);
        let pixel_of = |sample: u32| (samples.start + sample as usize) / a_pixel;
        let mut generation = std::mem::take(&mut self.generation);
        let mut vertices = std::mem::take(&mut self.vertices);
        generation.extend(samples.clone().map(|index| Seeing {
            ray: self.eye_ray(pixels[index / a_pixel], index % a_pixel),
            sample: (index - samples.start) as u32,
            throughput: Vec3::ONE,
            path: Path::EYE,
        }));
        self.done.statistics.rays.primary += generation.len() as u64;
        while !generation.is_empty() {
            self.see(&generation, &mut vertices);
            for light in 0..self.scene.lights.len() {
                self.ask(light, &vertices, |sample| (pixel_of(sample), pixels[pixel_of(sample)]));
            }
            self.spawn(&vertices, &mut generation);
        }
        (self.generation, self.vertices) = (generation, vertices);
        // A pixel's samples are added in their order, which no batch cuts differently.
        for (offset, gathered) in self.gathered.iter().enumerate() {
            let pixel = pixel_of(offset as u32);
            if pixel >= self.done.colours.len() {
                self.done.colours.resize(pixel + 1, Vec3::ZERO);
            }
            self.done.colours[pixel] += *gathered / a_pixel as f32;
        }
        progress.rays.fetch_add(self.done.statistics.rays.total() - before, Relaxed);
    }

    fn eye_ray(&self, (x, y): Place, sample: usize) -> Ray {
        let Settings { width, height, samples, .. } = *self.settings;
        let n = samples as usize;
        let within = DVec2::new((sample % n) as f64 + 0.5, (sample / n) as f64 + 0.5) / n as f64;
        let size = DVec2::new(f64::from(width), f64::from(height));
        let place = (DVec2::new(f64::from(x), f64::from(y)) + within) / size;
        self.scene.camera.ray(place, size.x / size.y)
    }

    /// Finds what the rays of a generation see; adds what shines by itself, and the background.
    fn see(&mut self, generation: &[Seeing], vertices: &mut Vec<Vertex>) {
        vertices.clear();
        for seeing in generation {
            let gathered = &mut self.gathered[seeing.sample as usize];
            let Some(hit) = self.backend.nearest(&seeing.ray, &mut self.done.statistics.nearest)
            else {
                *gathered += seeing.throughput * self.scene.background;
                continue;
            };
            let material = self.scene.material(hit.triangle);
            *gathered +=
                seeing.throughput * (material.emission + self.scene.ambient * material.diffuse);
            let surface = Surface::new(self.scene, &seeing.ray, &hit, self.offset);
            let origin = match self.leaves_out_spawner {
                true => surface.point.as_vec3(),
                false => surface.origin_above(),
            };
            vertices.push(Vertex {
                surface,
                origin,
                triangle: hit.triangle,
                sample: seeing.sample,
                throughput: seeing.throughput,
                path: seeing.path,
            });
        }
    }

    /// Asks whether one light reaches the vertices, and adds its light where it does.
    fn ask(&mut self, light: usize, vertices: &[Vertex], pixel: impl Fn(u32) -> (usize, Place)) {
        self.pose(light, vertices);
        let asked = self.asked.len();
        self.done.statistics.rays.shadow += asked as u64;
        if self.settings.answers.is_some_and(|shown| shown.includes(light)) {
            // One by one, glass included, so that it is known what each costs.
            let mut before = self.spent();
            for query in 0..asked {
                self.answer(light, vertices, query..query + 1);
                let after = self.spent();
                let vertex = &vertices[self.about[query].0 as usize];
                let answered = &mut self.done.answered[pixel(vertex.sample).0];
                answered.outcomes[self.answers[query].outcome as usize] += 1;
                answered.cost += after - before;
                before = after;
            }
        } else {
            self.answer(light, vertices, 0..asked);
        }
        if self.settings.mask || self.settings.record {
            self.keep(light, vertices, pixel);
        }
    }

    /// Collects the queries of all vertices that face a light.
    fn pose(&mut self, light: usize, vertices: &[Vertex]) {
        let source = &self.scene.lights[light];
        self.asked.clear();
        self.about.clear();
        for (vertex, index) in vertices.iter().zip(0..) {
            let material = self.scene.material(vertex.triangle);
            if material.diffuse == Vec3::ZERO && material.highlight == Vec3::ZERO {
                continue;
            }
            let Some(illumination) = source.illuminate(vertex.surface.point) else { continue };
            if vertex.surface.faces(&illumination) {
                let ray = source.shadow_ray(vertex.origin);
                self.asked.push(ShadowQuery { ray, path: vertex.path, spawner: vertex.triangle });
                self.about.push((index, illumination));
            }
        }
        self.answers.clear();
        self.answers.resize(self.asked.len(), Answer::default());
    }

    /// Has some of the queries answered, and adds the light of those that are not blocked.
    fn answer(&mut self, light: usize, vertices: &[Vertex], queries: Range<usize>) {
        let Self { scene, backend, .. } = *self;
        let (asked, about) = (&self.asked[queries.clone()], &self.about[queries.clone()]);
        let answers = &mut self.answers[queries];
        self.shadows.answer(light, asked, answers);
        let is_lit = |answer: &Answer| !answer.blocked;
        let attenuates = scene.has_transparent();
        if let Some(glass) = self.glass.filter(|_| attenuates) {
            let lit = asked.iter().zip(&*answers).filter(|(_, answer)| is_lit(answer));
            self.lit.clear();
            self.lit.extend(lit.map(|(query, _)| *query));
            self.attenuation.prepare(glass, light, &self.lit);
        }
        let lit = asked.iter().zip(about).zip(answers).filter(|(_, answer)| is_lit(answer));
        for (place, ((query, (vertex, illumination)), _)) in lit.enumerate() {
            let vertex = &vertices[*vertex as usize];
            let mut radiance = vertex.surface.shade(scene.material(vertex.triangle), illumination);
            if attenuates {
                let spawner = self.leaves_out_spawner.then_some(query.spawner);
                radiance *=
                    self.attenuation.transmittance(scene, backend, place, &query.ray, spawner);
            }
            self.gathered[vertex.sample as usize] += vertex.throughput * radiance;
        }
    }

    /// Keeps the shadow mask and the queries, as far as they are asked for.
    fn keep(&mut self, light: usize, vertices: &[Vertex], pixel: impl Fn(u32) -> (usize, Place)) {
        let about = self.about.iter().map(|(vertex, _)| &vertices[*vertex as usize]);
        for ((query, vertex), answer) in self.asked.iter().zip(about).zip(&self.answers) {
            let (index, pixel) = pixel(vertex.sample);
            if self.settings.mask && vertex.path == Path::EYE {
                let seen = &mut self.done.seen[index * self.scene.lights.len() + light];
                seen.asked += 1;
                seen.blocked += u16::from(answer.blocked);
            }
            if self.settings.record {
                self.done.queries.push(RecordedQuery {
                    query: *query,
                    light: light as u32,
                    pixel,
                    blocked: answer.blocked,
                });
            }
        }
    }

    /// What all queries so far have cost, attenuation included: what the pictures of cost show.
    fn spent(&self) -> u64 {
        let work = |tally: &Tally| tally.cells + tally.triangle_tests;
        work(&self.shadows.tally().backend) + work(&self.attenuation.tally)
    }

    /// The next generation: mirrored and refracted rays.
    fn spawn(&mut self, vertices: &[Vertex], generation: &mut Vec<Seeing>) {
        generation.clear();
        for vertex in vertices {
            let material = self.scene.material(vertex.triangle);
            if !material.is_specular() || vertex.path.level() >= self.settings.depth {
                continue;
            }
            let surface = &vertex.surface;
            let mut reflectance = surface.reflectance(material);
            let mut refracted = None;
            if material.is_transparent() {
                match surface.refracted(material) {
                    Some((direction, share)) => {
                        reflectance += (Vec3::ONE - reflectance) * share;
                        refracted = Some((direction, material.transmission * (1.0 - share)));
                    }
                    None => reflectance = Vec3::ONE,
                }
            }
            let mut push = |kind: Kind, origin: Vec3, direction: Vec3, share: Vec3| {
                let throughput = vertex.throughput * share;
                if throughput.max_element() < LEAST_THROUGHPUT {
                    return;
                }
                let rays = &mut self.done.statistics.rays;
                let path = match kind {
                    Kind::Reflected => {
                        rays.reflected += 1;
                        vertex.path.reflected()
                    }
                    Kind::Refracted => {
                        rays.refracted += 1;
                        vertex.path.refracted()
                    }
                };
                let ray = Ray::towards(origin, direction);
                generation.push(Seeing { ray, sample: vertex.sample, throughput, path });
            };
            push(Kind::Reflected, surface.origin_above(), surface.reflected(), reflectance);
            if let Some((direction, share)) = refracted {
                push(Kind::Refracted, surface.origin_below(), direction, share);
            }
        }
    }
}
