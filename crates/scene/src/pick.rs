//! Finds what lies under the cursor, the first triangle along a ray, and whether anything is in view, at one time.

use glam::{DMat3, DVec3, Vec3, Vec4};

use crate::scene::{Instance, Pose, Scene};

/// The intersection of a ray with a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance from the origin of the ray \[m\], > 0, whatever the length of the ray's direction.
    pub distance: f32,
    /// The point of the triangle that is hit \[m\].
    pub position: Vec3,
    /// The unit normal of the triangle itself, not of its vertices, on the side from which the ray comes.
    pub normal: Vec3,
    /// Index of the triangle: the position of its first index in [`Scene::indices`], divided by three.
    pub triangle: usize,
    /// Index of its instance in [`Scene::instances`].
    pub instance: usize,
}

impl Scene {
    /// Returns the first intersection of a ray with the triangles of the scene at the time of `pose`, which is
    /// one of this scene. `direction` has any length but 0; of a ray that is not finite, nothing is hit.
    ///
    /// Triangles have two sides and no holes: alpha is not looked at. Those without area are never hit. No ray
    /// passes between triangles that share an edge or a vertex. All triangles are tested, which takes about
    /// 10 ms per million: enough for a click, not for a picture.
    pub fn pick(&self, pose: &Pose, origin: Vec3, direction: Vec3) -> Option<Hit> {
        let ray = Ray::new(origin, direction)?;
        let mut nearest: Option<(f64, usize, usize)> = None;
        for (instance, range) in self.instances.iter().enumerate() {
            let position = positions(self, pose, range);
            let first = range.first_index as usize;
            let indices = self.indices.get(first..first + range.index_count as usize).unwrap_or_default();
            for (i, corners) in indices.chunks_exact(3).enumerate() {
                let Some(corners) = triangle(&position, corners) else { continue };
                if let Some(distance) = ray.distance(corners)
                    && nearest.is_none_or(|(known, ..)| distance < known)
                {
                    nearest = Some((distance, first / 3 + i, instance));
                }
            }
        }
        let (distance, index, instance) = nearest?;
        let position = positions(self, pose, &self.instances[instance]);
        let [a, b, c] = triangle(&position, self.indices.get(3 * index..3 * index + 3)?)?;
        let normal = (b - a).cross(c - a).normalize();
        let normal = if normal.dot(ray.direction) > 0.0 { -normal } else { normal };
        Some(Hit {
            distance: distance as f32,
            position: (ray.origin + ray.direction * distance).as_vec3(),
            normal: normal.as_vec3(),
            triangle: index,
            instance,
        })
    }
}

impl Scene {
    /// Returns whether a triangle may be in view of the camera of `pose`, which is one of this scene; `aspect` is the frame's
    /// width divided by its height. `false` is certain: then each triangle lies beyond one side of what is seen.
    pub fn is_in_view(&self, pose: &Pose, aspect: f32) -> bool {
        let clip = pose.camera.projection(aspect) * pose.camera.view();
        let near = pose.camera.near;
        self.instances.iter().any(|instance| {
            let position = positions(self, pose, instance);
            let first = instance.first_index as usize;
            let indices = self.indices.get(first..first + instance.index_count as usize).unwrap_or_default();
            indices.chunks_exact(3).filter_map(|corners| triangle(&position, corners)).any(|corners| {
                let corners = corners.map(|corner| clip * corner.as_vec3().extend(1.0));
                let beyond = |side: fn(Vec4, f32) -> bool| corners.iter().all(|corner| side(*corner, near));
                !(beyond(|c, near| c.w < near)
                    || beyond(|c, _| c.x > c.w)
                    || beyond(|c, _| c.x < -c.w)
                    || beyond(|c, _| c.y > c.w)
                    || beyond(|c, _| c.y < -c.w))
            })
        })
    }
}

/// Returns the position of each vertex of an instance, by its index in the scene.
fn positions<'a>(
    scene: &'a Scene,
    pose: &'a Pose,
    instance: &Instance,
) -> impl Fn(u32) -> Option<DVec3> + use<'a> {
    let first = instance.first_vertex;
    let moved = pose.moved.iter().find(|moved| moved.first_vertex == first);
    let moved = moved.map_or(&[][..], |moved| &moved.vertices);
    move |index| {
        let vertex = moved.get(index.wrapping_sub(first) as usize).or(scene.vertices.get(index as usize))?;
        Some(Vec3::from(vertex.position).as_dvec3())
    }
}

fn triangle(position: impl Fn(u32) -> Option<DVec3>, indices: &[u32]) -> Option<[DVec3; 3]> {
    Some([position(indices[0])?, position(indices[1])?, position(indices[2])?])
}

/// A ray in double precision, in which the sides of edges come out right for every triangle of single precision
/// that is not a sliver.
struct Ray {
    origin: DVec3,
    /// A unit vector.
    direction: DVec3,
    /// Transforms a vertex, relative to the origin, to a space in which the ray is the z axis \[m\].
    shear: DMat3,
}

impl Ray {
    fn new(origin: Vec3, direction: Vec3) -> Option<Ray> {
        let d = direction.as_dvec3().try_normalize()?;
        if !origin.is_finite() || !direction.is_finite() {
            return None;
        }
        // Woop, Benthin and Wald 2013, §3: the longest axis becomes z; the other two are sheared.
        let z = d.abs().max_position();
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let mut shear = DMat3::ZERO;
        shear.col_mut(x).x = 1.0;
        shear.col_mut(y).y = 1.0;
        *shear.col_mut(z) = DVec3::new(-d[x], -d[y], 1.0) / d[z];
        Some(Ray { origin: origin.as_dvec3(), direction: d, shear })
    }

    /// Returns the distance to a triangle that the ray hits.
    fn distance(&self, corners: [DVec3; 3]) -> Option<f64> {
        let [a, b, c] = corners;
        (b - a).cross(c - a).try_normalize()?;
        let [a, b, c] = corners.map(|corner| self.shear * (corner - self.origin));
        // Exactly opposite for the two triangles of an edge, so that one of them is hit.
        let side = |p: DVec3, q: DVec3| p.x * q.y - p.y * q.x;
        let weights = DVec3::new(side(b, c), side(c, a), side(a, b));
        if weights.min_element() < 0.0 && weights.max_element() > 0.0 {
            return None;
        }
        // The sum is 0 for a triangle that is seen edge-on: the distance is then not finite.
        let sum = weights.x + weights.y + weights.z;
        let distance = weights.dot(DVec3::new(a.z, b.z, c.z)) / sum;
        let rounded = distance as f32;
        (rounded.is_finite() && rounded > 0.0).then_some(distance)
    }
}
