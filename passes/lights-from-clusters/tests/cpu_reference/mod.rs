//! The CPU reference of lights-from-clusters.wgsl in `f64`.

use glam::{DVec3, Vec3};
use gpu_algorithms::reference::clustering::flux_of;
use interfaces::clusters::Cluster;

/// The source of the flux of a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Energy {
    /// All texels.
    Texels,
    /// The texel at the centre, as many times as there are texels.
    Centre,
}

/// Returns what a light carries before it is scaled \[W\].
pub(crate) fn unscaled_flux(cluster: &Cluster, energy: Energy) -> DVec3 {
    match energy {
        _ if cluster.texels == 0 => DVec3::ZERO,
        Energy::Texels => flux_of(cluster.flux.into()),
        Energy::Centre => flux_of(cluster.centre_flux.into()) * f64::from(cluster.texels),
    }
}

/// Returns what a channel of all lights is scaled by; 0 where none of them has any of it.
pub(crate) fn scale_of(whole: f64, of_lights: f64) -> f64 {
    if of_lights > 0.0 { whole / of_lights } else { 0.0 }
}

/// Returns the flux of each light \[W\], where the map has `map_flux`.
pub(crate) fn light_fluxes(clusters: &[Cluster], map_flux: Vec3, energy: Energy) -> Vec<DVec3> {
    let (whole, sum) =
        (flux_of(map_flux), clusters.iter().map(|cluster| unscaled_flux(cluster, energy)).sum::<DVec3>());
    let scale = DVec3::new(scale_of(whole.x, sum.x), scale_of(whole.y, sum.y), scale_of(whole.z, sum.z));
    clusters.iter().map(|cluster| unscaled_flux(cluster, energy) * scale).collect()
}
