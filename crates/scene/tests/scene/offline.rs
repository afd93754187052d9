//! Scenes of pbrt-v4 and Mitsuba 3: the same as in glTF, and by closed forms.

use std::collections::BTreeMap;
use std::f32::consts::PI;
use std::fs;
use std::path::{Path, PathBuf};

use glam::{DMat3, DVec3, Vec3};
use scene::{LightKind, Material, Scene};

use crate::common::{assert_near, assert_states, folder_of, load_path, scene_in};

fn room(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/room").join(file)
}

/// Loads a scene of this text, with the files of the room beside it.
fn load_beside_room(name: &str, text: &str) -> Scene {
    let folder = folder_of(&[(name, text.as_bytes())]);
    for entry in fs::read_dir(room("")).unwrap().flatten() {
        let to = folder.path().join(entry.file_name());
        if !to.exists() {
            fs::copy(entry.path(), to).unwrap();
        }
    }
    load_path(&folder.path().join(name))
}

/// Loads a scene of pbrt with this text behind `WorldBegin`.
pub(crate) fn pbrt(world: &str) -> Scene {
    load_beside_room("test.pbrt", &format!("Camera \"perspective\"\nWorldBegin\n{world}"))
}

/// Loads a scene of Mitsuba with these elements.
pub(crate) fn mitsuba(elements: &str) -> Scene {
    load_beside_room("test.xml", &format!("<scene version=\"3.0.0\">\n{elements}\n</scene>"))
}

/// What a surface covers: sums over it that do not depend on how it is cut into triangles.
#[derive(Default)]
struct Sums {
    area: f64,
    place: DVec3,
    spread: DMat3,
    /// Of the products of normals with themselves: both sides of a surface are the same.
    normal: DMat3,
    uv: DVec3,
    /// Places times u, and places times v.
    tilt: [DVec3; 2],
}

impl Sums {
    fn numbers(&self) -> Vec<f64> {
        let matrices = [self.spread, self.normal].map(|matrix| matrix.to_cols_array());
        let vectors = [self.place, self.uv, self.tilt[0], self.tilt[1]].map(|vector| vector.to_array());
        std::iter::once(self.area)
            .chain(matrices.into_iter().flatten())
            .chain(vectors.into_iter().flatten())
            .collect()
    }
}

/// Returns the sums of the surfaces of each material, by what the material is.
fn surfaces(scene: &Scene) -> BTreeMap<String, Sums> {
    let mut surfaces: BTreeMap<String, Sums> = BTreeMap::new();
    for triangle in scene.indices.chunks_exact(3) {
        let vertices = [0, 1, 2].map(|i| &scene.vertices[triangle[i] as usize]);
        let [a, b, c] = vertices.map(|vertex| Vec3::from(vertex.position).as_dvec3());
        let material = &scene.materials[vertices[0].material as usize];
        let sums = surfaces.entry(described(material)).or_default();
        let area = 0.5 * (b - a).cross(c - a).length();
        let sum = a + b + c;
        let outer = |v: DVec3, w: DVec3| DMat3::from_cols(v * w.x, v * w.y, v * w.z);
        sums.area += area;
        sums.place += area / 3.0 * sum;
        sums.spread += (outer(a, a) + outer(b, b) + outer(c, c) + outer(sum, sum)) * (area / 12.0);
        let normal = Vec3::from(vertices[0].normal).as_dvec3();
        sums.normal += outer(normal, normal) * area;
        if material.base_color_texture.is_some() {
            let uvs = vertices.map(|vertex| vertex.uv.map(f64::from));
            for (axis, tilt) in sums.tilt.iter_mut().enumerate() {
                let whole: f64 = uvs.iter().map(|uv| uv[axis]).sum();
                sums.uv[axis] += area / 3.0 * whole;
                let corners = [a, b, c].iter().zip(&uvs).map(|(at, uv)| *at * uv[axis]).sum::<DVec3>();
                *tilt += area / 12.0 * (corners + sum * whole);
            }
        }
    }
    surfaces
}

