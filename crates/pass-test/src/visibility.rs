//! Lookups of visibility: what the module of a port `Visibility` returns at receivers, and maps whose shadows are known.

use crate::{Harness, Member, elements, member};
use glam::{DVec2, DVec3, dvec2, dvec3};
use interfaces::virtual_lights::VirtualLight;
use pass::{FromWgsl, ResourceDesc};
use std::f64::consts::{PI, TAU};

/// Writes what the module of its input answers.
const PROBE: FromWgsl = FromWgsl::new("visibility-probe", "crates/pass-test/src");

/// A point that looks a light up.
#[derive(Clone, Copy, Debug)]
pub struct Receiver {
    /// World space \[m\].
    pub position: [f64; 3],
    /// Unit.
    pub normal: [f64; 3],
    /// Index of the light.
    pub light: u32,
}

/// Creates the harness of a pass that reads a port `Visibility`, and writes to its output `answers` what the module of
/// that port returns for each receiver (f32). The caller adds the input `visibility`, last of all inputs.
pub fn lookups(lights: &[VirtualLight], receivers: &[Receiver]) -> Harness<'static> {
    let given: Vec<[f32; 8]> = receivers
        .iter()
        .map(|receiver| {
            let ([x, y, z], [u, v, w]) =
                (receiver.position.map(|x| x as f32), receiver.normal.map(|x| x as f32));
            [x, y, z, f32::from_bits(receiver.light), u, v, w, 0.0]
        })
        .collect();
    let count = ("count", receivers.len() as u32);
    Harness::new(&PROBE).lights(lights).input("receivers", "Buffer", &[count], elements(&given))
}

/// Returns an atlas with one map a layer, of `tile` × `tile` distances \[m\] each: the member `atlas` of an input
/// `Visibility`.
pub fn atlas(tile: u32, maps: &[f32]) -> Member<'static> {
    let layers = maps.len() as u32 / (tile * tile);
    let desc = ResourceDesc::texture_2d_array(pass::Format::R32Float, (tile, tile), layers);
    member("atlas", desc, maps)
}

/// Returns the distances that a paraboloid map has of what `along` meets in a direction \[m\], row by row.
pub fn map_of(tile: u32, along: impl Fn(DVec3) -> Option<f64>) -> Vec<f64> {
    let centre = |i: u32| (f64::from(i) + 0.5) * 2.0 / f64::from(tile) - 1.0;
    let stored = |i: u32| {
        let at = dvec2(centre(i % tile), centre(i / tile));
        let r2 = at.length_squared();
        along((2.0 * at).extend(1.0 - r2) / (1.0 + r2)).unwrap_or(3.0e38)
    };
    (0..tile * tile).map(stored).collect()
}

/// Half of a plane that is parallel to the light's, at a height above it, below the floor at [`Edge::FLOOR`]: everything on
/// one side of an edge through the point `at`, to which `across` is perpendicular.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    /// Above the light's plane \[m\].
    pub height: f64,
    /// In the light's frame \[m\].
    pub at: DVec2,
    /// Unit, away from what is covered.
    pub across: DVec2,
}

impl Edge {
    /// The height of the floor above the light's plane \[m\].
    pub const FLOOR: f64 = 2.0;

    fn covers(&self, at: DVec2) -> bool {
        (at - self.at).dot(self.across) < 0.0
    }

    /// Returns the map of the light.
    pub fn map(&self, tile: u32) -> Vec<f64> {
        map_of(tile, |direction| {
            let z = (direction.z > 0.0).then_some(direction.z)?;
            let met = self.covers(direction.truncate() * (self.height / z));
            Some(if met { self.height / z } else { Self::FLOOR / z })
        })
    }

    /// Returns the part of a disc of that radius about the origin that rays from a point on the floor reach.
    pub fn by_rays(&self, radius: f64, receiver: DVec3) -> f64 {
        const RAYS: u32 = 4096;
        let reaches = |i: u32| {
            let (r, angle) = (((f64::from(i) + 0.5) / f64::from(RAYS)).sqrt(), f64::from(i) * 2.399_963);
            let on_light = radius * r * dvec2(angle.cos(), angle.sin());
            !self.covers(on_light.lerp(receiver.truncate(), self.height / Self::FLOOR))
        };
        f64::from((0..RAYS).filter(|i| reaches(*i)).count() as u32) / f64::from(RAYS)
    }
}

/// A plane that the maps of a light see.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    /// Unit, towards the light.
    pub normal: DVec3,
    /// The light's distance from it \[m\].
    pub height: f64,
}

impl Plane {
    /// Creates a plane whose normal is turned away from the light's by an angle.
    pub fn tilted(degrees: f64, height: f64) -> Plane {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Plane { normal: dvec3(0.6 * sin, -0.8 * sin, -cos), height }
    }

    /// Returns the distance along a unit direction \[m\]; `None` where it is not met.
    pub fn along(&self, direction: DVec3) -> Option<f64> {
        let along = self.normal.dot(direction);
        (along < -1e-3).then(|| -self.height / along)
    }

    /// Returns what `visibility` of this normal is at points of the plane, by the first of many directions: away from the rim
    /// of the map and of the plane, up to three heights away.
    pub fn seen(&self, directions: u32, visibility: impl Fn(DVec3, DVec3) -> f64) -> Vec<f64> {
        let near = |i: &u32| {
            let distance = self.along(direction(*i)).filter(|distance| *distance < 3.0 * self.height)?;
            (direction(*i).z > 0.1).then(|| visibility(distance * direction(*i), self.normal))
        };
        (0..directions).filter_map(|i| near(&i)).collect()
    }
}

