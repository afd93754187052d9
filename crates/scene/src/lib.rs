//! Scenes: meshes, materials, lights, cameras, and their animation.
//!
//! ```text
//! scenes/*.ron ─describe─▶ Description ┐
//! *.glb, *.gltf ─import─▶ Model        │
//! *.pbrt, *.xml ─offline─▶ Model       ├─assemble─▶ Scene ─at(time)─▶ Pose
//! made by code ─────────▶ Model        ┘              └─traits─▶ data_file::Traits
//! Scene + Pose ─to_glb─▶ *.glb, for other renderers
//! scenes/*.ron + SceneEdit ─save─▶ scenes/*.ron, with the rest of its text as it was
//! ```
//!
//! A [`Scene`] is flat: one array of vertices in world space and one of indices, ready for upload. The origin
//! of that space is [`Scene::origin`], a place near geometry that lies far out in its files. Lengths are in
//! metres, angles in radians, times in seconds; colors are linear Rec. 709; the world is right-handed with +Y
//! up. Photometric units of glTF's KHR_lights_punctual are read as radiometric units for each
//! channel: candela as W/sr, lux as W/m².
//!
//! Invalid input gives a [`SceneError`] with the place and what was expected, or a repair that is listed in
//! [`Scene::repairs`], but never a panic. Nothing here needs a GPU.

mod animation;
mod assemble;
mod budget;
mod built_in;
mod camera;
pub mod codes;
mod dense;
mod description;
mod edit;
mod emitters;
mod environment;
mod error;
mod export;
mod files;
mod hash;
mod import;
mod light;
mod load;
mod material;
mod model;
mod offline;
mod origin;
mod pick;
mod scene;
mod shape;
mod units;

pub use built_in::names as built_in_names;
pub use camera::Camera;
pub use description::expected;
pub use edit::{CameraKey, LightKey, SceneEdit, SceneKeys, edited, keys_of, save, scene_file_for};
pub use emitters::Emitters;
pub use environment::Environment;
pub use error::SceneError;
pub use files::SceneFiles;
pub use light::{BRIGHTEST, Light, LightKind};
pub use load::{GEOMETRY_ENDINGS, about, is_geometry, load};
pub use material::{Encoding, Material, Texture, Wrap};
pub use pick::Hit;
pub use scene::{Changes, Emitter, Instance, MovedVertices, Pose, Scene, Vertex};