fn described(material: &Material) -> String {
    let round = |x: f32| (x * 1e4).round() / 1e4;
    format!(
        "{:?} {:?} metallic {} roughness {} textures {:?}",
        material.base_color.to_array().map(round),
        material.emission.to_array().map(round),
        material.metallic,
        if material.is_glossy() { round(material.roughness) } else { 1.0 },
        [material.base_color_texture, material.normal_texture]
    )
}

/// Checks that two scenes have the same surfaces, lights, camera and pictures.
#[track_caller]
fn assert_same(found: &Scene, expected: &Scene) {
    let (surfaces, others) = (surfaces(found), surfaces(expected));
    assert_eq!(surfaces.keys().collect::<Vec<_>>(), others.keys().collect::<Vec<_>>());
    for (material, sums) in &surfaces {
        for (i, (a, b)) in sums.numbers().iter().zip(others[material].numbers()).enumerate() {
            assert!((a - b).abs() < 2e-5, "{material}: number {i} is {a}, not {b}");
        }
    }
    assert_eq!(found.lights.len(), expected.lights.len());
    for (a, b) in found.lights.iter().zip(&expected.lights) {
        assert_eq!(a.kind, b.kind);
        assert_near(a.position, b.position);
        assert_near(a.intensity, b.intensity);
    }
    assert_near(found.camera.position, expected.camera.position);
    assert_near(found.camera.forward(), expected.camera.forward());
    assert!(found.camera.view().abs_diff_eq(expected.camera.view(), 1e-5), "{:?}", found.camera);
    assert!((found.camera.vertical_fov - expected.camera.vertical_fov).abs() < 1e-5, "{:?}", found.camera);
    let pictures = |scene: &Scene| -> Vec<Vec<u8>> {
        scene.textures.iter().map(|texture| texture.pixels.clone()).collect()
    };
    assert_eq!(pictures(found), pictures(expected));
    assert_eq!(found.repairs, Vec::<String>::new());
}

#[test]
fn the_room_is_the_same_in_all_formats() {
    let gltf = load_path(&room("room.gltf"));
    assert!(gltf.triangles() > 30, "{}", gltf.triangles());
    let mut expected = gltf;
    // The file has no normals, and says so.
    expected.repairs.clear();
    assert_same(&load_path(&room("room.pbrt")), &expected);
    assert_same(&load_path(&room("room.xml")), &expected);
    // In a scene file.
    let described = scene_in(&room(""), "Scene(geometry: File(\"room.pbrt\"))");
    assert_same(&described, &expected);
    let mut files: Vec<String> =
        described.files.iter().map(|file| file.file_name().unwrap().to_string_lossy().into_owned()).collect();
    files.sort();
    assert_eq!(files, ["room.pbrt", "wall.png", "wedge-little.ply"]);
}

/// `Scale -1 1 1` before the camera shows a right-handed world.
#[test]
fn a_right_handed_world_of_pbrt_is_not_mirrored() {
    let text = fs::read_to_string(room("room.pbrt")).unwrap();
    let mirrored = text
        .replace("LookAt 0 1 -3.6", "Scale -1 1 1\nLookAt 0 1 3.6")
        // An object has the transform at its beginning, and that of its instance: the mirror of the object is that of the world.
        .replace("ObjectBegin \"wedge\"\n    Scale 1 1 -1", "ObjectBegin \"wedge\"")
        .replace("    Transform [", "    ConcatTransform [")
        .replace("WorldBegin", "WorldBegin\nScale 1 1 -1");
    assert_same(&load_beside_room("right.pbrt", &mirrored), &load_path(&room("room.pbrt")));
}

#[test]
fn meshes_in_text_and_in_both_byte_orders_are_the_same() {
    let text = fs::read_to_string(room("room.pbrt")).unwrap();
    let hash = |file: &str| load_beside_room("room.pbrt", &text.replace("wedge-little.ply", file)).hash;
    assert_eq!(hash("wedge.ply"), hash("wedge-little.ply"));
    assert_eq!(hash("wedge-big.ply"), hash("wedge-little.ply"));
    assert_ne!(hash("wedge.ply"), load_path(&room("room.xml")).hash);
}

