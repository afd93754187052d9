//! Closed buildings of one storey, drawn as plans: rooms with walls of strong colors, joined by corridors and
//! doorways, so that most of what light reaches is hidden from the camera. After the sequences of SMC-IR §5.

use glam::Vec3;

use super::builder::{Builder, MaterialId};
use crate::material::Material;
use crate::model::Model;

/// Side of a cell of a plan \[m\].
const CELL: f32 = 0.4;
/// Heights of doorways, and of rooms \[m\].
const HEIGHTS: [f32; 2] = [2.1, 2.6];

/// Colors of the walls, by the letters of plans; floor, ceiling, corridors and doorways come first.
const COLORS: [(char, &str, [f32; 3]); 9] = [
    ('_', "floor", [0.45, 0.41, 0.37]),
    ('-', "ceiling", [0.80, 0.79, 0.76]),
    ('.', "plaster", [0.72, 0.70, 0.66]),
    ('+', "door frame", [0.50, 0.42, 0.32]),
    ('r', "red", [0.70, 0.30, 0.30]),
    ('g', "green", [0.34, 0.62, 0.32]),
    ('b', "blue", [0.32, 0.42, 0.72]),
    ('y', "yellow", [0.76, 0.64, 0.32]),
    ('w', "white", [0.80, 0.80, 0.78]),
];

/// 12 m × 12 m: nine rooms between four corridors, each corridor with dead ends. x goes to the right, z down.
const MAZE: [&str; 30] = [
    "##############################",
    "#rrrrrrr#...#gggggg#...#bbbbb#",
    "#rrrrrrr#...#gggggg#...#bbbbb#",
    "#rrrrrrr#...#gggggg+...#bbbbb#",
    "#rrrrrrr#...#gggggg+...#bbbbb#",
    "#rrrrrrr#...#gggggg+...#bbbbb#",
    "#rrrrrrr#...#gggggg#...#bbbbb#",
    "###+++###...########...#+++###",
    "#............................#",
    "#............................#",
    "#............................#",
    "#########...###+++##...#######",
    "#wwwwwww#...#yyyyyy#...#rrrrr#",
    "#wwwwwww#####yyyyyy#...+rrrrr#",
    "#wwwwwww#...#yyyyyy#...+rrrrr#",
    "#wwwwwww+...#yyyyyy#...+rrrrr#",
    "#wwwwwww+...#yyyyyy#####rrrrr#",
    "#wwwwwww+...#yyyyyy#...#rrrrr#",
    "#########...###+++##...#######",
    "#............................#",
    "#............................#",
    "#............................#",
    "#########...##+++###...#+++###",
    "#bbbbbbb#...#wwwwww#...#ggggg#",
    "#bbbbbbb+...#wwwwww#...#ggggg#",
    "#bbbbbbb+...#wwwwww#...#ggggg#",
    "#bbbbbbb+...#wwwwww#...#ggggg#",
    "#bbbbbbb#...#wwwwww#...#ggggg#",
    "#bbbbbbb#...#wwwwww#...#ggggg#",
    "##############################",
];

/// 16.4 m × 5.2 m: five rooms along a corridor.
const CORRIDOR: [&str; 13] = [
    "#########################################",
    "#rrrrrrr#wwwwwww#ggggggg#yyyyyyy#bbbbbbb#",
    "#rrrrrrr#wwwwwww#ggggggg#yyyyyyy#bbbbbbb#",
    "#rrrrrrr#wwwwwww#ggggggg#yyyyyyy#bbbbbbb#",
    "#rrrrrrr#wwwwwww#ggggggg#yyyyyyy#bbbbbbb#",
    "#rrrrrrr#wwwwwww#ggggggg#yyyyyyy#bbbbbbb#",
    "#rrrrrrr#wwwwwww#ggggggg#yyyyyyy#bbbbbbb#",
    "###+++#####+++#####+++#####+++#####+++###",
    "#.......................................#",
    "#.......................................#",
    "#.......................................#",
    "#.......................................#",
    "#########################################",
];

/// Returns the maze, whose lights and walk its scene has.
pub(super) fn maze() -> Model {
    build("maze", &MAZE)
}

/// Returns the row of rooms along a corridor.
pub(super) fn corridor() -> Model {
    build("corridor", &CORRIDOR)
}

/// Builds a plan around the origin: floor and ceiling of each cell, and a wall wherever its neighbour is lower.
fn build(name: &str, plan: &[&str]) -> Model {
    let mut builder = Builder::default();
    let materials =
        COLORS.map(|(letter, name, albedo)| (letter, builder.material(Material::matte(name, albedo))));
    let material = |letter: char| -> MaterialId {
        let found = materials.iter().find(|(known, _)| *known == letter);
        found.expect("plans have letters of colors").1
    };
    let cells: Vec<Vec<char>> = plan.iter().map(|row| row.chars().collect()).collect();
    let (rows, columns) = (cells.len(), cells[0].len());
    let at = |column: usize, row: usize, y: f32| {
        let [x, z] = [(column, columns), (row, rows)].map(|(i, n)| (i as f32 - 0.5 * n as f32) * CELL);
        Vec3::new(x, y, z)
    };
    // The border of a plan is wall, so that every other cell has four neighbours.
    let open = (1..rows - 1).flat_map(|row| (1..columns - 1).map(move |column| (column, row)));
    for (i, k) in open.filter(|(i, k)| cells[*k][*i] != '#') {
        let (letter, top) = (cells[k][i], height(cells[k][i]));
        let corners = [(i, k + 1), (i + 1, k + 1), (i + 1, k), (i, k)];
        builder.quad(material('_'), corners.map(|(i, k)| at(i, k, 0.0)));
        let mut above = corners.map(|(i, k)| at(i, k, top));
        above.reverse();
        builder.quad(material('-'), above);
        // Beside each neighbour, the ends of its edge from left to right, seen from within.
        let sides = [
            (cells[k - 1][i], [(i, k), (i + 1, k)]),
            (cells[k + 1][i], [(i + 1, k + 1), (i, k + 1)]),
            (cells[k][i - 1], [(i, k + 1), (i, k)]),
            (cells[k][i + 1], [(i + 1, k), (i + 1, k + 1)]),
        ];
        for (beside, [left, right]) in sides {
            // In two pieces, whose edges match those of doorways.
            for [low, high] in [[0.0, HEIGHTS[0]], HEIGHTS] {
                if height(beside) <= low && high <= top {
                    let corner = |(i, k): (usize, usize), y| at(i, k, y);
                    let corners =
                        [corner(left, low), corner(right, low), corner(right, high), corner(left, high)];
                    builder.quad(material(letter), corners);
                }
            }
        }
    }
    builder.finish(name)
}

/// Returns the height of a cell \[m\]; 0 for a wall.
fn height(letter: char) -> f32 {
    match letter {
        '#' => 0.0,
        '+' => HEIGHTS[0],
        _ => HEIGHTS[1],
    }
}
