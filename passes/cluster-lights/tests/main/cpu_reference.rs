//! The CPU reference of cluster-lights.wgsl in `f64`.

use glam::{DVec3, dvec3};
use interfaces::virtual_lights::VirtualLight;

/// The weights of the differences, for positions in metres, and whether they are squared.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Metric {
    /// Weight of the distance between positions \[1/m or 1/m²\].
    pub(crate) position: f64,
    /// Weight of the difference of normals.
    pub(crate) normal: f64,
    /// Whether distance and chord are squared, or distance and angle are taken as they are.
    pub(crate) squared: bool,
}

/// The centre of a cluster.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Centre {
    /// World space \[m\].
    pub(crate) position: DVec3,
    /// Unit.
    pub(crate) normal: DVec3,
}

impl Centre {
    /// Returns what a virtual light is to the clustering.
    pub(crate) fn of(light: &VirtualLight) -> Centre {
        let double = |v: [f32; 3]| dvec3(f64::from(v[0]), f64::from(v[1]), f64::from(v[2]));
        Centre { position: double(light.position), normal: double(light.normal) }
    }
}

impl Metric {
    /// Returns the distance μ between two (ACRSM Eq. 3.7).
    pub(crate) fn difference(&self, a: &Centre, b: &Centre) -> f64 {
        let (distance, chord) = (a.position.distance(b.position), a.normal.distance(b.normal));
        if self.squared {
            self.position * distance.powi(2) + self.normal * chord.powi(2)
        } else {
            self.position * distance + self.normal * 2.0 * (0.5 * chord).min(1.0).asin()
        }
    }

    /// Returns the sum of all lights' distances from their clusters: what k-means makes small.
    pub(crate) fn objective(&self, lights: &[VirtualLight], centres: &[Centre], owners: &[u32]) -> f64 {
        let of_light = |(light, owner): (&VirtualLight, &u32)| {
            self.difference(&Centre::of(light), &centres[*owner as usize])
        };
        lights.iter().zip(owners).map(of_light).sum()
    }

    /// Returns the nearest centre of each light, of several the first.
    pub(crate) fn assign(&self, lights: &[VirtualLight], centres: &[Centre]) -> Vec<u32> {
        let nearest = |light: &VirtualLight| {
            let light = Centre::of(light);
            let mut least = (f64::INFINITY, 0);
            for (c, centre) in (0..).zip(centres) {
                let distance = self.difference(&light, centre);
                if distance < least.0 {
                    least = (distance, c);
                }
            }
            least.1
        };
        lights.iter().map(nearest).collect()
    }

    /// Returns centres and owners of all lights, every one of which is lit, after at most `iterations`; and how many
    /// there were until none changed.
    pub(crate) fn clustered(
        &self,
        lights: &[VirtualLight],
        count: usize,
        iterations: u32,
    ) -> (Vec<Centre>, Vec<u32>, u32) {
        let k = count.min(lights.len());
        let mut centres: Vec<Centre> = (0..k).map(|c| Centre::of(&lights[c * lights.len() / k])).collect();
        let mut owners = vec![u32::MAX; lights.len()];
        for iteration in 0..iterations {
            let assigned = self.assign(lights, &centres);
            if assigned == owners {
                return (centres, owners, iteration);
            }
            owners = assigned;
            for (c, centre) in (0..).zip(&mut centres) {
                update(
                    centre,
                    lights.iter().zip(&owners).filter(|(_, owner)| **owner == c).map(|(light, _)| light),
                );
            }
        }
        (centres, owners, iterations)
    }
}

/// Moves a centre to the mean of its lights; without any it stays.
pub(crate) fn update<'a>(centre: &mut Centre, lights: impl Iterator<Item = &'a VirtualLight>) {
    let lights: Vec<Centre> = lights.map(Centre::of).collect();
    if lights.is_empty() {
        return;
    }
    let count = lights.len() as f64;
    centre.position = lights.iter().map(|light| light.position).sum::<DVec3>() / count;
    let normal: DVec3 = lights.iter().map(|light| light.normal).sum();
    if normal.length() > 1e-3 * count {
        centre.normal = normal.normalize();
    }
}