#[test]
fn compressed_meshes_are_read() {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    std::io::Write::write_all(&mut encoder, &fs::read(room("wedge.ply")).unwrap()).unwrap();
    let shape = b"WorldBegin Shape \"plymesh\" \"string filename\" \"wedge.ply.gz\"";
    let folder = folder_of(&[("a.pbrt", shape), ("wedge.ply.gz", &encoder.finish().unwrap())]);
    assert_eq!(load_path(&folder.path().join("a.pbrt")).triangles(), 4);
}

const QUAD: &str = "Shape \"trianglemesh\" \"integer indices\" [ 0 1 2 0 2 3 ] \
                    \"point3 P\" [ 0 0 0  2 0 0  2 3 0  0 3 0 ]\n";

#[test]
fn lights_of_pbrt_have_the_power_and_the_level_that_they_state() {
    let lights = "LightSource \"point\" \"rgb I\" [ 1 2 3 ] \"float power\" 12.566370614359172 \"float scale\" 3
        LightSource \"distant\" \"rgb L\" [ 1 2 4 ] \"float illuminance\" 5 \"point3 from\" [ 0 1 0 ] \"point3 to\" [ 0 0 1 ]
        LightSource \"spot\" \"rgb I\" [ 1 1 1 ] \"float coneangle\" 30 \"float conedeltaangle\" 0 \"float power\" 7
        LightSource \"point\" \"blackbody I\" 3000 \"float scale\" 2
        LightSource \"infinite\" \"rgb L\" [ 1 2 3 ] \"float illuminance\" 6.283185307179586\n";
    let scene = pbrt(&format!("{lights}{QUAD}"));
    let intensity = |i: usize| scene.lights[i].intensity;
    assert_near(intensity(0), Vec3::new(3.0, 6.0, 9.0));
    assert_near(intensity(1), Vec3::new(5.0, 10.0, 20.0));
    // The world of pbrt is mirrored.
    assert_near(scene.lights[1].direction, Vec3::new(0.0, -1.0, -1.0).normalize());
    assert!((scene.lights[2].flux().unwrap().x - 7.0).abs() < 1e-3, "{:?}", scene.lights[2]);
    let luminance = intensity(3).dot(Vec3::new(0.2126, 0.7152, 0.0722));
    assert!((luminance - 2.0).abs() < 1e-2, "{}", intensity(3));
    assert!(intensity(3).x > 1.5 * intensity(3).z, "it is warm: {}", intensity(3));
    assert_eq!(scene.environment.as_ref().unwrap().texels, [[2.0, 4.0, 6.0]]);
}

#[test]
fn area_lights_of_pbrt_emit_on_one_side_unless_they_say_else() {
    let light = |parameters: &str| {
        let text =
            format!("AreaLightSource \"diffuse\" \"rgb L\" [ 1 2 3 ] {parameters}\nScale 2 1 1\n{QUAD}");
        pbrt(&text)
    };
    let radiance = |scene: &Scene| {
        scene.materials.iter().find(|material| material.is_emissive()).expect("a light").emission
    };
    let scene = light("\"float scale\" 5");
    assert_near(radiance(&scene), Vec3::new(5.0, 10.0, 15.0));
    assert_eq!(scene.triangles(), 4);
    let back = scene.materials.iter().find(|material| material.name == "back of a light").expect("a back");
    assert_eq!((back.base_color.truncate(), back.emission), (Vec3::ZERO, Vec3::ZERO));
    // The front is +z of pbrt, −z here; the back is behind it, by 5·10⁻⁴ and 10⁻³ of 5 m, whichever is more.
    let at = Vec3::from(scene.vertices.last().unwrap().position);
    assert!((at.z - 5e-3).abs() < 1e-5, "{at}");
    let both = light("\"bool twosided\" true");
    assert_eq!((both.triangles(), both.materials.len()), (2, 1));
    let flipped = pbrt(&format!("AreaLightSource \"diffuse\"\nReverseOrientation\n{QUAD}"));
    assert!(flipped.vertices.last().unwrap().position[2] < 0.0);

    let power = light("\"float power\" 10");
    // Two triangles of 6 m², each 10 W, over π and the area.
    assert_near(radiance(&power), Vec3::new(1.0, 2.0, 3.0) * (20.0 / (PI * 12.0)));
    let power = light("\"float power\" 10 \"bool twosided\" true");
    assert_near(radiance(&power), Vec3::new(1.0, 2.0, 3.0) * (10.0 / (PI * 12.0)));
}

