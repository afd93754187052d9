//! The data of the host program by the names of its WGSL globals, and which part of it each belongs to.

use crate::record::request_of_module;
use frame_graph::{Externals, Module, OutputDesc};
use shader_library::Library;

/// Every global that is bound without a link, and what a change of it counts as.
pub static GLOBALS: &[(&str, Externals)] = &[
    ("camera", Externals::CAMERA),
    ("frame", Externals::FRAME),
    ("scene_info", Externals::SCENE),
    ("scene_vertices", Externals::SCENE),
    ("scene_indices", Externals::SCENE),
    ("scene_materials", Externals::SCENE),
    ("scene_area_table", Externals::SCENE),
    ("scene_bvh", Externals::SCENE),
    ("scene_bvh_triangles", Externals::SCENE),
    // Only on adapters that have ray queries.
    ("scene_acceleration", Externals::SCENE),
    ("scene_textures", Externals::SCENE),
    ("scene_textures_linear", Externals::SCENE),
    ("scene_sampler", Externals::SCENE),
    ("scene_lights", Externals::LIGHTS),
    ("scene_light_layers", Externals::LIGHTS),
    // Constant: for shaders of users that sample textures. Edges are clamped.
    ("linear_sampler", Externals::NONE),
    ("nearest_sampler", Externals::NONE),
];

/// Returns what a global of that name belongs to; `None` where it is no data of the host program.
pub fn of_global(name: &str) -> Option<Externals> {
    GLOBALS.iter().find(|(global, _)| *global == name).map(|(_, externals)| *externals)
}

/// The names of what a scene says of itself: [`RecordContext::traits`](crate::RecordContext) has each of them. An
/// `#option` of a user's shader that is named so, in capitals, is set by the scene.
pub const TRAITS: [&str; 14] = [
    "textured",
    "glossy",
    "emissive",
    "masked",
    "environment",
    "moving_camera",
    "moving_lights",
    "moving_geometry",
    "lights",
    "spot_lights",
    "point_lights",
    "directional_lights",
    "light_layers",
    "triangles",
];

/// Fills in the externals of the modules that outputs bring: what the functions of each module's file read.
///
/// A module that cannot be loaded keeps what it has: the error is told, with its place, where a reader's shader is
/// loaded.
pub fn find_of_modules(outputs: &mut [OutputDesc], library: &Library) {
    for output in outputs {
        if let Some(module) = output.facts.module_mut() {
            module.externals = of_module(module, library).unwrap_or(module.externals);
        }
    }
}

/// Returns what the functions of a module's file read; `None` where the file cannot be loaded.
pub fn of_module(module: &Module, library: &Library) -> Option<Externals> {
    let shader = library.load(&request_of_module(module)).ok()?;
    Some(shader.used_by_own_functions().filter_map(of_global).fold(Externals::NONE, Externals::and))
}
