//! The structs that the application writes and WGSL reads, generated from `shaders/`. Every load of a shader compares them
//! with the declarations that it finds then.

use bytemuck::{Zeroable, bytes_of, cast_slice};
use glam::{Mat4, Vec2, Vec3, Vec4};
use scene::{Emitters, Light, LightKind, Material, Scene};
use shader_library::StructLayout;
use std::f32::consts::PI;

wgsl_structs::wgsl! {
    "../../shaders/camera.wgsl" {
        pub(crate) struct Camera;
    }
    "../../shaders/frame.wgsl" {
        pub struct Frame;
    }
    "../../shaders/lights.wgsl" {
        pub(crate) struct Light as GpuLight;
        pub(crate) struct LightLayer;
        struct SceneLights as LightsHeader;
        const LIGHT_SPOT;
        const LIGHT_POINT;
        const LIGHT_DIRECTIONAL;
    }
    "../../shaders/scene.wgsl" {
        use scene::Emitter;
        struct SceneEmitters as EmittersHeader;
        pub(crate) struct SceneInfo;
        pub(crate) struct Material as GpuMaterial;
        use scene::Vertex;
        const NO_TEXTURE;
    }
    fn own_layouts;
}

/// Returns the layouts of the structs that are shared with shaders.
pub fn layouts() -> Vec<StructLayout> {
    [own_layouts(), ray_tracing::layouts()].concat()
}

impl Camera {
    /// `jitter` is the distance of the samples from the centres of their pixels \[px\].
    pub(crate) fn new(
        camera: &scene::Camera,
        previous: &scene::Camera,
        size: (u32, u32),
        jitter: Vec2,
    ) -> Camera {
        let aspect = size.0 as f32 / size.1 as f32;
        let tan = (camera.vertical_fov * 0.5).tan();
        // The projection displaces the sample to the centre of its pixel.
        let projection = |camera: &scene::Camera| camera.projection_offset([size.0, size.1], -jitter);
        Camera {
            clip_from_world: (projection(camera) * camera.view()).to_cols_array_2d(),
            previous_clip_from_world: (projection(previous) * previous.view()).to_cols_array_2d(),
            world_from_view: camera.view().inverse().to_cols_array_2d(),
            position: camera.position.to_array(),
            near: camera.near,
            half_extent: [tan * aspect, tan],
            size: [size.0 as f32, size.1 as f32],
            jitter: jitter.to_array(),
            ..Camera::zeroed()
        }
    }
}

impl SceneInfo {
    pub(crate) fn new(scene: &Scene, textures: u32) -> SceneInfo {
        let (bounds_min, bounds_max) = scene.bounds();
        let rotation = scene.environment.as_ref().map_or(0.0, |environment| environment.rotation);
        SceneInfo {
            bounds_min: bounds_min.to_array(),
            extent: scene.extent(),
            bounds_max: bounds_max.to_array(),
            area: scene.area() as f32,
            triangles: scene.triangles() as u32,
            vertices: scene.vertices.len() as u32,
            materials: scene.materials.len() as u32,
            textures,
            dense_extent: scene.dense_extent(),
            environment_cosine: rotation.cos(),
            environment_sine: rotation.sin(),
            ..SceneInfo::zeroed()
        }
    }
}

impl GpuMaterial {
    pub(crate) fn new(material: &Material) -> GpuMaterial {
        let texture = |index: Option<u32>| index.unwrap_or(NO_TEXTURE);
        GpuMaterial {
            base_color: material.base_color.to_array(),
            emission: material.emission.to_array(),
            roughness: material.roughness,
            specular: material.specular.to_array(),
            metallic: material.metallic,
            base_color_texture: texture(material.base_color_texture),
            emission_texture: texture(material.emission_texture),
            metallic_roughness_texture: texture(material.metallic_roughness_texture),
            normal_texture: texture(material.normal_texture),
            alpha_cutoff: material.alpha_cutoff.unwrap_or(0.0),
            normal_scale: material.normal_scale,
            ..GpuMaterial::zeroed()
        }
    }
}

/// Returns the emitters with their header: `SceneEmitters` of shaders/scene.wgsl.
pub(crate) fn emitters(emitters: &Emitters) -> Vec<u8> {
    let header = EmittersHeader { count: emitters.table.len() as u32 - 1, power: emitters.power };
    [bytes_of(&header), cast_slice(&emitters.table)].concat()
}

