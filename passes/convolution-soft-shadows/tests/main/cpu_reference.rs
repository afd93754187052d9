//! The CPU reference in `f64`, with the names of the WGSL. Images are whole and not rounded.

use glam::{DVec2, DVec3, UVec2, dvec2};
use gpu_algorithms::reference::disc_shadow::{disc_radius, penumbra_radius, search_radius, texel_of};
use gpu_algorithms::reference::paraboloid::{texel_centre, tile_position};
use gpu_algorithms::reference::paraboloid_lookup::{ParaboloidLookup, is_seen, paraboloid_lookup};
use std::f64::consts::PI;

/// The least distance that an atlas holds where nothing is \[m\].
const NOTHING: f64 = 2.9e38;
/// The share of a region that blocks below which it counts as none.
const LEAST_BLOCKED: f64 = 0.03;

/// The parameters of the expansion and of lookups.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Expansion {
    /// Orders.
    pub(crate) order: u32,
    /// Levels above the maps.
    pub(crate) levels: u32,
    /// The attenuation of high orders.
    pub(crate) attenuation: f64,
    /// The bias of the comparison towards the light, in depths of 1 / order.
    pub(crate) offset: f64,
    /// Searches for blockers.
    pub(crate) search: u32,
    /// Least height of a blocker above the light's plane, as a share of the receiver's.
    pub(crate) nearest: f64,
    /// Depth bias, in widths of a texel at the receiver.
    pub(crate) depth_bias: f64,
}

/// The means over a texel of sin(c_k z), cos(c_k z), z sin(c_k z) and z cos(c_k z), for each order k, and last of z alone.
pub(crate) type Texel = Vec<[f64; 4]>;

/// A map with its basis images.
#[derive(Clone, Debug)]
pub(crate) struct Map {
    distances: Vec<f64>,
    tile: u32,
    expansion: Expansion,
    /// The greatest height \[m\].
    pub(crate) far: f64,
    /// The levels from 1 on, row by row.
    pub(crate) levels: Vec<Vec<Texel>>,
}

/// The blockers in a region of a map.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Blockers {
    /// The share of the region.
    pub(crate) share: f64,
    /// Mean depth of that share.
    pub(crate) depth: f64,
}

/// c_k, counted from 0.
fn frequency(k: u32) -> f64 {
    PI * f64::from(2 * k + 1)
}

impl Expansion {
    /// Returns f(d, z): the share of what has the depth z that is not in front of the depth d.
    pub(crate) fn seen_at_depth(&self, compared: f64, depth: f64) -> f64 {
        let term = |k| self.weight(k) * (frequency(k) * (depth - compared)).sin();
        0.5 + 2.0 * (0..self.order).map(term).sum::<f64>()
    }

    /// a_k / c_k.
    fn weight(&self, k: u32) -> f64 {
        let share = f64::from(2 * k + 1) / f64::from(2 * self.order);
        (-self.attenuation * share * share).exp() / frequency(k)
    }

    /// Returns how much nearer than the receiver it is compared.
    pub(crate) fn nearer(&self) -> f64 {
        self.offset / f64::from(self.order)
    }

    /// Returns the greatest depth.
    pub(crate) fn greatest(&self) -> f64 {
        1.0 - self.nearer()
    }
}

/// The sum of the texels of a finer level with that side.
fn sum_of_finer(finer: &[Texel], side: u32, texel: UVec2) -> Texel {
    let begin = 2 * texel;
    let end = (begin + 2).min(UVec2::splat(side));
    let all = (begin.y..end.y).flat_map(|y| (begin.x..end.x).map(move |x| &finer[(y * side + x) as usize]));
    let add = |mut sum: Texel, texel: &Texel| {
        for (sum, term) in sum.iter_mut().flatten().zip(texel.iter().flatten()) {
            *sum += term;
        }
        sum
    };
    all.fold(vec![[0.0; 4]; finer[0].len()], add)
}

impl Map {
    /// Makes the basis images of a map of distances \[m\], row by row.
    pub(crate) fn new(distances: Vec<f64>, tile: u32, expansion: Expansion) -> Map {
        let mut map = Map { distances, tile, expansion, far: 0.0, levels: Vec::new() };
        let texels = (0..tile * tile).map(|i| UVec2::new(i % tile, i / tile));
        let heights = texels.map(|texel| map.stored_height(texel)).filter(|height| *height < NOTHING);
        map.far = heights.fold(0.0, f64::max);
        let mut sums: Vec<Texel> = Vec::new();
        for level in 1..=expansion.levels {
            let (side, fine) = (map.side(level), map.side(level - 1));
            let texels = (0..side * side).map(|i| UVec2::new(i % side, i / side));
            sums = match level {
                1 => texels.clone().map(|texel| map.terms(&map.depths(1, texel))).collect(),
                _ => texels.clone().map(|texel| sum_of_finer(&sums, fine, texel)).collect(),
            };
            let mean = |(texel, sum): (UVec2, &Texel)| {
                let share = 1.0 / f64::from(map.covered(level, texel));
                sum.iter().map(|terms| terms.map(|term| share * term)).collect()
            };
            map.levels.push(texels.zip(&sums).map(mean).collect());
        }
        map
    }

