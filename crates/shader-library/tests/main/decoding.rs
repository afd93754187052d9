//! Bytes of buffers as tables.

use crate::shader;
use proptest::prelude::*;
use shader_library::decode::{BufferLayout, Cell, MAX_NUMBERS, Number};
use shader_library::{GlobalKind, Shader};

const SHADER: &str = "
struct Surface { uv: vec2<f32>, index: u32 }
struct Light {
    position: vec3<f32>,
    area: f32,
    surface: Surface,
    shift: vec2<i32>,
    frame: mat3x3<f32>,
    weights: array<vec3<f32>, 2>,
    corners: array<Surface, 2>,
}
struct Lights { count: u32, bound: vec3<f32>, inner: Surface, list: array<Light> }
struct Histogram { total: atomic<u32>, least: atomic<i32>, bins: array<atomic<u32>, 3> }
struct Counts { drawn: u32, box_: array<vec3<f32>, 2> }

var<storage, read> lights: Lights;
var<storage, read_write> histogram: Histogram;
var<storage, read> counts: Counts;
var<storage, read> plain: array<vec2<u32>>;
var<storage, read> fixed: array<f32, 4>;
var<storage, read> nested: array<array<f32, 2>, 3>;
var<storage, read_write> single: atomic<u32>;

@compute @workgroup_size(1) fn main() {
    _ = lights.count;
    _ = counts.drawn;
    _ = plain[0];
    _ = fixed[0];
    _ = nested[0][0];
    _ = atomicLoad(&histogram.total) + atomicLoad(&single);
}
";

fn layout(shader: &Shader, global: &str) -> BufferLayout {
    let (_, global) = shader.interface.global(global).unwrap();
    let GlobalKind::Storage { layout, .. } = &global.kind else { panic!("{:?}", global.kind) };
    BufferLayout::new(&shader.interface, layout)
}

/// Words that count from 0: the number in a cell shows where it was read.
fn counting(words: u32) -> Vec<u8> {
    (0..words).flat_map(u32::to_le_bytes).collect()
}

fn at(places: &[u32]) -> Cell {
    Cell(places.iter().map(|at| Number::U32(*at)).collect())
}

/// Floats whose bits count up, read back as places.
fn bits(cell: &Cell) -> Vec<u32> {
    let bits = |number: &Number| match number {
        Number::F32(x) => x.to_bits(),
        Number::U32(n) => *n,
        Number::I32(n) => *n as u32,
    };
    cell.0.iter().map(bits).collect()
}

#[test]
fn a_struct_with_an_array_is_a_header_and_rows() {
    let shader = shader(SHADER);
    let layout = layout(&shader, "lights");
    // By the WGSL specification, §14.4: the header takes 48 bytes, a Light 160.
    let bytes = counting(12 + 2 * 40 + 5);
    let table = layout.table(&bytes);
    let header: Vec<(&str, Vec<u32>)> =
        table.header().map(|(column, cell)| (column.name.as_str(), bits(&cell))).collect();
    let expected =
        [("count", vec![0]), ("bound", vec![4, 5, 6]), ("inner.uv", vec![8, 9]), ("inner.index", vec![10])];
    assert_eq!(header, expected);
    assert_eq!((table.len(), table.rest(), table.row(2)), (2, 20, Vec::new()));
    let rows = [0, 1].map(|row| {
        let cells = table.row(row);
        let names = table.columns().iter().map(|column| column.name.as_str());
        names.zip(cells.iter().map(bits)).collect::<Vec<_>>()
    });
    let light = |from: u32| {
        let numbers = |places: &[u32]| places.iter().map(|at| from + at).collect::<Vec<_>>();
        vec![
            ("position", numbers(&[0, 1, 2])),
            ("area", numbers(&[3])),
            ("surface.uv", numbers(&[4, 5])),
            ("surface.index", numbers(&[6])),
            ("shift", numbers(&[8, 9])),
            ("frame", numbers(&[12, 13, 14, 16, 17, 18, 20, 21, 22])),
            ("weights", numbers(&[24, 25, 26, 28, 29, 30])),
            ("corners[0].uv", numbers(&[32, 33])),
            ("corners[0].index", numbers(&[34])),
            ("corners[1].uv", numbers(&[36, 37])),
            ("corners[1].index", numbers(&[38])),
        ]
    };
    assert_eq!(rows, [light(12), light(12 + 40)], "{layout:#?}");
}