/// Returns the lights with their header, and the layers of their shadow maps.
pub(crate) fn lights(lights: &[Light], bounds: (Vec3, Vec3)) -> (Vec<u8>, Vec<LightLayer>) {
    let mut layers: Vec<LightLayer> = Vec::new();
    let mut rows: Vec<GpuLight> = Vec::new();
    for (index, light) in lights.iter().enumerate() {
        let first_layer = layers.len() as u32;
        layers.extend(light_layers(light, index as u32, bounds));
        let (kind, inner, outer) = match light.kind {
            LightKind::Spot { inner, outer } => (LIGHT_SPOT, inner, outer),
            LightKind::Point => (LIGHT_POINT, PI, PI),
            LightKind::Directional => (LIGHT_DIRECTIONAL, PI, PI),
        };
        rows.push(GpuLight {
            position: light.position.to_array(),
            kind,
            direction: light.direction.to_array(),
            cap_outer: cap(outer),
            intensity: light.intensity.to_array(),
            cap_inner: cap(inner),
            first_layer,
            layers: layers.len() as u32 - first_layer,
            cap_sampled: cap(half_angle(light, outer, bounds)),
            ..GpuLight::zeroed()
        });
    }
    let header =
        LightsHeader { count: rows.len() as u32, layers: layers.len() as u32, ..LightsHeader::zeroed() };
    if rows.is_empty() {
        rows.push(GpuLight::zeroed());
    }
    if layers.is_empty() {
        layers.push(LightLayer::zeroed());
    }
    ([bytes_of(&header), cast_slice(&rows)].concat(), layers)
}

/// Height of the cap that a cone cuts from the unit sphere: 1 − cos, without its cancellation for narrow cones.
fn cap(angle: f32) -> f32 {
    let sine = (0.5 * f64::from(angle)).sin();
    (2.0 * sine * sine) as f32
}

/// Half the angle \[rad\] about a spot's axis that holds its cone or, where that is less, the scene: of a light far away, the
/// map would show the scene in no texel, and no path of a cone would meet it.
fn half_angle(light: &Light, outer: f32, bounds: (Vec3, Vec3)) -> f32 {
    if !matches!(light.kind, LightKind::Spot { .. }) {
        return outer;
    }
    let to_centre = (0.5 * (bounds.0 + bounds.1) - light.position).as_dvec3();
    let (distance, radius) = (to_centre.length(), 0.5 * (bounds.1 - bounds.0).as_dvec3().length());
    if distance <= radius || radius == 0.0 {
        return outer;
    }
    // A margin, for what is rounded.
    let whole = to_centre.angle_between(light.direction.as_dvec3()) + (radius / distance).asin() * 1.001;
    outer.min(whole as f32)
}

fn light_layers(light: &Light, index: u32, bounds: (Vec3, Vec3)) -> Vec<LightLayer> {
    let extent = (bounds.1 - bounds.0).length();
    // Nearer than this, positions cannot be distinguished. Reversed depth has the same relative precision for any near plane; one
    // that is farther would cut off the room of a light in a scene that is large elsewhere.
    let near = (extent * 1e-6).max(f32::MIN_POSITIVE * 1e8);
    let perspective = |direction: Vec3, up: Vec3, half_angle: f32| {
        let tan = half_angle.tan();
        let axes = Mat4::from_cols(
            direction.cross(up).normalize().extend(0.0),
            direction.cross(up).normalize().cross(direction).extend(0.0),
            (-direction).extend(0.0),
            light.position.extend(1.0),
        );
        LightLayer {
            clip_from_world: (infinite_reverse_z(tan, near) * axes.inverse()).to_cols_array_2d(),
            world_from_layer: axes.to_cols_array_2d(),
            half_extent: [tan, tan],
            light: index,
            kind: if light.kind == LightKind::Point { LIGHT_POINT } else { LIGHT_SPOT },
        }
    };
    match light.kind {
        LightKind::Spot { outer, .. } if light.layers() == 1 => {
            let half_angle = half_angle(light, outer, bounds);
            vec![perspective(light.direction, light.direction.any_orthonormal_vector(), half_angle)]
        }
        LightKind::Spot { .. } | LightKind::Point => CUBE_FACES
            .iter()
            .map(|(direction, up)| perspective(*direction, *up, std::f32::consts::FRAC_PI_4))
            .collect(),
        LightKind::Directional => vec![directional_layer(light, index, bounds)],
    }
}

/// Axis and up vector of the six faces: +x −x +y −y +z −z.
const CUBE_FACES: [(Vec3, Vec3); 6] = [
    (Vec3::X, Vec3::Y),
    (Vec3::NEG_X, Vec3::Y),
    (Vec3::Y, Vec3::Z),
    (Vec3::NEG_Y, Vec3::Z),
    (Vec3::Z, Vec3::Y),
    (Vec3::NEG_Z, Vec3::Y),
];

fn infinite_reverse_z(tan: f32, near: f32) -> Mat4 {
    Mat4::from_cols(
        Vec4::new(1.0 / tan, 0.0, 0.0, 0.0),
        Vec4::new(0.0, 1.0 / tan, 0.0, 0.0),
        Vec4::new(0.0, 0.0, 0.0, -1.0),
        Vec4::new(0.0, 0.0, near, 0.0),
    )
}