    /// The texels of the map that a texel of a level covers.
    fn covered(&self, level: u32, texel: UVec2) -> u32 {
        let begin = texel * (1 << level);
        ((begin + (1 << level)).min(UVec2::splat(self.tile)) - begin).element_product()
    }

    fn side(&self, level: u32) -> u32 {
        self.tile.div_ceil(1 << level)
    }

    fn stored_height(&self, texel: UVec2) -> f64 {
        let distance = self.distances[(texel.y * self.tile + texel.x) as usize];
        let r2 = texel_centre(texel, self.tile).length_squared();
        if distance < NOTHING { distance * (1.0 - r2).max(0.0) / (1.0 + r2) } else { NOTHING }
    }

    /// Returns the texel that stands for one below the horizon.
    fn above_rim(&self, texel: UVec2) -> UVec2 {
        let centre = texel_centre(texel, self.tile);
        let r2 = centre.length_squared();
        if r2 <= 1.0 {
            return texel;
        }
        tile_position(centre * ((1.0 - 2.0 / f64::from(self.tile)) / r2), self.tile).as_uvec2()
    }

    /// Returns the depth of a height \[m\].
    pub(crate) fn depth_of_height(&self, height: f64) -> f64 {
        let greatest = self.expansion.greatest();
        if height < self.far { height / self.far * greatest } else { greatest }
    }

    /// Returns the depths of the texels of the map that a texel of a level covers.
    pub(crate) fn depths(&self, level: u32, texel: UVec2) -> Vec<f64> {
        let begin = texel * (1 << level);
        let end = (begin + (1 << level)).min(UVec2::splat(self.tile));
        let all = (begin.y..end.y).flat_map(|y| (begin.x..end.x).map(move |x| UVec2::new(x, y)));
        all.map(|texel| self.depth_of_height(self.stored_height(self.above_rim(texel)))).collect()
    }

    /// The sums of the terms of some depths.
    fn terms(&self, depths: &[f64]) -> Texel {
        let sum = |of: &dyn Fn(f64) -> f64| depths.iter().map(|z| of(*z)).sum::<f64>();
        let terms = |k| {
            let c = frequency(k);
            [
                sum(&|z| (c * z).sin()),
                sum(&|z| (c * z).cos()),
                sum(&|z| z * (c * z).sin()),
                sum(&|z| z * (c * z).cos()),
            ]
        };
        (0..self.expansion.order).map(terms).chain([[sum(&|z| z), 0.0, 0.0, 0.0]]).collect()
    }

    /// Returns the centre and the radius \[px\] of the image of a disc about the receiver.
    fn disc_image(&self, receiver: DVec3, plane_normal: DVec3, radius: f64) -> (DVec2, f64) {
        let (mut middle, mut kept) = (receiver, radius);
        let slope = plane_normal.truncate().length();
        let free = 0.5 * self.expansion.nearer() * (-plane_normal.dot(receiver)).max(0.0);
        if slope * radius > free {
            let behind = free / slope;
            middle += (plane_normal.truncate() / slope * (0.5 * (radius - behind))).extend(0.0);
            kept = 0.5 * (radius + behind);
        }
        let along = middle.truncate().length();
        let direction = if along > 0.0 { middle.truncate() / along } else { DVec2::X };
        let [near, far] = [along - kept, along + kept]
            .map(|end| end / ((end * end + middle.z * middle.z).sqrt() + middle.z));
        let across = kept / ((middle.length_squared() + kept * kept).sqrt() + middle.z);
        let extent = (0.5 * (far - near) * across).sqrt();
        (tile_position(direction * (0.5 * (near + far)), self.tile), 0.5 * f64::from(self.tile) * extent)
    }

    fn level_of(&self, radius: f64) -> f64 {
        radius.max(1.0).log2().clamp(0.0, f64::from(self.expansion.levels))
    }

    /// Returns the terms at a position of the map \[px\], interpolated.
    pub(crate) fn interpolated(&self, level: u32, position: DVec2) -> Texel {
        let side = self.side(level);
        let at = position / f64::from(1 << level) - 0.5;
        let (low, weight) = (at.floor(), at - at.floor());
        let mut sum = vec![[0.0; 4]; self.levels[level as usize - 1][0].len()];
        for beside in [dvec2(0.0, 0.0), dvec2(1.0, 0.0), dvec2(0.0, 1.0), dvec2(1.0, 1.0)] {
            let texel = texel_of(low + beside, side);
            let shares = DVec2::ONE - weight + beside * (2.0 * weight - 1.0);
            let terms = &self.levels[level as usize - 1][(texel.y * side + texel.x) as usize];
            for (sum, term) in sum.iter_mut().flatten().zip(terms.iter().flatten()) {
                *sum += shares.x * shares.y * term;
            }
        }
        sum
    }