/// Where a lookup's visibility of an edge rises.
#[derive(Clone, Copy, Debug)]
pub struct Penumbra {
    /// The height of the edge above the light's plane \[m\].
    pub height: f64,
    /// From a tenth to nine tenths of the light, the mean over directions \[m\].
    pub width: f64,
    /// The same of a disc, by similar triangles \[m\]. [ACRSM Eq. 3.2]
    pub wanted: f64,
    /// The least visibility on the dark ends, and the greatest shadow on the lit ones.
    pub ends: (f64, f64),
}

/// Returns the penumbrae of edges nearer and nearer to the floor, for a disc of that radius: up to `reach` half widths from
/// their middle, in several directions. `lookup` makes of a map of
/// 512² the visibility of points on the floor, whose normal is -z.
pub fn penumbrae(
    radius: f64,
    directions: u32,
    reach: f64,
    lookup: impl Fn(Vec<f64>) -> Box<dyn Fn(DVec3) -> f64>,
) -> Vec<Penumbra> {
    // A tenth of the disc is beyond this distance from its centre, in radii.
    let tenth = (0..1000).map(|i| f64::from(i) / 1000.0).find(|d| segment(*d) >= 0.9).expect("it is there");
    let of_height = |height: f64| {
        // With the light's diameter.
        let whole = (Edge::FLOOR - height) * 2.0 * radius / height;
        let (mut sum, mut ends) = (0.0, (0.0_f64, 0.0_f64));
        for direction in 0..directions {
            let (sin, cos) = (0.1 + TAU * f64::from(direction) / 8.0).sin_cos();
            let across = dvec2(cos, sin);
            let seen = lookup(Edge { height, at: 0.2 * across, across }.map(512));
            let at = |t: f64| ((0.2 * Edge::FLOOR / height + t) * across).extend(Edge::FLOOR);
            let steps = (100.0 * reach) as i32;
            let places = (-steps..=steps).map(|i| f64::from(i) / 100.0 * whole / 2.0);
            let rising: Vec<(f64, f64)> = places.map(|t| (t, seen(at(t)))).collect();
            ends = (ends.0.max(rising[0].1), ends.1.max(1.0 - rising[rising.len() - 1].1));
            let from =
                |least: f64| rising.iter().find(|(_, seen)| *seen >= least).expect("it is lit in the end").0;
            sum += from(0.9) - from(0.1);
        }
        Penumbra { height, width: sum / f64::from(directions), wanted: tenth * whole, ends }
    };
    [0.8, 1.0, 1.4, 1.8].map(of_height).to_vec()
}

/// Returns by how much the visibility of discs behind edges is off from that by rays: on average, and at most. `lookup` makes of
/// a map of 512² and the disc's radius the visibility of points on the floor, whose normal is -z.
pub fn errors_behind_edges(lookup: impl Fn(Vec<f64>, f64) -> Box<dyn Fn(DVec3) -> f64>) -> (f64, f64) {
    let (mut sum, mut worst, mut count) = (0.0, 0.0_f64, 0);
    for (i, height) in [0.7, 1.1, 1.6].into_iter().enumerate() {
        for (j, radius) in [0.1, 0.3, 0.6].into_iter().enumerate() {
            let angle = 0.7 + 2.0 * i as f64 + j as f64;
            let across = dvec2(angle.cos(), angle.sin());
            // The last ones are seen at 60° from the light's normal.
            let edge = Edge { height, at: 0.9 * j as f64 * height * across, across };
            let seen = lookup(edge.map(512), radius);
            for k in 0..60 {
                let t = (f64::from(k) / 30.0 - 1.0) * 1.3 * radius * (Edge::FLOOR - height) / height;
                let along = across.perp() * (0.3 * f64::from(k % 7));
                let at = (edge.at * (Edge::FLOOR / height) + t * across + along).extend(Edge::FLOOR);
                let error = (seen(at) - edge.by_rays(radius, at)).abs();
                (sum, worst, count) = (sum + error, worst.max(error), count + 1);
            }
        }
    }
    (sum / f64::from(count), worst)
}

/// Returns the part of a unit disc on one side of a line at a distance from its centre.
pub fn segment(distance: f64) -> f64 {
    let d = distance.clamp(-1.0, 1.0);
    0.5 + (d * (1.0 - d * d).sqrt() + d.asin()) / PI
}

/// Returns `count` receivers on a hemisphere of the radius 2 about the origin, which face it, for `lights` lights in turn.
pub fn receivers_around(count: u32, lights: u32) -> Vec<Receiver> {
    let receiver = |i: u32| {
        let direction = direction(i);
        Receiver {
            position: (2.0 * direction).to_array(),
            normal: (-direction).to_array(),
            light: i % lights,
        }
    };
    (0..count).map(receiver).collect()
}

/// Returns one of a sequence of directions that spread over the hemisphere about z, but for 2 % at the horizon.
pub fn direction(i: u32) -> DVec3 {
    let [u, v] = [0.754_877, 0.569_840].map(|step: f64| (f64::from(i) * step).fract());
    let (z, angle) = (0.02 + 0.97 * u, TAU * v);
    (dvec2(angle.cos(), angle.sin()) * (1.0 - z * z).sqrt()).extend(z)
}
