//! The scene bindings by the names of their WGSL globals, and which part of the scene data each belongs to.

use crate::record::request_of_module;
use frame_graph::{Module, OutputDesc, SceneBindings};
use shader_library::Library;

/// Every global that is bound without a link, and the scene binding that changes with it.
pub static GLOBALS: &[(&str, SceneBindings)] = &[
    ("camera", SceneBindings::CAMERA),
    ("frame", SceneBindings::FRAME),
    ("scene_info", SceneBindings::SCENE),
    ("scene_vertices", SceneBindings::SCENE),
    ("scene_indices", SceneBindings::SCENE),
    ("scene_previous_positions", SceneBindings::PREVIOUS),
    ("scene_materials", SceneBindings::SCENE),
    ("scene_area_table", SceneBindings::SCENE),
    ("scene_area_guide", SceneBindings::SCENE),
    ("scene_emitters", SceneBindings::SCENE),
    ("scene_environment", SceneBindings::SCENE),
    ("scene_environment_table", SceneBindings::SCENE),
    ("scene_bvh", SceneBindings::SCENE),
    // Only on adapters that have ray queries.
    ("scene_acceleration", SceneBindings::SCENE),
    ("scene_textures", SceneBindings::SCENE),
    ("scene_textures_linear", SceneBindings::SCENE),
    ("scene_sampler", SceneBindings::SCENE),
    ("scene_lights", SceneBindings::LIGHTS),
    ("scene_light_layers", SceneBindings::LIGHTS),
    // Constant: for shaders of users that sample textures. Edges are clamped.
    ("linear_sampler", SceneBindings::NONE),
    ("nearest_sampler", SceneBindings::NONE),
];

/// Returns the scene binding to which a global of that name belongs; `None` if there is none.
pub fn of_global(name: &str) -> Option<SceneBindings> {
    GLOBALS.iter().find(|(global, _)| *global == name).map(|(_, scene_bindings)| *scene_bindings)
}

/// The names of the traits of a scene: [`RecordContext::traits`](crate::RecordContext) has each of them. An
/// `#option` of a user's shader that has such a name, in capitals, is set by the scene.
pub const TRAITS: [&str; 16] = [
    "textured",
    "glossy",
    "emissive",
    "masked",
    "normal_mapped",
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
    // Of the adapter too: whether it traces rays through the scene itself.
    "ray_queries",
];

/// Fills in the scene bindings of the modules of outputs: those that the functions of each module's file read.
///
/// A module that cannot be loaded is left as it is: the error is reported, with its place, where a reader's shader is
/// loaded.
pub fn find_of_modules(outputs: &mut [OutputDesc], library: &Library) {
    for output in outputs {
        if let Some(module) = output.facts.module_mut() {
            module.scene_bindings = of_module(module, library).unwrap_or(module.scene_bindings);
        }
    }
}

/// Returns the scene bindings that the functions of a module's file read; `None` if the file cannot be loaded.
pub fn of_module(module: &Module, library: &Library) -> Option<SceneBindings> {
    let shader = library.load(&request_of_module(module)).ok()?;
    Some(shader.used_by_own_functions().filter_map(of_global).fold(SceneBindings::NONE, SceneBindings::and))
}
