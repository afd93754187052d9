//! Parts of buildings: walls with arched openings, vaults, columns.

use std::f32::consts::PI;

use glam::Vec3;

use super::builder::{Builder, MaterialId};

/// Number of segments of an arch.
const ARCH_PIECES: usize = 16;

/// An opening in a wall, in the middle of its width, with an elliptic arch above.
#[derive(Clone, Copy)]
pub(super) struct Opening {
    pub(super) half_width: f32,
    /// Lower edge of the opening; that of the wall if the opening reaches the floor.
    pub(super) sill: f32,
    /// Height at which the arch begins.
    pub(super) spring: f32,
    /// Height of the arch.
    pub(super) rise: f32,
}

/// A vertical piece of wall.
#[derive(Clone, Copy)]
pub(super) struct Wall {
    /// Centre of its width and thickness, at height 0.
    pub(super) place: Vec3,
    /// Horizontal unit vector along its width.
    pub(super) along: Vec3,
    pub(super) width: f32,
    pub(super) bottom: f32,
    pub(super) top: f32,
    pub(super) thickness: f32,
}

impl Wall {
    /// Returns the point at `s` along and `y` up, on the front (`side` 1) or the back (−1).
    fn point(&self, s: f32, y: f32, side: f32) -> Vec3 {
        self.place + self.along * s + Vec3::Y * y + self.front() * (side * self.thickness * 0.5)
    }

    fn front(&self) -> Vec3 {
        self.along.cross(Vec3::Y)
    }

    /// Adds a piece of front and back: from `s[0]` to `s[1]`, between `low` and `high`, each given at both
    /// ends.
    fn sides(&self, builder: &mut Builder, material: MaterialId, s: [f32; 2], low: [f32; 2], high: [f32; 2]) {
        let corners = |side: f32| {
            [(s[0], low[0]), (s[1], low[1]), (s[1], high[1]), (s[0], high[0])]
                .map(|(s, y)| self.point(s, y, side))
        };
        builder.quad(material, corners(1.0));
        let [a, b, c, d] = corners(-1.0);
        builder.quad(material, [b, a, d, c]);
    }

    /// Adds the wall with its opening. Its ends and top are left open, since other parts adjoin them.
    pub(super) fn with_opening(&self, builder: &mut Builder, material: MaterialId, opening: Opening) {
        let Opening { half_width, sill, spring, rise } = opening;
        let (edge, bottom, top) = (self.width * 0.5, self.bottom, self.top);
        // Beside the opening, in pieces whose edges match those of the pieces next to them.
        for s in [[-edge, -half_width], [half_width, edge]] {
            for y in [[bottom, sill], [sill, spring], [spring, top]] {
                if y[1] > y[0] {
                    self.sides(builder, material, s, [y[0]; 2], [y[1]; 2]);
                }
            }
            if sill <= bottom {
                self.level(builder, material, s, bottom, -1.0);
            }
        }
        let arch: Vec<(f32, f32)> = (0..=ARCH_PIECES)
            .map(|i| {
                let (sin, cos) = (PI * i as f32 / ARCH_PIECES as f32).sin_cos();
                let s = if i == ARCH_PIECES { half_width } else { -half_width * cos };
                (s, if i == 0 || i == ARCH_PIECES { spring } else { spring + rise * sin })
            })
            .collect();
        let inwards = |(s, y): (f32, f32)| {
            -(self.along * (s / half_width.powi(2)) + Vec3::Y * ((y - spring) / rise.powi(2)))
                .normalize_or(Vec3::Y)
        };
        for pair in arch.windows(2) {
            let [p, q] = [pair[0], pair[1]];
            self.sides(builder, material, [p.0, q.0], [p.1, q.1], [top; 2]);
            if sill > bottom {
                self.sides(builder, material, [p.0, q.0], [bottom; 2], [sill; 2]);
                self.level(builder, material, [p.0, q.0], sill, 1.0);
            }
            let corners =
                [(q, 1.0), (p, 1.0), (p, -1.0), (q, -1.0)].map(|((s, y), side)| self.point(s, y, side));
            builder.smooth_quad(material, corners, [inwards(q), inwards(p), inwards(p), inwards(q)]);
        }
        for s in [-half_width, half_width] {
            let lower = if s < 0.0 { [1.0, -1.0] } else { [-1.0, 1.0] };
            let [a, b] = lower.map(|side| self.point(s, sill, side));
            let [c, d] = [lower[1], lower[0]].map(|side| self.point(s, spring, side));
            builder.quad(material, [a, b, c, d]);
        }
    }

    /// Adds the two ends, for a free-standing wall.
    pub(super) fn ends(&self, builder: &mut Builder, material: MaterialId) {
        for end in [-0.5, 0.5] {
            let s = self.width * end;
            // Seen along the wall from its end at +s, the front is on the left; from the other, on the right.
            let (left, right) = (2.0 * end, -2.0 * end);
            let corners = [(self.bottom, left), (self.bottom, right), (self.top, right), (self.top, left)];
            builder.quad(material, corners.map(|(y, side)| self.point(s, y, side)));
        }
    }

    /// Adds a horizontal piece through the wall's thickness, facing up (`side` 1) or down (−1).
    fn level(&self, builder: &mut Builder, material: MaterialId, s: [f32; 2], y: f32, side: f32) {
        let [a, b] = s.map(|s| self.point(s, y, side));
        let [c, d] = [s[1], s[0]].map(|s| self.point(s, y, -side));
        builder.quad(material, [a, b, c, d]);
    }
}

