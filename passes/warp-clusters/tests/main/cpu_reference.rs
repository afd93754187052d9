//! The CPU reference of warp-clusters.wgsl in `f64`, which needs no scaling by powers of two.

use interfaces::clusters::{Cluster, NO_TEXEL, state};

/// A texel of a reflective shadow map.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Texel {
    /// Position in world space \[m\]; `None` where the texel is unlit.
    pub(crate) position: Option<[f32; 3]>,
    /// Unit normal.
    pub(crate) normal: [f32; 3],
    /// Flux \[W\].
    pub(crate) flux: [f32; 3],
    /// Importance, as it is given.
    pub(crate) importance: f32,
}

/// Importance that counts: NaN and what is negative are 0, infinity is the greatest number, unlit is 0.
pub(crate) fn importance_of_texel(texel: &Texel) -> f64 {
    match texel.position {
        Some(_) if texel.importance > 0.0 => f64::from(texel.importance.min(f32::MAX)),
        _ => 0.0,
    }
}

/// A reflective shadow map, and the sums of its importance.
#[derive(Clone, Debug)]
pub(crate) struct Pyramid {
    /// Texels, by layer and row.
    pub(crate) texels: Vec<Texel>,
    /// Columns and rows.
    pub(crate) size: [u32; 2],
    /// Number of layers.
    pub(crate) layers: u32,
    /// Sums by level, layer and row; level 0 is the texels.
    pub(crate) sums: Vec<Vec<f64>>,
}

/// A place in the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    /// The layer.
    pub(crate) layer: u32,
    /// \[texels\]
    pub(crate) uv: [f64; 2],
}

impl Pyramid {
    /// Sums all levels.
    pub(crate) fn new(texels: Vec<Texel>, size: [u32; 2]) -> Pyramid {
        let layers = texels.len() as u32 / (size[0] * size[1]);
        let finest = texels.iter().map(importance_of_texel).collect();
        let mut pyramid = Pyramid { texels, size, layers, sums: vec![finest] };
        let top = size[0].max(size[1]).next_power_of_two().ilog2().max(1);
        for level in 1..=top {
            pyramid.sums.push(pyramid.sum(level));
        }
        pyramid
    }

    /// Returns the level of one square.
    pub(crate) fn top(&self) -> u32 {
        self.sums.len() as u32 - 1
    }

    /// Returns columns and rows of a level.
    pub(crate) fn size_at(&self, level: u32) -> [u32; 2] {
        self.size.map(|side| side.div_ceil(1 << level))
    }

    /// Returns the sum over a square of any level; 0 beyond the edges.
    pub(crate) fn sum_at(&self, level: u32, layer: u32, [x, y]: [u32; 2]) -> f64 {
        let [columns, rows] = self.size_at(level);
        if x >= columns || y >= rows {
            return 0.0;
        }
        self.sums[level as usize][((layer * rows + y) * columns + x) as usize]
    }

    /// Returns the sums of the four squares in each square of a level.
    fn sum(&self, level: u32) -> Vec<f64> {
        let [columns, rows] = self.size_at(level);
        let squares = (0..self.layers)
            .flat_map(|layer| (0..rows).flat_map(move |y| (0..columns).map(move |x| (layer, 2 * x, 2 * y))));
        let four = |(layer, x, y)| {
            [[0, 0], [1, 0], [0, 1], [1, 1]]
                .map(|[i, j]| self.sum_at(level - 1, layer, [x + i, y + j]))
                .iter()
                .sum()
        };
        squares.map(four).collect()
    }

    /// Chooses a layer by a number in \[0, 1), in proportion to its sum; each alike if all sums are 0. Returns it with
    /// the rest of the number.
    pub(crate) fn choose_layer(&self, number: f64) -> (u32, f64) {
        let sums = &self.sums[self.top() as usize];
        let total: f64 = sums.iter().sum();
        if total == 0.0 {
            let at = number * f64::from(self.layers);
            return (at as u32, at.fract());
        }
        let sought = number * total;
        let mut before = 0.0;
        for (layer, width) in (0..).zip(sums) {
            if before + width > sought {
                return (layer, (sought - before) / width);
            }
            before += width;
        }
        unreachable!("a number below 1 is below the total")
    }

