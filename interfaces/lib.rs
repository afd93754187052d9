//! The interfaces of Lightloom: the types of ports. Every producer of an interface works with every consumer of it.
//!
//! Scene units are metres; colours are linear Rec. 709; all radiometric quantities are per RGB channel.
//!
//! An interface is one folder: its members with formats, its facts, its WGSL, and the Rust structs that have the
//! layout of the WGSL ones. A crate outside this tree adds an interface with
//! [`Pass::interfaces`].

pub mod areas;
#[path = "cluster-map/mod.rs"]
pub mod cluster_map;
pub mod clusters;
pub mod counters;
pub mod density;
#[path = "depth-atlas/mod.rs"]
pub mod depth_atlas;
pub mod display;
pub mod gbuffer;
#[path = "importance/mod.rs"]
pub mod importance;
pub mod irradiance;
pub mod owners;
#[path = "path-samples/mod.rs"]
pub mod path_samples;
pub mod points;
pub mod progress;
pub mod radiance;
#[path = "radiance-mean/mod.rs"]
pub mod radiance_mean;
pub mod radiosity;
#[path = "reflective-shadow-map/mod.rs"]
pub mod reflective_shadow_map;
pub mod stands;
#[path = "surface-points/mod.rs"]
pub mod surface_points;
#[path = "virtual-lights/mod.rs"]
pub mod virtual_lights;
pub mod visibility;

use pass::{Interface, Library, Pass};

/// All interfaces of the tree, in the order of the documentation.
pub static INTERFACES: &[Interface] = &[
    gbuffer::INTERFACE,
    reflective_shadow_map::INTERFACE,
    importance::INTERFACE,
    virtual_lights::INTERFACE,
    owners::INTERFACE,
    clusters::INTERFACE,
    cluster_map::INTERFACE,
    surface_points::INTERFACE,
    density::INTERFACE,
    areas::INTERFACE,
    radiosity::INTERFACE,
    points::INTERFACE,
    depth_atlas::INTERFACE,
    visibility::INTERFACE,
    stands::INTERFACE,
    irradiance::INTERFACE,
    counters::INTERFACE,
    progress::INTERFACE,
    path_samples::INTERFACE,
    radiance::INTERFACE,
    radiance_mean::INTERFACE,
    display::INTERFACE,
];

/// Returns the interfaces of the tree and those that passes add, in that order; an interface that several passes add is
/// listed once.
///
/// # Errors
/// Where two different interfaces have the same name.
pub fn with_those_of<'a>(
    passes: impl IntoIterator<Item = &'a dyn Pass>,
) -> Result<Vec<Interface>, NameTaken> {
    let mut all = INTERFACES.to_vec();
    for pass in passes {
        for interface in pass.interfaces() {
            match all.iter().find(|known| known.name == interface.name) {
                Some(known) if known == interface => {}
                Some(_) => return Err(NameTaken::Interface { name: interface.name, pass: pass.info().kind }),
                None => all.push(interface.clone()),
            }
        }
    }
    Ok(all)
}

/// A name that a pass type adds is another's already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NameTaken {
    /// A pass type adds an interface whose name another interface has.
    Interface {
        /// The name.
        name: &'static str,
        /// The pass type that adds the second one.
        pass: &'static str,
    },
    /// Two pass types have the same name.
    PassType {
        /// The name.
        name: &'static str,
    },
}

impl std::fmt::Display for NameTaken {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            NameTaken::Interface { name, pass } => {
                write!(
                    f,
                    "the pass type `{pass}` brings an interface `{name}`, and there is another of that name"
                )
            }
            NameTaken::PassType { name } => write!(f, "two pass types are named `{name}`"),
        }
    }
}

impl std::error::Error for NameTaken {}

/// Returns the library with the folders in which imports are looked for: beside the importing file, among the shared
/// modules, and among the WGSL of these interfaces.
pub fn import_from(library: Library, interfaces: &[Interface]) -> Library {
    let folders = interfaces.iter().filter_map(|interface| interface.folder);
    library.with_roots(["shaders"].into_iter().chain(folders).chain([""]))
}