/// One bay of a groin vault: two barrels that cross.
#[derive(Clone, Copy)]
pub(super) struct Vault {
    /// Centre of the bay, at height 0.
    pub(super) place: Vec3,
    /// Half its size along x and z.
    pub(super) half: [f32; 2],
    pub(super) spring: f32,
    pub(super) rise: f32,
    /// 0 for elliptic barrels; larger values are more pointed.
    pub(super) pointed: f32,
}

impl Vault {
    /// Returns the height of one barrel at `t` in −1..=1 across, above the spring, divided by the rise.
    fn barrel(&self, t: f32) -> f32 {
        let c = self.pointed;
        // Two circular arcs whose centres lie `c` beyond the middle.
        ((1.0 + c).powi(2) - (t.abs() + c).powi(2)).max(0.0).sqrt() / (1.0 + 2.0 * c).sqrt()
    }

    /// Returns the point of the ceiling at (tx, tz), each in −1..=1.
    pub(super) fn point(&self, tx: f32, tz: f32) -> Vec3 {
        // The room is the union of both barrels, so the ceiling is the higher one.
        let height = self.spring + self.rise * self.barrel(tx).max(self.barrel(tz));
        self.place + Vec3::new(tx * self.half[0], height, tz * self.half[1])
    }

    /// Returns the normal of the ceiling, pointing down: that of the higher barrel, or of both on a crease.
    fn normal(&self, tx: f32, tz: f32) -> Vec3 {
        let side = |t: f32, half: f32| {
            let slope = -(t.abs() + self.pointed).copysign(t) / half;
            let down = -self.barrel(t) * (1.0 + 2.0 * self.pointed) / self.rise;
            (slope, down)
        };
        let ((sx, dx), (sz, dz)) = (side(tx, self.half[0]), side(tz, self.half[1]));
        let (x, z) = (
            Vec3::new(sx, dx, 0.0).normalize_or(Vec3::NEG_Y),
            Vec3::new(0.0, dz, sz).normalize_or(Vec3::NEG_Y),
        );
        match (tx.abs() - tz.abs()).abs() < 1e-4 {
            true => x + z,
            false if tx.abs() < tz.abs() => x,
            false => z,
        }
    }

    /// Adds the ceiling, in `pieces` × `pieces` cells (an even number, so that the creases are edges).
    pub(super) fn build(&self, builder: &mut Builder, material: MaterialId, pieces: usize) {
        // Steps of equal angle, since barrels are steep at their edges.
        let across = |u: f32| if u == 0.5 { 0.0 } else { -(u * PI).cos() };
        builder.surface(material, pieces, pieces, |u, v| {
            let (tx, tz) = (across(u), across(v));
            (self.point(tx, tz), self.normal(tx, tz))
        });
    }

    /// Adds ribs with this radius along both creases.
    pub(super) fn ribs(&self, builder: &mut Builder, material: MaterialId, radius: f32, pieces: usize) {
        for turn in [1.0, -1.0] {
            let path = |u: f32| {
                let t = -(u.clamp(0.0, 1.0) * PI).cos();
                self.point(t, t * turn)
            };
            builder.surface(material, pieces, 8, |u, v| {
                let ahead = (path(u + 1e-2) - path(u - 1e-2)).normalize_or(Vec3::Y);
                let side = Vec3::new(-self.half[1] * turn, 0.0, self.half[0]).normalize();
                let angle = if v == 1.0 { 0.0 } else { v * 2.0 * PI };
                let around = side * angle.cos() + side.cross(ahead) * angle.sin();
                (path(u) + around * radius, around)
            });
        }
    }
}

/// Adds a round column with plinth, base, capital and abacus, from `foot` to `height` above it.
pub(super) fn column(
    builder: &mut Builder,
    material: MaterialId,
    foot: Vec3,
    radius: f32,
    height: f32,
    sides: usize,
) {
    let (r, h) = (radius, height);
    let half = Vec3::new(1.5 * r, 0.0, 1.5 * r);
    let (plinth, abacus) = (0.9 * r, 0.8 * r);
    builder.cuboid(material, foot - half, foot + half + Vec3::Y * plinth);
    builder.cuboid(material, foot - half + Vec3::Y * (h - abacus), foot + half + Vec3::Y * h);
    let outline = [
        [1.4 * r, plinth],
        [1.4 * r, plinth + 0.35 * r],
        [1.15 * r, plinth + 0.6 * r],
        [1.05 * r, plinth + 0.9 * r],
        [0.88 * r, h - abacus - 1.9 * r],
        [1.05 * r, h - abacus - 1.7 * r],
        [0.92 * r, h - abacus - 1.5 * r],
        [1.1 * r, h - abacus - 0.6 * r],
        [1.45 * r, h - abacus],
    ];
    builder.lathe(material, foot, &outline, sides);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Material;

    #[test]
    fn ribs_follow_both_creases_from_corner_to_corner() {
        let vault = Vault { place: Vec3::ZERO, half: [2.0, 3.0], spring: 4.0, rise: 1.5, pointed: 0.2 };
        let (radius, mut builder) = (0.1, Builder::default());
        let stone = builder.material(Material::default());
        vault.ribs(&mut builder, stone, radius, 32);
        let model = builder.finish("ribs");
        let vertices = &model.meshes[0].primitives[0].positions;
        for i in 0..=16 {
            let t = i as f32 / 8.0 - 1.0;
            for crease in [vault.point(t, t), vault.point(t, -t)] {
                let nearest = vertices.iter().map(|at| at.distance(crease)).fold(f32::INFINITY, f32::min);
                // A piece is at most 0.36 m long, so that a ring of vertices is no farther than half of that.
                assert!(nearest < radius + 0.2, "no rib within {nearest} m of {crease}");
            }
        }
    }
}
