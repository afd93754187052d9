//! Inputs and outputs of passes over points on surfaces.

use crate::{Harness, Outputs, elements};
use interfaces::surface_points::{self, SurfacePoint, SurfacePointsHeader};

impl Harness<'_> {
    /// Gives an input port these points.
    pub fn surface_points(self, port: &str, iteration: u32, points: &[SurfacePoint]) -> Self {
        self.surface_points_before(port, iteration, points, &[])
    }

    /// The same where there is room for more points, which holds others that must not be read.
    pub fn surface_points_before(
        self,
        port: &str,
        iteration: u32,
        points: &[SurfacePoint],
        others: &[SurfacePoint],
    ) -> Self {
        let bytes = [&*surface_points::to_bytes(iteration, points), bytemuck::cast_slice(others)].concat();
        let room = (points.len() + others.len()) as u32;
        self.input(port, "SurfacePoints", &[("count", room)], elements(&bytes))
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