#[test]
fn the_back_of_a_light_is_parallel_to_it_under_any_transform() {
    let scene = pbrt(&format!("AreaLightSource \"diffuse\"\nScale 4 1 1\nRotate 45 0 1 0\n{QUAD}"));
    let [front, back] = &scene.instances[..] else { panic!("{:?}", scene.instances) };
    let of = |instance: &scene::Instance| {
        let first = instance.first_vertex as usize;
        let vertices = &scene.vertices[first..first + instance.vertex_count as usize];
        vertices.iter().map(|vertex| Vec3::from(vertex.position)).collect::<Vec<_>>()
    };
    let front = of(front);
    let normal = (front[1] - front[0]).cross(front[2] - front[0]).normalize();
    let low = front.iter().copied().reduce(Vec3::min).unwrap();
    let high = front.iter().copied().reduce(Vec3::max).unwrap();
    let expected = 1e-3 * (high - low).length();
    for at in of(back) {
        let distance = (at - front[0]).dot(normal).abs();
        assert!((distance / expected - 1.0).abs() < 1e-3, "{at}: {distance}, not {expected}");
    }
}

#[test]
fn a_lamp_that_is_closed_needs_no_back() {
    let scene = pbrt("AreaLightSource \"diffuse\"\nShape \"sphere\" \"float radius\" 2");
    assert_eq!(scene.instances.len(), 1);
    let inside_out = pbrt("AreaLightSource \"diffuse\"\nReverseOrientation\nShape \"sphere\"");
    assert_eq!(inside_out.instances.len(), 2);
    for (scene, radius) in [(&scene, 2.0), (&inside_out, 1.0)] {
        for vertex in &scene.vertices[..scene.instances[0].vertex_count as usize] {
            assert!((Vec3::from(vertex.position).length() - radius).abs() < 1e-5, "{vertex:?}");
            let outwards = Vec3::from(vertex.normal).dot(Vec3::from(vertex.position)) / radius;
            assert!((outwards.abs() - 1.0).abs() < 1e-5, "{vertex:?}");
        }
    }
}

fn only_material(scene: &Scene) -> &Material {
    assert_eq!(scene.materials.len(), 1, "{:?}", scene.materials);
    &scene.materials[0]
}

#[test]
fn materials_of_pbrt_become_metallic_roughness_ones() {
    let of = |material: &str| {
        let scene = pbrt(&format!("LightSource \"infinite\"\nMaterial {material}\n{QUAD}"));
        assert_eq!(scene.repairs, Vec::<String>::new());
        only_material(&scene).clone()
    };
    let diffuse = of("\"diffuse\" \"rgb reflectance\" [ 0.1 0.2 0.3 ]");
    assert_near(diffuse.base_color.truncate(), Vec3::new(0.1, 0.2, 0.3));
    assert!(!diffuse.is_glossy());
    // α = √0.0256 = 0.16, and perceptual roughness its root; F₀ of an index of 1.5.
    let coated = of("\"coateddiffuse\" \"rgb reflectance\" [ 0.1 0.2 0.3 ] \"float roughness\" 0.0256");
    assert!((coated.roughness - 0.4).abs() < 1e-6, "{coated:?}");
    assert_near(coated.specular, Vec3::splat(0.04));
    let plain =
        of("\"coateddiffuse\" \"float roughness\" 0.16 \"bool remaproughness\" false \"float eta\" 1");
    assert!((plain.roughness - 0.4).abs() < 1e-6 && plain.specular == Vec3::ZERO, "{plain:?}");
    let gold = of(
        "\"conductor\" \"spectrum eta\" \"metal-Au-eta\" \"spectrum k\" \"metal-Au-k\" \"float roughness\" 0.0001",
    );
    assert_near(gold.base_color.truncate(), Vec3::new(0.994, 0.789, 0.337));
    assert!(gold.metallic == 1.0 && (gold.roughness - 0.1).abs() < 1e-6, "{gold:?}");
    let iron = of(
        "\"conductor\" \"rgb eta\" [ 2.91 2.91 1 ] \"rgb k\" [ 3.08 0 0 ] \"float uroughness\" 0.01 \"float vroughness\" 0.01",
    );
    assert!((iron.base_color.x - 0.530).abs() < 1e-3, "{iron:?}");
    assert!(
        (iron.base_color.y - (1.91_f32 / 3.91).powi(2)).abs() < 1e-5 && iron.base_color.z == 0.0,
        "{iron:?}"
    );
    let copper = of("\"conductor\"");
    assert_near(copper.base_color.truncate(), Vec3::new(0.933, 0.64, 0.534));
}

