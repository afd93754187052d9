//! Inputs and outputs of passes over points on surfaces.

use crate::{Harness, Outputs, elements};
use interfaces::surface_points::{self, SurfacePoint, SurfacePointsHeader};

impl Harness<'_> {
    /// Gives an input port these points.
    pub fn surface_points(self, port: &str, iteration: u32, points: &[SurfacePoint]) -> Self {
        let members = elements(&surface_points::to_bytes(iteration, points));
        self.input(port, "SurfacePoints", &[("count", points.len() as u32)], members)
    }
}

impl Outputs {
    /// Returns the header and the points of a port.
    ///
    /// # Panics
    /// Where there is none of that name, or its count is more than the points that it holds.
    pub fn surface_points(&self, name: &str) -> (SurfacePointsHeader, Vec<SurfacePoint>) {
        let points = surface_points::from_bytes(&self.read::<u8>(name));
        points.unwrap_or_else(|| panic!("`{name}` holds fewer points than its count"))
    }
}
