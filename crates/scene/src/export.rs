//! Writes a scene as glTF, for other renderers.

use std::collections::BTreeMap;
use std::io::Cursor;

use glam::{Mat3, Mat4, Quat, Vec3};
use serde_json::{Value, json};

use crate::camera::Camera;
use crate::light::{Light, LightKind};
use crate::material::{Material, Texture, Wrap};
use crate::scene::{Pose, Scene, Vertex};

const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;

/// A glTF file in the making.
#[derive(Default)]
struct Writer {
    binary: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Scene {
    /// Returns the scene in a pose as a binary glTF file (`.glb`): triangles in world space, materials, textures, lights
    /// (KHR_lights_punctual) and the camera. The environment is not in it, for which glTF has no standard. Places are relative
    /// to [`Scene::origin`].
    pub fn to_glb(&self, pose: &Pose) -> Vec<u8> {
        let mut vertices = self.vertices.clone();
        for moved in &pose.moved {
            let first = moved.first_vertex as usize;
            vertices[first..first + moved.vertices.len()].copy_from_slice(&moved.vertices);
        }
        let mut writer = Writer::default();
        let is_textured = self.materials.iter().any(Material::is_textured);
        let meshes: Vec<Value> = self
            .instances
            .iter()
            .filter(|instance| instance.index_count > 0)
            .map(|instance| {
                let first = instance.first_vertex as usize;
                let own = &vertices[first..first + instance.vertex_count as usize];
                let from = instance.first_index as usize;
                let indices = &self.indices[from..from + instance.index_count as usize];
                json!({ "name": instance.name, "primitives": writer.primitives(own, first as u32, indices, is_textured) })
            })
            .collect();
        let images: Vec<Value> = self.textures.iter().map(|texture| writer.image(texture)).collect();
        let mut nodes: Vec<Value> =
            (0..meshes.len()).map(|mesh| json!({ "name": meshes[mesh]["name"], "mesh": mesh })).collect();
        nodes.extend(pose.lights.iter().enumerate().map(|(index, light)| node_of_light(index, light)));
        nodes.push(node_of_camera(&pose.camera));
        let mut document = json!({
            "asset": { "version": "2.0", "generator": "Lightloom" },
            "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_emissive_strength", "KHR_materials_specular"],
            "extensions": { "KHR_lights_punctual": { "lights": pose.lights.iter().map(light).collect::<Vec<_>>() } },
            "scene": 0,
            "scenes": [{ "nodes": (0..nodes.len()).collect::<Vec<_>>() }],
            "nodes": nodes,
            "cameras": [{ "type": "perspective", "perspective": { "yfov": pose.camera.vertical_fov, "znear": pose.camera.near } }],
        });
        // glTF has no empty lists.
        let lists = [
            ("meshes", meshes),
            ("materials", self.materials.iter().map(material).collect()),
            ("samplers", self.textures.iter().map(sampler).collect()),
            ("textures", (0..images.len()).map(|i| json!({ "source": i, "sampler": i })).collect()),
            ("images", images),
            ("accessors", writer.accessors),
            ("bufferViews", writer.views),
            ("buffers", vec![json!({ "byteLength": writer.binary.len() })]),
        ];
        for (name, list) in lists {
            if !list.is_empty() && (name != "buffers" || !writer.binary.is_empty()) {
                document[name] = Value::Array(list);
            }
        }
        if pose.lights.is_empty() {
            document.as_object_mut().map(|members| members.shift_remove("extensions"));
        }
        container(document.to_string().into_bytes(), writer.binary)
    }
}