#[test]
fn pictures_of_pbrt_are_upright_and_repeat_as_they_state() {
    let texture = |more: &str| {
        let uvs = "\"point2 uv\" [ 0 0  1 0  1 1  0 1 ]";
        let text = format!(
            "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"wall.png\" {more}
            Material \"diffuse\" \"texture reflectance\" \"t\"\n{} {uvs}",
            QUAD.trim_end()
        );
        pbrt(&text)
    };
    let scene = texture(
        "\"float uscale\" 2 \"float vscale\" 3 \"float udelta\" 0.25 \"float vdelta\" 0.5 \"string wrap\" \"clamp\"",
    );
    // v of the file is upwards, that of the scene downwards; flat triangles have the corners 0, 1, 2.
    let uvs: Vec<[f32; 2]> = scene.vertices.iter().take(3).map(|vertex| vertex.uv).collect();
    assert_eq!(uvs, [[0.25, 0.5], [2.25, 0.5], [2.25, -2.5]]);
    assert_eq!(scene.textures[0].wrap, [scene::Wrap::Clamp; 2]);
    assert_eq!(texture("").textures[0].pixels[..4], [200, 60, 60, 255]);
    let inverted = texture("\"bool invert\" true \"string encoding\" \"linear\"");
    let expected = metrics::srgb_from_linear(1.0 - 200.0 / 255.0) * 255.0;
    assert!((f32::from(inverted.textures[0].pixels[0]) - expected).abs() <= 1.0);
}

#[test]
fn a_mask_and_a_rough_picture_are_textures() {
    let text = format!(
        "Texture \"m\" \"float\" \"imagemap\" \"string filename\" \"wall.png\" \"string encoding\" \"linear\"
        Material \"coateddiffuse\" \"rgb reflectance\" [ 0.5 0.5 0.5 ] \"texture roughness\" \"m\" \"bool remaproughness\" false
        {} \"texture alpha\" \"m\"\nShape \"disk\" \"float alpha\" 0",
        QUAD.trim_end()
    );
    let scene = pbrt(&text);
    assert_states(&scene, "an opacity of 0 is left out");
    let material = only_material(&scene);
    assert_eq!(material.alpha_cutoff, Some(0.5));
    let base = &scene.textures[material.base_color_texture.unwrap() as usize];
    assert_eq!(base.pixels[..8], [255, 255, 255, 200, 255, 255, 255, 60]);
    assert_near(material.base_color.truncate(), Vec3::splat(0.5));
    let rough = &scene.textures[material.metallic_roughness_texture.unwrap() as usize];
    // √(200/255) · 255, in green; metallic is that of the material.
    assert_eq!((rough.pixels[1], rough.pixels[2], material.metallic), (226, 255, 0.0));
}

#[test]
fn cameras_of_mitsuba_have_their_field_of_view_along_any_axis() {
    let fov = |axis: &str| {
        let scene = mitsuba(&format!(
            "<sensor type=\"perspective\"><float name=\"fov\" value=\"60\"/>{axis}
            <film type=\"hdrfilm\"><integer name=\"width\" value=\"400\"/><integer name=\"height\" value=\"300\"/></film></sensor>
            <shape type=\"cube\"/>"
        ));
        (0.5 * scene.camera.vertical_fov).tan() / (30_f32.to_radians()).tan()
    };
    let axis = |name: &str| format!("<string name=\"fov_axis\" value=\"{name}\"/>");
    for (axis, expected) in [
        ("".to_owned(), 0.75),
        (axis("x"), 0.75),
        (axis("y"), 1.0),
        (axis("diagonal"), 0.6),
        (axis("smaller"), 1.0),
        (axis("larger"), 0.75),
    ] {
        assert!((fov(&axis) - expected).abs() < 1e-5, "{axis}: {}", fov(&axis));
    }
    let scene = mitsuba(
        "<sensor type=\"perspective\"><string name=\"focal_length\" value=\"50mm\"/></sensor><shape type=\"cube\"/>",
    );
    // The diagonal of 35 mm film is 43.27 mm; the film is 4 : 3.
    assert!(
        ((0.5 * scene.camera.vertical_fov).tan() - 0.6 * 21.633 / 50.0).abs() < 1e-5,
        "{:?}",
        scene.camera
    );
}