    /// Returns the mean of f(d, z) for the depth d that is compared.
    pub(crate) fn seen_share(&self, compared: f64, terms: &Texel) -> f64 {
        let term = |k: u32| {
            let (sin, cos) = (frequency(k) * compared).sin_cos();
            let [s, c, ..] = terms[k as usize];
            self.expansion.weight(k) * (cos * s - sin * c)
        };
        0.5 + 2.0 * (0..self.expansion.order).map(term).sum::<f64>()
    }

    /// Returns the means of 1 - f(d, z), and of z over that share.
    pub(crate) fn find_blockers(&self, compared: f64, terms: &Texel) -> Blockers {
        let term = |k: u32| {
            let (sin, cos) = (frequency(k) * compared).sin_cos();
            let [.., s, c] = terms[k as usize];
            self.expansion.weight(k) * (cos * s - sin * c)
        };
        let share = 1.0 - self.seen_share(compared, terms);
        let mean = terms[self.expansion.order as usize][0];
        let sum = 0.5 * mean - 2.0 * (0..self.expansion.order).map(term).sum::<f64>();
        Blockers { share, depth: sum / share.max(LEAST_BLOCKED) }
    }

    fn seen_nearby(&self, lookup: &ParaboloidLookup) -> f64 {
        let corner = (lookup.position - 0.5).floor();
        let weight = lookup.position - 0.5 - corner;
        let of = |beside: DVec2| {
            let texel = texel_of(corner + beside, self.tile);
            let stored = self.distances[(texel.y * self.tile + texel.x) as usize];
            let shares = DVec2::ONE - weight + beside * (2.0 * weight - 1.0);
            if is_seen(lookup, texel, self.tile, stored) { shares.x * shares.y } else { 0.0 }
        };
        [dvec2(0.0, 0.0), dvec2(1.0, 0.0), dvec2(0.0, 1.0), dvec2(1.0, 1.0)].into_iter().map(of).sum()
    }

    /// Returns the part of a disc of that area \[m²\] that is seen from a receiver \[m\] with a unit normal, both in the
    /// disc's frame.
    pub(crate) fn visibility(&self, area: f64, receiver: DVec3, plane_normal: DVec3) -> f64 {
        if receiver.z <= 0.0 {
            return 0.0;
        }
        let Expansion { levels, search, nearest, depth_bias, .. } = self.expansion;
        let lookup = paraboloid_lookup(receiver, plane_normal, self.tile, depth_bias);
        let radius = disc_radius(area);
        if radius == 0.0 {
            let texel = texel_of(lookup.position, self.tile);
            let stored = self.distances[(texel.y * self.tile + texel.x) as usize];
            return f64::from(u8::from(is_seen(&lookup, texel, self.tile, stored)));
        }
        let exact = self.seen_nearby(&lookup);
        if levels == 0 || receiver.z * self.expansion.greatest() > self.far {
            return exact;
        }
        let depth = self.depth_of_height(receiver.z);
        let compared = (depth - self.expansion.nearer()).max(0.0);
        let mut reach = search_radius(radius, nearest);
        let mut blockers = Blockers { share: 0.0, depth: 0.0 };
        for _ in 0..search {
            let (centre, radius_px) = self.disc_image(receiver, plane_normal, reach);
            let level = (self.level_of(radius_px).round() as u32).clamp(1, levels);
            blockers = self.find_blockers(compared, &self.interpolated(level, centre));
            if blockers.share < LEAST_BLOCKED {
                return exact;
            }
            let height = blockers.depth * self.far / self.expansion.greatest();
            reach = penumbra_radius(radius, receiver.z, height.clamp(nearest * receiver.z, receiver.z));
        }
        let (centre, radius_px) = self.disc_image(receiver, plane_normal, reach);
        let level = self.level_of(radius_px);
        if level == 0.0 {
            return exact;
        }
        let coarse = level.ceil() as u32;
        let lit = self.expansion.seen_at_depth(compared, depth);
        let dark = self.expansion.seen_at_depth(compared, blockers.depth.min(depth));
        let at_level = |level: u32| {
            let share = self.seen_share(compared, &self.interpolated(level, centre));
            ((share - dark) / (lit - dark).max(LEAST_BLOCKED)).clamp(0.0, 1.0)
        };
        let finer = if coarse > 1 { at_level(coarse - 1) } else { exact };
        finer + (at_level(coarse) - finer) * (level - f64::from(coarse - 1))
    }
}
