// Geometry, materials and textures of the scene, all in world space.

struct SceneInfo {
    /// Corner of the bounding box [m].
    bounds_min: vec3<f32>,
    /// Diagonal of the bounding box [m]: the length by which every epsilon scales.
    extent: f32,
    /// Opposite corner [m].
    bounds_max: vec3<f32>,
    /// Area of all triangles [m²].
    area: f32,
    triangles: u32,
    vertices: u32,
    materials: u32,
    textures: u32,
    /// The diagonal without empty space around what lies far from all else [m]: for lengths that are seen.
    dense_extent: f32,
    /// Cosine and sine of the angle by which the environment is turned about +Y.
    environment_cosine: f32,
    environment_sine: f32,
    pad0: u32,
}

/// A vertex of one instance and one material.
struct Vertex {
    /// World space [m]; finite.
    position: vec3<f32>,
    /// Index into the materials of the scene.
    material: u32,
    /// Shading normal in world space, of length 1, on the side from which the triangle is counter-clockwise.
    normal: vec3<f32>,
    /// Index into the instances of the scene.
    instance: u32,
    /// Texture coordinates; v grows downwards, like rows.
    uv: vec2<f32>,
    pad: vec2<f32>,
}

struct Material {
    /// Linear Rec. 709; alpha is coverage.
    base_color: vec4<f32>,
    /// Emitted radiance [W/(m² sr)].
    emission: vec3<f32>,
    roughness: f32,
    /// Reflectance at normal incidence of a dielectric.
    specular: vec3<f32>,
    metallic: f32,
    /// Layers of the texture array; NO_TEXTURE for none.
    base_color_texture: u32,
    emission_texture: u32,
    metallic_roughness_texture: u32,
    normal_texture: u32,
    /// Coverage below which a fragment is dropped; 0 keeps all.
    alpha_cutoff: f32,
    /// Factor of the x and y of normals from the texture.
    normal_scale: f32,
    pad1: f32,
    pad2: f32,
}

/// A triangle that emits. Numbers of 32 bits sample it: from those here up to those of the next emitter. Geometry may move;
/// the numbers are of the scene at rest.
struct Emitter {
    /// Index of the triangle.
    triangle: u32,
    /// The first number that samples it as the origin of a photon; by its power.
    for_photons: u32,
    /// The first number that samples it from the surfaces that a path meets; by its power, where it is brighter than others.
    for_paths: u32,
}

struct SceneEmitters {
    count: u32,
    /// Luminance of the flux that all emit at rest, on both sides [W].
    power: f32,
    /// By their triangles. [count + 1] The last entry is where numbers end: 0 where none samples an emitter.
    emitters: array<Emitter>,
}

const NO_TEXTURE: u32 = 0xffffffffu;

var<uniform> scene_info: SceneInfo;
var<storage, read> scene_vertices: array<Vertex>;
/// Three per triangle.
var<storage, read> scene_indices: array<u32>;
/// x, y and z of each vertex in the frame before [m]; in scenes of moving geometry alone.
var<storage, read> scene_previous_positions: array<f32>;
var<storage, read> scene_materials: array<Material>;
/// Cumulative triangle areas: triangle i is sampled by the 32-bit numbers in [table[i], table[i + 1]).
var<storage, read> scene_area_table: array<u32>;
/// [2^b + 1] Between which triangles the one of a number u lies: those of entries u >> (32 - b) and the next; b is the binary
/// logarithm of the number of triangles, from 1 to 20.
var<storage, read> scene_area_guide: array<u32>;
var<storage, read> scene_emitters: SceneEmitters;
/// Radiance of the environment [W/(m² sr)], by longitude and latitude: see environment.wgsl.
var scene_environment: texture_2d<f32>;
/// [texels + 1] The first number of 32 bits that samples each texel of the environment, by luminance times solid angle; the last
/// entry is where numbers end: 0 where none samples it.
var<storage, read> scene_environment_table: array<u32>;
/// Decoded from sRGB on load.
var scene_textures: texture_2d_array<f32>;
/// The same texels as they stand, for data that is not color.
var scene_textures_linear: texture_2d_array<f32>;
/// Trilinear, repeating.
var scene_sampler: sampler;
