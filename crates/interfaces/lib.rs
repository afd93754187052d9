//! The interfaces of Lightloom: the types of ports. Every producer of an interface works with every consumer of it.
//!
//! Scene units are metres; colors are linear Rec. 709; all radiometric quantities are per RGB channel.
//!
//! An interface is one folder: its members with formats, its facts, its WGSL, and the Rust structs that are generated from
//! the WGSL. A crate outside this tree adds an interface with [`Pass::interfaces`].

pub mod cluster_map;
pub mod clusters;
pub mod counters;
pub mod density;
pub mod depth_atlas;
pub mod display;
pub mod filling_maps;
pub mod frame_mean;
pub mod gbuffer;
pub mod importance;
pub mod importance_sums;
pub mod irradiance;
pub mod light_tree;
pub mod owners;
pub mod path_samples;
pub mod points;
pub mod progress;
pub mod radiance;
pub mod radiance_mean;
pub mod radiosity;
pub mod reflective_shadow_map;
pub mod reprojection;
pub mod reservoirs;
pub mod seen_surfaces;
pub mod stands;
pub mod surface_points;
pub mod virtual_lights;
pub mod visibility;

use bytemuck::Pod;
use pass::{Files, Interface, Library, Pass};

/// The WGSL of the interfaces.
pub static FILES: Files = pass::files!();

/// All interfaces of the tree, in the order of the documentation.
pub static INTERFACES: &[Interface] = &[
    gbuffer::INTERFACE,
    reflective_shadow_map::INTERFACE,
    importance::INTERFACE,
    importance_sums::INTERFACE,
    virtual_lights::INTERFACE,
    light_tree::INTERFACE,
    owners::INTERFACE,
    clusters::INTERFACE,
    cluster_map::INTERFACE,
    surface_points::INTERFACE,
    density::INTERFACE,
    radiosity::INTERFACE,
    points::INTERFACE,
    depth_atlas::INTERFACE,
    filling_maps::INTERFACE,
    visibility::INTERFACE,
    stands::INTERFACE,
    reservoirs::INTERFACE,
    irradiance::INTERFACE,
    counters::INTERFACE,
    progress::INTERFACE,
    path_samples::INTERFACE,
    radiance::INTERFACE,
    radiance_mean::INTERFACE,
    seen_surfaces::INTERFACE,
    reprojection::INTERFACE,
    frame_mean::INTERFACE,
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
                Some(_) => return Err(NameTaken::Interface { name: interface.name, pass: pass.kind() }),
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

/// Returns the header of a buffer and the rows after it, of which the header has the count; `None` where there are too few
/// bytes.
fn with_rows<H: Pod, R: Pod>(bytes: &[u8], count: fn(&H) -> u32) -> Option<(H, Vec<R>)> {
    let (header, rest) = bytes.split_at_checked(size_of::<H>())?;
    let header: H = bytemuck::pod_read_unaligned(header);
    let rows = rest.get(..(count(&header) as usize).checked_mul(size_of::<R>())?)?;
    Some((header, bytemuck::pod_collect_to_vec(rows)))
}