/// The eight corners of a box.
fn corners(bounds: (Vec3, Vec3)) -> impl Iterator<Item = Vec3> {
    (0..8).map(move |i| {
        let pick = |bit: u32, low: f32, high: f32| if i >> bit & 1 == 0 { low } else { high };
        Vec3::new(
            pick(0, bounds.0.x, bounds.1.x),
            pick(1, bounds.0.y, bounds.1.y),
            pick(2, bounds.0.z, bounds.1.z),
        )
    })
}

/// Returns an orthographic layer around the bounding box, as small as the box allows, with a small margin.
fn directional_layer(light: &Light, index: u32, bounds: (Vec3, Vec3)) -> LightLayer {
    let direction = light.direction;
    let right = direction.any_orthonormal_vector();
    let up = right.cross(direction);
    let corners = corners(bounds);
    let local = |p: Vec3| Vec3::new(p.dot(right), p.dot(up), p.dot(direction));
    let (low, high) = corners
        .map(local)
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    // A box without thickness gets maps as well.
    let margin = ((high - low).max_element() * 1e-3).max(f32::MIN_POSITIVE * 1e8);
    let half = (high - low) * 0.5 + margin;
    let center = (high + low) * 0.5;
    let origin = right * center.x + up * center.y + direction * (center.z - half.z);
    let axes =
        Mat4::from_cols(right.extend(0.0), up.extend(0.0), (-direction).extend(0.0), origin.extend(1.0));
    // z is 1 on the plane of the origin and 0 at the far side.
    let projection = Mat4::from_cols(
        Vec4::new(1.0 / half.x, 0.0, 0.0, 0.0),
        Vec4::new(0.0, 1.0 / half.y, 0.0, 0.0),
        Vec4::new(0.0, 0.0, 1.0 / (2.0 * half.z), 0.0),
        Vec4::new(0.0, 0.0, 1.0, 1.0),
    );
    LightLayer {
        clip_from_world: (projection * axes.inverse()).to_cols_array_2d(),
        world_from_layer: axes.to_cols_array_2d(),
        half_extent: [half.x, half.y],
        light: index,
        kind: LIGHT_DIRECTIONAL,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spot(position: Vec3, direction: Vec3, outer: f32) -> Light {
        let kind = LightKind::Spot { inner: outer, outer };
        Light { name: String::new(), kind, position, direction: direction.normalize(), intensity: Vec3::ONE }
    }

    #[test]
    fn caps_of_narrow_cones_keep_their_digits() {
        for angle in [1e-6f32, 1e-4, 0.01, 0.5, PI / 2.0, PI] {
            // 1 − cos x = x²/2 − x⁴/24 for narrow ones.
            let x = f64::from(angle);
            let exact = if x < 0.01 { x * x / 2.0 * (1.0 - x * x / 12.0) } else { 1.0 - x.cos() };
            assert!(
                (f64::from(cap(angle)) / exact - 1.0).abs() < 1e-6,
                "{angle}: {} for {exact}",
                cap(angle)
            );
        }
    }

    /// The map of a light far away shows the whole scene and not much else.
    #[test]
    fn the_map_of_a_light_outside_holds_the_scene() {
        let bounds = (Vec3::new(-1.0, -2.0, 0.0), Vec3::new(3.0, 1.0, 2.0));
        let centre = 0.5 * (bounds.0 + bounds.1);
        for distance in [5.0f32, 100.0, 1e4, 1e6] {
            let position = centre + distance * Vec3::new(1.0, 2.0, -2.0) / 3.0;
            let light = spot(position, centre - position, 0.7);
            let half = half_angle(&light, 0.7, bounds);
            let seen = corners(bounds).map(|corner| {
                let way = (corner - position).as_dvec3();
                way.angle_between(light.direction.as_dvec3())
            });
            let widest = seen.fold(0.0, f64::max);
            // Where positions are rounded by as much as the scene is wide, so are angles.
            let rounding = f64::from(distance * f32::EPSILON) / f64::from(distance);
            assert!(f64::from(half) >= widest - rounding, "{distance} m: {half} for {widest}");
            assert!(
                half <= 0.7 && f64::from(half) < 2.0 * widest + 0.01,
                "{distance} m: {half} for {widest}"
            );
        }
        // Within the scene, and where the cone is narrower, the cone counts.
        let inside = spot(centre, Vec3::X, 0.7);
        assert_eq!(half_angle(&inside, 0.7, bounds), 0.7);
        let narrow = spot(centre - 100.0 * Vec3::X, Vec3::X, 0.001);
        assert_eq!(half_angle(&narrow, 0.001, bounds), 0.001);
        let aside = spot(centre - 100.0 * Vec3::X, Vec3::Z, 0.3);
        assert_eq!(half_angle(&aside, 0.3, bounds), 0.3);
    }
}
