//! Where maps lie in an atlas.

use interfaces::visibility::{AtlasLayout, COLUMNS, ROWS, TILE};
use pass::{Extent, Facts, Value};
use std::collections::BTreeSet;

#[test]
fn every_map_has_a_place_of_its_own_in_the_layer_that_draws_it() {
    for (count, tile, side) in [
        (1, 1, 1),
        (5, 8, 8),
        (5, 8, 16),
        (9, 8, 16),
        (9, 8, 23),
        (1000, 16, 64),
        (1024, 64, 8192),
        (77, 3, 100),
    ] {
        let layout = AtlasLayout::new(count, tile, side).expect("they fit");
        let (width, height) = match layout.layer_size() {
            Extent::Fixed(width, height) => (width, height),
            extent => panic!("{extent:?}"),
        };
        assert!(width <= side && height <= side, "{layout:?}");
        let mut places = BTreeSet::new();
        for layer in 0..layout.layers() {
            assert!(!layout.maps(layer).is_empty(), "{layout:?}: layer {layer}");
            for map in layout.maps(layer) {
                let [x, y, of] = layout.origin(map);
                assert_eq!(of, layer, "{layout:?}: map {map}");
                assert!(x + tile <= width && y + tile <= height, "{layout:?}: map {map}");
                assert!(x % tile == 0 && y % tile == 0 && places.insert([x, y, of]), "{layout:?}: map {map}");
            }
        }
        assert_eq!(places.len(), count as usize);
        let values: Facts = layout.values().into_iter().collect();
        let side = |name| values.get(name).and_then(Value::as_u32).expect("a number");
        assert_eq!((side("atlas_width"), side("atlas_height")), (width, height), "{layout:?}");
        assert_eq!(side("atlas_layers"), layout.layers(), "{layout:?}");
        let (columns, rows) = (side("atlas_columns"), side("atlas_rows"));
        let facts = [(TILE.name, tile), (COLUMNS.name, columns), (ROWS.name, rows)];
        let facts: Facts = facts.into_iter().map(|(name, value)| (name, Value::U32(value))).collect();
        assert_eq!(AtlasLayout::of_facts(&facts, count), Some(layout));
    }
}

#[test]
fn the_maps_of_the_papers_fit() {
    let layers = |count, tile| AtlasLayout::new(count, tile, AtlasLayout::SIDE).map(|layout| layout.layers());
    assert_eq!(layers(1024, 64), Some(1));
    assert_eq!(layers(2048, 128), Some(1));
    assert_eq!(layers(2048, 256), Some(2));
    assert_eq!(layers(1024, 512), Some(4));
    assert_eq!(layers(1024, 1024), Some(16));
    assert_eq!(layers(256, 8192), Some(256));
    assert_eq!(layers(257, 8192), None);
    assert_eq!(AtlasLayout::most(8192, AtlasLayout::SIDE), 256);
    assert_eq!(layers(1, 8193), None);
}