#[test]
fn a_mirrored_camera_of_mitsuba_mirrors_the_world() {
    let scene = |scale: &str| {
        mitsuba(&format!(
            "<sensor type=\"perspective\"><transform name=\"to_world\">{scale}<lookat origin=\"1,2,3\" target=\"0,0,0\" up=\"0,1,0\"/></transform></sensor>
            <shape type=\"rectangle\"><transform name=\"to_world\"><translate x=\"1\" z=\"0.5\"/></transform></shape>"
        ))
    };
    let (plain, mirrored) = (scene(""), scene("<scale x=\"-1\"/>"));
    let seen = |scene: &Scene| {
        let of = |vertex: &scene::Vertex| scene.camera.project_to_ndc(vertex.position.into(), 1.0).unwrap();
        scene.vertices.iter().map(of).collect::<Vec<_>>()
    };
    for (a, b) in seen(&plain).iter().zip(seen(&mirrored)) {
        assert!((a.x + b.x).abs() + (a.y - b.y).abs() < 1e-5, "{a} and {b}");
    }
}

#[test]
fn lights_and_materials_of_mitsuba_are_those_of_the_scene() {
    let scene = mitsuba(
        "<emitter type=\"directional\"><vector name=\"direction\" x=\"0\" y=\"-2\" z=\"0\"/><rgb name=\"irradiance\" value=\"1, 2, 3\"/></emitter>
        <emitter type=\"spot\" id=\"lamp\"><transform name=\"to_world\"><lookat origin=\"0,1,0\" target=\"0,0,0\" up=\"1,0,0\"/></transform>
            <rgb name=\"intensity\" value=\"4\"/><float name=\"cutoff_angle\" value=\"30\"/></emitter>
        <emitter type=\"constant\"><rgb name=\"radiance\" value=\"#ff8000\"/></emitter>
        <bsdf type=\"roughplastic\" id=\"p\"><rgb name=\"diffuse_reflectance\" value=\"0.1 0.2 0.3\"/><float name=\"alpha\" value=\"0.16\"/>
            <float name=\"int_ior\" value=\"1.5\"/><float name=\"ext_ior\" value=\"1\"/></bsdf>
        <shape type=\"sphere\"><point name=\"center\" x=\"5\"/><float name=\"radius\" value=\"2\"/><ref id=\"p\"/></shape>
        <shape type=\"cylinder\"><point name=\"p0\" y=\"1\"/><point name=\"p1\" y=\"4\"/><float name=\"radius\" value=\"0.5\"/>
            <bsdf type=\"twosided\"><bsdf type=\"conductor\"><string name=\"material\" value=\"Ag\"/></bsdf></bsdf></shape>
        <shape type=\"disk\"><bsdf type=\"mask\"><float name=\"opacity\" value=\"0.9\"/><ref id=\"p\"/></bsdf></shape>",
    );
    assert_near(scene.lights[0].direction, Vec3::NEG_Y);
    assert_near(scene.lights[0].intensity, Vec3::new(1.0, 2.0, 3.0));
    assert_eq!(scene.lights[1].name, "lamp");
    assert_near(scene.lights[1].direction, Vec3::NEG_Y);
    // 22.5° to 30°, falling with the angle.
    let (inner, outer) = (22.5_f32.to_radians(), 30_f32.to_radians());
    let share = 1.0 - (outer.sin() - inner.sin()) / (outer - inner);
    let flux = scene.lights[1].flux().unwrap().x;
    assert!((flux / (4.0 * 2.0 * PI * share) - 1.0).abs() < 1e-3, "{flux}");
    assert!(
        matches!(scene.lights[1].kind, LightKind::Spot { outer: cone, .. } if (cone - outer).abs() < 1e-6)
    );
    let sky = scene.environment.as_ref().unwrap().texels[0];
    assert!((sky[0] - 1.0).abs() < 1e-6 && (sky[1] - 0.2159).abs() < 1e-3 && sky[2] == 0.0, "{sky:?}");
    let plastic = &scene.materials[0];
    assert!((plastic.roughness - 0.4).abs() < 1e-6, "{plastic:?}");
    assert_near(plastic.specular, Vec3::splat(0.04));
    let silver = &scene.materials[1];
    assert!((silver.metallic, silver.roughness) == (1.0, 0.0), "{silver:?}");
    let (low, high) = scene.bounds();
    assert_near(low, Vec3::new(-1.0, -2.0, -2.0));
    assert_near(high, Vec3::new(7.0, 4.0, 2.0));
    assert_states(&scene, "an opacity of 0.9 is taken as opaque");
}