    /// Returns where a seed goes, if it descends to a level.
    pub(crate) fn warp_seed(&self, seed: [f64; 2], bottom: u32) -> Place {
        let (layer, x) = self.choose_layer(seed[0]);
        let mut rest = [x, seed[1]];
        let mut square = [0, 0];
        let mut level = self.top();
        while self.sum_at(self.top(), layer, [0, 0]) > 0.0 && level > bottom {
            level -= 1;
            square = square.map(|at| 2 * at);
            let [[upper_left, upper_right], [lower_left, lower_right]] =
                [0, 1].map(|j| [0, 1].map(|i| self.sum_at(level, layer, [square[0] + i, square[1] + j])));
            let (row, y) = choose(rest[1], upper_left + upper_right, lower_left + lower_right);
            let (left, right) = if row == 1 { (lower_left, lower_right) } else { (upper_left, upper_right) };
            let (column, x) = choose(rest[0], left, right);
            square = [square[0] + column, square[1] + row];
            rest = [x, y];
        }
        let uv = [0, 1].map(|axis| {
            let corner = square[axis] << level;
            let end = (corner + (1 << level)).min(self.size[axis]);
            let at = f64::from(corner) + rest[axis] * f64::from(end - corner);
            at.min(f64::from((end as f32).next_down()))
        });
        Place { layer, uv }
    }

    /// Returns the number of the texel at a place, through rows and layers.
    pub(crate) fn texel_at(&self, place: &Place) -> u32 {
        let [x, y] = place.uv.map(|at| at as u32);
        (place.layer * self.size[1] + y) * self.size[0] + x
    }

    /// Returns whether there is a surface at a place.
    pub(crate) fn is_lit(&self, place: &Place) -> bool {
        let texel = &self.texels[self.texel_at(place) as usize];
        texel.position.is_some() && texel.normal != [0.0; 3]
    }

    /// Returns the cluster at a place, with what the map has there; of an unlit texel, one that waits to be seeded.
    pub(crate) fn cluster_at(&self, place: &Place, generation: u32) -> Cluster {
        let waiting = Cluster { texel: NO_TEXEL, generation, state: state::TO_SEED, ..Cluster::default() };
        if !self.is_lit(place) {
            return waiting;
        }
        let index = self.texel_at(place);
        let texel = &self.texels[index as usize];
        Cluster {
            position: texel.position.unwrap_or_default(),
            normal: texel.normal,
            flux: texel.flux,
            centre_flux: texel.flux,
            texel: index,
            uv: place.uv.map(|at| at as f32),
            layer: place.layer,
            state: state::ALIVE,
            ..waiting
        }
    }

    /// Returns what becomes of a cluster; `halton` returns an element of the sequence of seeds.
    pub(crate) fn warp(
        &self,
        index: u32,
        count: u32,
        cluster: &Cluster,
        bottom: u32,
        halton: impl Fn(u32) -> [f64; 2],
    ) -> Cluster {
        let generation = cluster.generation;
        let seeded = |seed, generation| self.cluster_at(&self.warp_seed(seed, bottom), generation);
        match cluster.state {
            state::SEEDED => seeded(cluster.uv.map(f64::from), generation),
            state::PLACED => {
                let within = |axis: usize| {
                    f64::from(cluster.uv[axis]).clamp(0.0, f64::from((self.size[axis] as f32).next_down()))
                };
                let place = Place { layer: cluster.layer.min(self.layers - 1), uv: [within(0), within(1)] };
                if self.is_lit(&place) {
                    return self.cluster_at(&place, generation);
                }
                let element = count.wrapping_mul(generation).wrapping_add(index).wrapping_add(1);
                seeded(halton(element), generation + 1)
            }
            _ => *cluster,
        }
    }
}

/// Chooses one of two by a number in \[0, 1), in proportion to their sums. Returns it with the rest of the number.
pub(crate) fn choose(number: f64, first: f64, second: f64) -> (u32, f64) {
    let sought = number * (first + second);
    if sought < first { (0, sought / first) } else { (1, (sought - first) / second) }
}