#[test]
fn numbers_are_of_the_type_that_wgsl_declares() {
    let shader = shader(SHADER);
    let mut bytes = vec![0; 48 + 160];
    bytes[48..52].copy_from_slice(&1.5_f32.to_le_bytes());
    bytes[48 + 32..48 + 36].copy_from_slice(&(-7_i32).to_le_bytes());
    let layout = layout(&shader, "lights");
    let row = layout.table(&bytes).row(0);
    let shown: Vec<String> = row.iter().map(Cell::to_string).collect();
    assert_eq!(shown[0], "(1.5, 0, 0)");
    assert_eq!(shown[3], "0");
    assert_eq!(shown[4], "(-7, 0)");
    let types: Vec<&str> = layout.columns.iter().map(|column| column.ty.as_str()).collect();
    assert_eq!(types[..5], ["vec3<f32>", "f32", "vec2<f32>", "u32", "vec2<i32>"]);
    assert_eq!((layout.columns[4].offset, layout.ty.as_str()), (32, "Lights"));
}

#[test]
fn arrays_of_fixed_size_end_where_their_type_says() {
    let shader = shader(SHADER);
    let bytes = counting(8);
    let histogram = layout(&shader, "histogram");
    let table = histogram.table(&bytes);
    let header: Vec<Cell> = table.header().map(|(_, cell)| cell).collect();
    assert_eq!(header, [at(&[0]), Cell(vec![Number::I32(1)])]);
    assert_eq!((table.len(), table.rest(), table.row(2)), (3, 12, vec![at(&[4])]));
    assert_eq!(table.columns()[0].name, "bins");
    let fixed = layout(&shader, "fixed");
    assert_eq!((fixed.table(&bytes).len(), fixed.columns[0].name.as_str()), (4, "value"));
    let nested = layout(&shader, "nested");
    assert_eq!((nested.table(&bytes).len(), bits(&nested.table(&bytes).row(2)[0])), (3, vec![4, 5]));
    let counts = layout(&shader, "counts");
    let table = counts.table(&bytes);
    assert_eq!((table.len(), bits(&table.row(0)[0])), (1, vec![4, 5, 6]), "a vec3 is padded to four words");
}

#[test]
fn plain_numbers_have_one_column() {
    let shader = shader(SHADER);
    let bytes = counting(5);
    let plain = layout(&shader, "plain");
    assert_eq!((plain.table(&bytes).len(), plain.table(&bytes).rest()), (2, 4));
    assert_eq!(plain.table(&bytes).row(1), [at(&[2, 3])]);
    let single = layout(&shader, "single");
    let table = single.table(&bytes);
    let header: Vec<(&str, Cell)> =
        table.header().map(|(column, cell)| (column.name.as_str(), cell)).collect();
    assert_eq!((header, table.is_empty(), table.rest()), (vec![("value", at(&[0]))], true, 16));
}

#[test]
fn great_arrays_are_bounded() {
    let shader = shader(
        "struct Cell { value: f32 }
        struct Grid { cells: array<Cell, 100000>, heights: array<f32, 100000>, last: u32 }
        var<storage> grids: array<Grid>;
        @compute @workgroup_size(1) fn main() { _ = grids[0].last; }",
    );
    let layout = layout(&shader, "grids");
    let names: Vec<&str> = layout.columns.iter().map(|column| column.name.as_str()).collect();
    assert_eq!(names[510..], ["cells[510].value", "cells[511].value", "cells[512..]", "heights", "last"]);
    let bytes = counting(200_001);
    let row = layout.table(&bytes).row(0);
    assert_eq!(bits(&row[512])[..2], [512, 513]);
    assert_eq!((bits(&row[513])[0], row[513].0.len(), bits(&row[514])[0]), (100_000, MAX_NUMBERS, 200_000));
}

proptest! {
    #[test]
    fn any_bytes_are_a_table(bytes in prop::collection::vec(any::<u8>(), 0..600)) {
        let shader = shader(SHADER);
        for global in ["lights", "histogram", "counts", "plain", "fixed", "nested", "single"] {
            let layout = layout(&shader, global);
            let table = layout.table(&bytes);
            prop_assert_eq!(table.header().count(), layout.header.len());
            for index in 0..table.len() {
                prop_assert_eq!(table.row(index).len(), layout.columns.len());
                prop_assert!(table.row(index).iter().all(|cell| !cell.0.is_empty()), "{}", global);
            }
            prop_assert!(table.row(table.len()).is_empty() && table.rest() <= bytes.len());
        }
    }
}