/// Returns the two chunks of a binary glTF file behind its header.
fn container(mut json: Vec<u8>, mut binary: Vec<u8>) -> Vec<u8> {
    json.resize(json.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let mut chunks = vec![(json, *b"JSON")];
    if !binary.is_empty() {
        chunks.push((binary, *b"BIN\0"));
    }
    let length: usize = 12 + chunks.iter().map(|(chunk, _)| 8 + chunk.len()).sum::<usize>();
    let mut file = b"glTF".to_vec();
    file.extend([2_u32, length as u32].into_iter().flat_map(u32::to_le_bytes));
    for (chunk, name) in chunks {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(name);
        file.extend(chunk);
    }
    file
}

impl Writer {
    /// Returns the primitives of an instance: one for each of its materials.
    fn primitives(
        &mut self,
        vertices: &[Vertex],
        first: u32,
        indices: &[u32],
        is_textured: bool,
    ) -> Vec<Value> {
        let positions: Vec<[f32; 3]> = vertices.iter().map(|vertex| vertex.position).collect();
        let bound = |fold: fn(f32, f32) -> f32| {
            positions.iter().copied().reduce(|a, b| std::array::from_fn(|i| fold(a[i], b[i])))
        };
        let (min, max) = (bound(f32::min), bound(f32::max));
        let position = self.accessor(bytemuck::cast_slice(&positions), FLOAT, "VEC3", positions.len());
        (self.accessors[position]["min"], self.accessors[position]["max"]) = (json!(min), json!(max));
        let normals: Vec<[f32; 3]> = vertices.iter().map(|vertex| vertex.normal).collect();
        let normal = self.accessor(bytemuck::cast_slice(&normals), FLOAT, "VEC3", normals.len());
        let mut attributes = json!({ "POSITION": position, "NORMAL": normal });
        if is_textured {
            let uvs: Vec<[f32; 2]> = vertices.iter().map(|vertex| vertex.uv).collect();
            attributes["TEXCOORD_0"] =
                json!(self.accessor(bytemuck::cast_slice(&uvs), FLOAT, "VEC2", uvs.len()));
        }
        let mut by_material: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for triangle in indices.chunks_exact(3) {
            let own = triangle.iter().map(|index| index - first);
            by_material.entry(vertices[(triangle[0] - first) as usize].material).or_default().extend(own);
        }
        let primitive = |(material, indices): (u32, Vec<u32>)| {
            let indices =
                self.accessor(bytemuck::cast_slice(&indices), UNSIGNED_INT, "SCALAR", indices.len());
            json!({ "attributes": attributes, "indices": indices, "material": material })
        };
        by_material.into_iter().map(primitive).collect()
    }

    /// Adds values to the buffer, and returns the index of their accessor.
    fn accessor(&mut self, bytes: &[u8], component: u32, sort: &str, count: usize) -> usize {
        let view = self.view(bytes);
        self.accessors
            .push(json!({ "bufferView": view, "componentType": component, "type": sort, "count": count }));
        self.accessors.len() - 1
    }

    fn view(&mut self, bytes: &[u8]) -> usize {
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        self.views.push(json!({ "buffer": 0, "byteOffset": self.binary.len(), "byteLength": bytes.len() }));
        self.binary.extend(bytes);
        self.views.len() - 1
    }

    fn image(&mut self, texture: &Texture) -> Value {
        let mut file = Cursor::new(Vec::new());
        let (width, height) = (texture.width, texture.height);
        let pixels = image::RgbaImage::from_raw(width, height, texture.pixels.clone());
        // Writing to memory does not fail; a reader takes an empty image as white.
        let _ = pixels.map(|pixels| pixels.write_to(&mut file, image::ImageFormat::Png));
        json!({ "name": texture.name, "mimeType": "image/png", "bufferView": self.view(&file.into_inner()) })
    }
}

fn sampler(texture: &Texture) -> Value {
    let [s, t] = texture.wrap.map(|wrap| match wrap {
        Wrap::Repeat => 10497,
        Wrap::Mirror => 33648,
        Wrap::Clamp => 33071,
    });
    json!({ "wrapS": s, "wrapT": t })
}

fn material(material: &Material) -> Value {
    let texture = |index: Option<u32>| index.map_or(Value::Null, |index| json!({ "index": index }));
    // Factors are at most 1; what is beyond is a strength, and of reflectance nothing.
    let strength = material.emission.max_element().max(1.0);
    let specular = material.specular / 0.04;
    let share = specular.max_element().clamp(f32::MIN_POSITIVE, 1.0);
    let mut found = json!({
        "name": material.name,
        "doubleSided": true,
        "pbrMetallicRoughness": {
            "baseColorFactor": material.base_color.to_array(),
            "baseColorTexture": texture(material.base_color_texture),
            "metallicFactor": material.metallic,
            "roughnessFactor": material.roughness,
            "metallicRoughnessTexture": texture(material.metallic_roughness_texture),
        },
        "emissiveFactor": (material.emission / strength).to_array(),
        "emissiveTexture": texture(material.emission_texture),
        "normalTexture": texture(material.normal_texture),
        "alphaMode": if material.alpha_cutoff.is_some() { "MASK" } else { "OPAQUE" },
        "alphaCutoff": material.alpha_cutoff,
        "extensions": {
            "KHR_materials_emissive_strength": { "emissiveStrength": strength },
            "KHR_materials_specular": { "specularFactor": share, "specularColorFactor": (specular / share).to_array() },
        },
    });
    if !found["normalTexture"].is_null() {
        found["normalTexture"]["scale"] = json!(material.normal_scale);
    }
    without_nulls(&mut found);
    found
}

fn without_nulls(value: &mut Value) {
    if let Value::Object(members) = value {
        members.retain(|_, member| !member.is_null());
        members.values_mut().for_each(without_nulls);
    }
}

fn light(light: &Light) -> Value {
    let level = light.intensity.max_element().max(f32::MIN_POSITIVE);
    let mut found = json!({
        "name": light.name,
        "color": (light.intensity / level).to_array(),
        "intensity": level,
    });
    found["type"] = json!(match light.kind {
        LightKind::Spot { inner, outer } => {
            // glTF has the inner angle less than the outer one.
            found["spot"] =
                json!({ "innerConeAngle": inner.min(0.999_999 * outer), "outerConeAngle": outer });
            "spot"
        }
        LightKind::Point => "point",
        LightKind::Directional => "directional",
    });
    found
}

fn node_of_light(index: usize, light: &Light) -> Value {
    json!({
        "name": light.name,
        "translation": light.position.to_array(),
        "rotation": Quat::from_rotation_arc(Vec3::NEG_Z, light.direction.normalize_or(Vec3::NEG_Z)).to_array(),
        "extensions": { "KHR_lights_punctual": { "light": index } },
    })
}

fn node_of_camera(camera: &Camera) -> Value {
    let world = Mat3::from_mat4(camera.view()).transpose();
    let matrix = Mat4::from_translation(camera.position) * Mat4::from_mat3(world);
    json!({ "name": "camera", "camera": 0, "matrix": matrix.to_cols_array() })
}
