//! The Cornell box.
//!
//! Geometry: the measured data of Cornell University's Program of Computer Graphics
//! (graphics.cornell.edu/online/box/data.html), converted from millimetres to metres. The box is open towards
//! the camera at z < 0; red is on the left, at large x. Colors: the measured reflectances converted to
//! linear Rec. 709, with the values of the Computer Graphics Archive (McGuire 2017, CornellBox-Original).

use glam::{Vec3, Vec4};

use super::builder::Builder;
use crate::material::Material;
use crate::model::Model;

const WHITE: [f32; 3] = [0.725, 0.71, 0.68];
const RED: [f32; 3] = [0.63, 0.065, 0.05];
const GREEN: [f32; 3] = [0.14, 0.45, 0.091];
/// The lamp's reflectance, and its radiance \[W/(m² sr)\]: the archive's values.
const LAMP: [f32; 3] = [0.78, 0.78, 0.78];
const LAMP_RADIANCE: [f32; 3] = [17.0, 12.0, 4.0];
/// Distance of the lamp from the ceiling \[mm\], so that the two do not coincide.
const LAMP_GAP: f32 = 0.5;

/// Corners of a quad, in millimetres.
type Corners = [[f32; 3]; 4];

const FLOOR: Corners = [[552.8, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 559.2], [549.6, 0.0, 559.2]];
const CEILING: Corners = [[556.0, 548.8, 0.0], [556.0, 548.8, 559.2], [0.0, 548.8, 559.2], [0.0, 548.8, 0.0]];
const BACK: Corners = [[549.6, 0.0, 559.2], [0.0, 0.0, 559.2], [0.0, 548.8, 559.2], [556.0, 548.8, 559.2]];
const RIGHT: Corners = [[0.0, 0.0, 559.2], [0.0, 0.0, 0.0], [0.0, 548.8, 0.0], [0.0, 548.8, 559.2]];
const LEFT: Corners = [[552.8, 0.0, 0.0], [549.6, 0.0, 559.2], [556.0, 548.8, 559.2], [556.0, 548.8, 0.0]];
const LAMP_CORNERS: Corners =
    [[343.0, 548.8, 227.0], [343.0, 548.8, 332.0], [213.0, 548.8, 332.0], [213.0, 548.8, 227.0]];
const SHORT_BLOCK: [Corners; 5] = [
    [[130.0, 165.0, 65.0], [82.0, 165.0, 225.0], [240.0, 165.0, 272.0], [290.0, 165.0, 114.0]],
    [[290.0, 0.0, 114.0], [290.0, 165.0, 114.0], [240.0, 165.0, 272.0], [240.0, 0.0, 272.0]],
    [[130.0, 0.0, 65.0], [130.0, 165.0, 65.0], [290.0, 165.0, 114.0], [290.0, 0.0, 114.0]],
    [[82.0, 0.0, 225.0], [82.0, 165.0, 225.0], [130.0, 165.0, 65.0], [130.0, 0.0, 65.0]],
    [[240.0, 0.0, 272.0], [240.0, 165.0, 272.0], [82.0, 165.0, 225.0], [82.0, 0.0, 225.0]],
];
const TALL_BLOCK: [Corners; 5] = [
    [[423.0, 330.0, 247.0], [265.0, 330.0, 296.0], [314.0, 330.0, 456.0], [472.0, 330.0, 406.0]],
    [[423.0, 0.0, 247.0], [423.0, 330.0, 247.0], [472.0, 330.0, 406.0], [472.0, 0.0, 406.0]],
    [[472.0, 0.0, 406.0], [472.0, 330.0, 406.0], [314.0, 330.0, 456.0], [314.0, 0.0, 456.0]],
    [[314.0, 0.0, 456.0], [314.0, 330.0, 456.0], [265.0, 330.0, 296.0], [265.0, 0.0, 296.0]],
    [[265.0, 0.0, 296.0], [265.0, 330.0, 296.0], [423.0, 330.0, 247.0], [423.0, 0.0, 247.0]],
];

/// Returns the box without a lamp, for lights without extent.
pub(super) fn cornell_box() -> Model {
    build().finish("cornell-box")
}

/// Returns the box with its lamp, a quad that emits (17, 12, 4) W/(m² sr).
pub(super) fn cornell_box_lamp() -> Model {
    let mut builder = build();
    let lamp = builder.material(Material {
        name: "lamp".into(),
        base_color: Vec4::from((Vec3::from(LAMP), 1.0)),
        emission: LAMP_RADIANCE.into(),
        ..Material::default()
    });
    builder.quad(lamp, metres(LAMP_CORNERS.map(|[x, y, z]| [x, y - LAMP_GAP, z])));
    builder.finish("cornell-box-lamp")
}

fn build() -> Builder {
    let mut builder = Builder::default();
    let white = builder.material(Material::matte("white", WHITE));
    let red = builder.material(Material::matte("red", RED));
    let green = builder.material(Material::matte("green", GREEN));
    for corners in [FLOOR, CEILING, BACK].into_iter().chain(SHORT_BLOCK).chain(TALL_BLOCK) {
        builder.quad(white, metres(corners));
    }
    builder.quad(green, metres(RIGHT));
    builder.quad(red, metres(LEFT));
    builder
}

/// Converts corners to metres, counter-clockwise seen from inside the box or outside a block: in the data
/// they are clockwise in a right-handed system.
fn metres(corners: Corners) -> [Vec3; 4] {
    corners.map(|corner| Vec3::from(corner) / 1000.0)
}