#[test]
fn files_of_older_mitsuba_includes_and_aliases_are_read() {
    let main = b"<scene version=\"0.5.0\"><default name=\"size\" value=\"3\"/><include filename=\"part.xml\"/>
        <shape type=\"rectangle\"><transform name=\"toWorld\"><scale value=\"$size\"/></transform><ref id=\"b\"/></shape>
        <sensor type=\"perspective\"><transform name=\"toWorld\"><lookAt origin=\"0,0,9\" target=\"0,0,0\" up=\"0,1,0\"/></transform>
        <string name=\"fovAxis\" value=\"y\"/><float name=\"fov\" value=\"30\"/></sensor></scene>";
    let part = b"<scene version=\"0.5.0\"><bsdf type=\"plastic\" id=\"a\"><rgb name=\"diffuseReflectance\" value=\"0.25\"/></bsdf>
        <alias id=\"a\" as=\"b\"/></scene>";
    let folder = folder_of(&[("main.xml", main), ("part.xml", part)]);
    let scene = load_path(&folder.path().join("main.xml"));
    assert_near(scene.bounds().1, Vec3::new(3.0, 3.0, 0.0));
    assert_eq!(scene.materials[0].base_color.x, 0.25);
    assert!((scene.camera.vertical_fov.to_degrees() - 30.0).abs() < 1e-4);
    assert_eq!(scene.files.len(), 2);
}

#[test]
fn environments_are_those_of_their_files() {
    // The upper left texel is red, the others are dark.
    let mut texels = vec![[0.0, 0.0, 0.0, 1.0]; 8];
    texels[0] = [5.0, 1.0, 1.0, 1.0];
    let folder = folder_of(&[(
        "a.xml",
        b"<scene version=\"3.0.0\"><emitter type=\"envmap\"><string name=\"filename\" value=\"sky.exr\"/><float name=\"scale\" value=\"2\"/>
        </emitter><shape type=\"cube\"/></scene>",
    )]);
    let image = metrics::Image::new(4, 2, texels).unwrap();
    image.write(folder.path().join("sky.exr"), metrics::Display::AS_IS, None).unwrap();
    let scene = load_path(&folder.path().join("a.xml"));
    let sky = scene.environment.expect("an environment");
    assert_eq!((sky.width, sky.height, sky.texels[0]), (4, 2, [10.0, 2.0, 2.0]));
    // The first column of Mitsuba is −z, the middle of ours.
    assert!((sky.rotation - PI).abs() < 1e-5, "{}", sky.rotation);
    assert_eq!(scene.files.len(), 2);
    // A scene file may have another one, and may leave it out.
    let text = |more: &str| format!("Scene(geometry: File(\"a.xml\"){more})");
    assert_eq!(scene_in(folder.path(), &text("")).environment, Some(sky));
    let own = scene_in(folder.path(), &text(", environment: Environment(radiance: (1, 1, 1))"));
    assert_eq!(own.environment.unwrap().texels, [[1.0; 3]]);
    assert_eq!(scene_in(folder.path(), &text(", lights_from_file: false")).environment, None);
}
