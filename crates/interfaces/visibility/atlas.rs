//! Maps of one size in the layers of a texture array.

use super::{COLUMNS, ROWS, TILE};
use pass::{Extent, Facts, Format, ResourceDesc, Value};
use std::ops::Range;

/// The arrangement of square maps of one size in an atlas: row by row, layer after layer. `tile_origin` of
/// `shaders/paraboloid.wgsl` finds a map by the facts `tile`, `columns` and `rows`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AtlasLayout {
    tile: u32,
    count: u32,
    columns: u32,
    rows: u32,
}

impl AtlasLayout {
    /// The greatest side of a layer \[px\] that every adapter allows: WebGPU's default.
    pub const SIDE: u32 = 8192;
    /// The distance of a texel without a surface, for the clear value of a layer: `NOTHING` of
    /// `shaders/paraboloid.wgsl`.
    pub const NOTHING: f64 = 3.0e38;
    /// The most layers that every adapter allows: WebGPU's default.
    pub const LAYERS: u32 = 256;

    /// Arranges `count` maps with sides of `tile` \[px\] in as few layers as possible, whose sides are at most
    /// `side` \[px\]; `None` where there are more than [`AtlasLayout::most`].
    pub fn new(count: u32, tile: u32, side: u32) -> Option<AtlasLayout> {
        if count == 0 || u64::from(count) > Self::most(tile, side) {
            return None;
        }
        let along = side / tile;
        let of_layer = count.div_ceil(count.div_ceil(along * along));
        // The narrowest: where texels lie row by row, those of a map are near each other.
        let columns = of_layer.div_ceil(along);
        Some(AtlasLayout { tile, count, columns, rows: of_layer.div_ceil(columns) })
    }

    /// Returns how many maps an atlas holds.
    pub fn most(tile: u32, side: u32) -> u64 {
        u64::from(Self::LAYERS) * u64::from(side / tile.max(1)).pow(2)
    }

    /// Returns the layout that the facts of a port describe, for `count` maps; `None` if they describe none.
    pub fn of_facts(facts: &Facts, count: u32) -> Option<AtlasLayout> {
        let fact = |fact: pass::Fact<u32>| fact.of(facts).filter(|value| *value > 0);
        Some(AtlasLayout { tile: fact(TILE)?, count, columns: fact(COLUMNS)?, rows: fact(ROWS)? })
    }

    /// Returns what the directives of a pass name that renders maps into an atlas: `atlas_width` and `atlas_height` \[px\],
    /// `atlas_layers`, `atlas_columns` and `atlas_rows`.
    pub fn values(&self) -> [(&'static str, Value); 5] {
        [
            ("atlas_width", (self.columns * self.tile).into()),
            ("atlas_height", (self.rows * self.tile).into()),
            ("atlas_layers", self.layers().into()),
            ("atlas_columns", self.columns.into()),
            ("atlas_rows", self.rows.into()),
        ]
    }

    /// Returns the texture array.
    pub fn texture(&self, format: Format) -> ResourceDesc<Extent> {
        ResourceDesc::texture_2d_array(format, self.layer_size(), self.layers())
    }

    /// Returns the size of a layer.
    pub fn layer_size(&self) -> Extent {
        Extent::Fixed(self.columns * self.tile, self.rows * self.tile)
    }

    /// Returns how many layers there are.
    pub fn layers(&self) -> u32 {
        self.count.div_ceil(self.maps_of_layer())
    }

    /// Returns the maps along a row of a layer.
    pub fn columns(&self) -> u32 {
        self.columns
    }

    /// Returns the rows of maps in a layer.
    pub fn rows(&self) -> u32 {
        self.rows
    }

    /// Returns how many maps a layer has room for.
    pub fn maps_of_layer(&self) -> u32 {
        self.columns * self.rows
    }

    /// Returns the maps of a layer.
    pub fn maps(&self, layer: u32) -> Range<u32> {
        let all = self.maps_of_layer();
        layer * all..((layer + 1) * all).min(self.count)
    }

    /// Returns the column, row and layer of a map's first texel.
    pub fn origin(&self, map: u32) -> [u32; 3] {
        let row = map / self.columns;
        [map % self.columns * self.tile, row % self.rows * self.tile, row / self.rows]
    }
}
