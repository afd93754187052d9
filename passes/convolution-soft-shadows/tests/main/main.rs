//! Basis images and soft lookups: the CPU reference against closed forms and brute force, the GPU against the CPU reference.

mod basis;
mod cpu_reference;
mod lookups;
mod refusals;

use convolution_soft_shadows::PASS;
use cpu_reference::{Expansion, Map};
use interfaces::virtual_lights::VirtualLight;
use pass::{Format, ResourceDesc};
use pass_test::Harness;
use pass_test::random::{hash, unit_float};
use pass_test::visibility::{Receiver, lookups};

const MODULE: &str = "passes/convolution-soft-shadows/lookup.wgsl";
const NOTHING: f64 = 3.0e38;
/// The depth bias of all lookups.
const DEPTH_BIAS: f64 = 0.02;

/// The pass's defaults for maps with sides of `tile`, but wider penumbrae.
fn expansion(tile: u32, order: u32) -> Expansion {
    Expansion {
        order,
        levels: tile.next_power_of_two().ilog2(),
        attenuation: 1.5,
        offset: 0.6,
        search: 2,
        nearest: 0.25,
        depth_bias: DEPTH_BIAS,
    }
}

/// Random numbers.
struct Random(u32);

impl Random {
    /// A number in [0, 1).
    fn unit(&mut self) -> f64 {
        self.0 = hash(self.0);
        unit_float(self.0)
    }

    fn below(&mut self, end: u32) -> u32 {
        (self.unit() * f64::from(end)) as u32
    }
}

/// Maps beside each other in a row of one layer, of which each is filled map by map.
#[derive(Clone, Debug)]
struct Atlas {
    tile: u32,
    maps: Vec<Vec<f64>>,
}

impl Atlas {
    /// Maps of three sorts of texels, mixed at random: nothing, and distances of 0.5 m to 2 m in patches.
    fn rough(tile: u32, count: u32) -> Atlas {
        let mut random = Random(7);
        let map = |_| {
            let patch = 1 + random.below(3);
            let patches: Vec<f64> = (0..tile * tile).map(|_| 0.5 + 1.5 * random.unit()).collect();
            let open: Vec<bool> = (0..tile * tile).map(|_| random.below(4) == 0).collect();
            let stored = |i: u32| {
                let of_patch = (i / tile / patch * tile + i % tile / patch) as usize;
                if open[of_patch] { NOTHING } else { f64::from(patches[of_patch] as f32) }
            };
            (0..tile * tile).map(stored).collect()
        };
        Atlas { tile, maps: (0..count).map(map).collect() }
    }

    fn member(&self) -> (&'static str, ResourceDesc, Vec<u8>) {
        let (tile, count) = (self.tile as usize, self.maps.len());
        let mut texels = vec![0.0_f32; tile * tile * count];
        for (m, map) in self.maps.iter().enumerate() {
            for (i, distance) in map.iter().enumerate() {
                texels[(i / tile * count + m) * tile + i % tile] = *distance as f32;
            }
        }
        let desc = ResourceDesc::texture_2d_array(Format::R32Float, (self.tile * count as u32, self.tile), 1);
        ("atlas", desc, bytemuck::cast_slice(&texels).to_vec())
    }

    fn facts(&self) -> [(&'static str, u32); 3] {
        [("tile", self.tile), ("columns", self.maps.len() as u32), ("rows", 1)]
    }

    /// The words of the basis images that the pass makes. `None` where there is no adapter.
    fn basis(&self, by: Expansion) -> Option<Vec<u32>> {
        let outputs = Harness::new(PASS)
            .set("order", by.order)
            .set("levels", by.levels)
            .set("attenuation", by.attenuation as f32)
            .set("offset", by.offset as f32)
            .set("search", by.search)
            .set("nearest", by.nearest as f32)
            .input("maps", "Visibility", &self.facts(), vec![self.member()])
            .fact("depth_bias", by.depth_bias as f32)
            .fact("slope_bias", 0.0)
            .run()?;
        Some(outputs.read("visibility.basis"))
    }

    /// The visibility of its light from each receiver by the GPU, with these basis images.
    fn answers_with(
        &self,
        module: &str,
        by: Expansion,
        basis: &[u32],
        lights: &[VirtualLight],
        receivers: &[Receiver],
    ) -> Option<Vec<f32>> {
        let bytes: Vec<u8> = bytemuck::cast_slice(basis).to_vec();
        let images = ("basis", pass_test::buffer(bytes.len() as u64), bytes);
        let outputs = lookups(lights, receivers)
            .input("visibility", "Visibility", &self.facts(), vec![self.member(), images])
            .fact("depth_bias", by.depth_bias as f32)
            .fact("slope_bias", 0.0)
            .fact("order", by.order)
            .fact("levels", by.levels)
            .fact("attenuation", by.attenuation as f32)
            .fact("offset", by.offset as f32)
            .fact("search", by.search)
            .fact("nearest", by.nearest as f32)
            .fact("stride", stride(self.tile, by) as u32)
            .module(module)
            .run()?;
        Some(outputs.read("answers"))
    }

    fn answers(&self, by: Expansion, area: f32, receivers: &[Receiver]) -> Option<Vec<f32>> {
        let lights = vec![light(area); self.maps.len()];
        self.answers_with(MODULE, by, &self.basis(by)?, &lights, receivers)
    }

    fn reference(&self, by: Expansion) -> Vec<Map> {
        self.maps.iter().map(|distances| Map::new(distances.clone(), self.tile, by)).collect()
    }
}

/// The words of a map in the buffer, which ends with some that no map has.
fn stride(tile: u32, by: Expansion) -> usize {
    let texels: u32 = (1..=by.levels).map(|level| tile.div_ceil(1 << level).pow(2)).sum();
    (1 + texels * (2 * by.order + 1)) as usize
}

fn light(area: f32) -> VirtualLight {
    VirtualLight { normal: [0.0, 0.0, 1.0], flux: [1.0; 3], area, ..VirtualLight::default() }
}
