//! Edits of scene files: what is set is read back, all else stays as it is written.

use std::collections::BTreeMap;
use std::sync::{Arc, LazyLock};

use data_file::{Files, Source};
use glam::{DVec3, Vec3};
use proptest::option::of as some;
use proptest::prelude::*;
use scene::{
    Camera, CameraKey, Light, LightKey, LightKind, Scene, SceneEdit, SceneError, edited, save, scene_file_for,
};
use serde_json::json;

use crate::common::{Glb, Shipped, folder_of, scene_in, scene_of};

const ODD: &str = include_str!("odd.ron");
const BARE: &str = "Scene(geometry: BuiltIn(\"cube\"))";

/// The texts of all shipped scenes, with a cube in place of their geometry, and of odder ones.
static TEXTS: LazyLock<Vec<Arc<Source>>> = LazyLock::new(|| {
    let shipped = Shipped.list().into_iter().map(|name| {
        let text = Shipped.read(&name).expect("a file").text.clone();
        let cube = |part: &str| part.split_once("\")").map(|(_, rest)| format!("cube\"){rest}"));
        let mut parts = text.split("BuiltIn(\"");
        let first = parts.next().unwrap_or_default().to_owned();
        let rest: Vec<String> = parts.filter_map(cube).collect();
        let text = [vec![first], rest].concat().join("BuiltIn(\"");
        // An environment's map is built in too.
        Source::new(name, text.replace("map: BuiltIn(\"cube\")", "map: BuiltIn(\"sky\")"))
    });
    let windows = ODD.replace('\n', "\r\n");
    let odd = [("odd", ODD), ("windows", &windows), ("bare", BARE), ("empty keys", EMPTY_KEYS)];
    shipped.chain(odd.map(|(name, text)| Source::new(name, text))).collect()
});

const EMPTY_KEYS: &str = "Scene(
  geometry: BuiltIn(\"cube\"), lights: [Point(position: (0, 3, 0), intensity: (1, 1, 1))],
  keyframes: Keyframes(/* c01 */),
)";

/// The comments of a text that begin with `c` and two digits.
fn comments(text: &str) -> Vec<String> {
    let starts = text.match_indices('c').filter_map(|(at, _)| text.get(at..at + 3));
    let mut found: Vec<String> =
        starts.filter(|c| c[1..].bytes().all(|b| b.is_ascii_digit())).map(str::to_owned).collect();
    found.sort();
    found
}

fn edit_text(text: &str, edit: &SceneEdit) -> String {
    edited(&Source::new("test.ron", text), edit).unwrap_or_else(|errors| panic!("{errors}"))
}

/// Numbers of edits: few enough that some are those of a file.
fn number() -> impl Strategy<Value = f32> {
    prop_oneof![(-3i32..4).prop_map(|n| n as f32), -50.0f32..50.0, Just(1e-7), Just(-3.25e9)]
}

fn vector() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(number()).prop_map(Vec3::from)
}

/// Position, direction and intensity.
type DrawnKey = (Option<Vec3>, Option<Vec3>, Option<Vec3>);

#[derive(Clone, Debug)]
struct Draw {
    camera: Option<(Vec3, Vec3, Option<Vec3>, f32)>,
    lights: Vec<(bool, Vec3, Vec3, Vec3, f32, f32)>,
    camera_keys: Option<Vec<(Option<Vec3>, Option<Vec3>)>>,
    light_keys: Vec<Option<Vec<DrawnKey>>>,
    times: Vec<f32>,
}

fn draw() -> impl Strategy<Value = Draw> {
    let degrees = || prop_oneof![(1u8..90).prop_map(f32::from), 1.0f32..90.0];
    let times = prop::collection::btree_set(0u8..30, 6);
    (
        some((vector(), vector(), some(vector()), degrees())),
        prop::collection::vec((any::<bool>(), vector(), vector(), vector(), degrees(), 0.0f32..1.2), 13),
        some(prop::collection::vec((some(vector()), some(vector())), 0..6)),
        prop::collection::vec(
            some(prop::collection::vec((some(vector()), some(vector()), some(vector())), 0..6)),
            13,
        ),
        times,
    )
        .prop_map(|(camera, lights, camera_keys, light_keys, times)| Draw {
            camera,
            lights,
            camera_keys,
            light_keys,
            times: times.into_iter().map(|n| f32::from(n) * 0.5).collect(),
        })
}

fn aim(v: Vec3) -> Vec3 {
    v.normalize_or(Vec3::NEG_Y)
}

/// Makes an edit of a scene; all of it if `whole` is set.
fn make(scene: &Scene, draw: &Draw, whole: bool) -> SceneEdit {
    let camera = draw.camera.or(whole.then_some((Vec3::X, Vec3::ZERO, None, 50.0)));
    let camera = camera.map(|(position, target, up, degrees)| Camera {
        position,
        target: if position == target { Vec3::splat(0.123) } else { target },
        up: up.filter(|up| *up != Vec3::ZERO).unwrap_or(Vec3::Y),
        vertical_fov: degrees.to_radians(),
        near: 0.0,
    });
    let lights = scene.lights.iter().zip(&draw.lights).filter(|(_, draw)| draw.0 || whole);
    let lights = lights.map(|(light, (_, position, direction, intensity, degrees, share))| Light {
        kind: match light.kind {
            LightKind::Spot { .. } => LightKind::Spot {
                outer: degrees.to_radians(),
                inner: (degrees * share.min(1.0)).to_radians(),
            },
            other => other,
        },
        position: if light.kind == LightKind::Directional { light.position } else { *position },
        direction: if light.kind == LightKind::Point { light.direction } else { aim(*direction) },
        intensity: intensity.abs(),
        ..light.clone()
    });
    let camera_keys = draw.camera_keys.clone().or(whole.then_some(vec![]));
    let times = || draw.times.iter().copied();
    let camera_keys = camera_keys.map(|keys| {
        let keys = keys.into_iter().zip(times());
        keys.map(|((position, target), time)| CameraKey { time, position, target }).collect()
    });
    let light_keys = scene.lights.iter().zip(&draw.light_keys).filter_map(|(light, keys)| {
        let keys = keys.clone().or(whole.then_some(vec![]))?.into_iter().zip(times());
        let keys = keys.map(|((position, direction, intensity), time)| LightKey {
            time,
            position,
            direction: direction.map(aim),
            intensity: intensity.map(Vec3::abs),
        });
        Some((light.name.clone(), keys.collect()))
    });
    SceneEdit {
        camera,
        lights: lights.collect(),
        camera_keys,
        light_keys: light_keys.collect(),
        origin: scene.origin,
        ..SceneEdit::default()
    }
}

fn near(a: f32, b: f32) -> bool {
    (a - b).abs() <= 3e-7 * b.abs()
}

/// Checks every value that is seen of an edited scene against the edit, or the scene that it was.
fn assert_edited(now: &Scene, was: &Scene, edit: &SceneEdit) -> Result<(), TestCaseError> {
    prop_assert_eq!(now.frames_per_second, was.frames_per_second);
    if let Some(camera) = &edit.camera {
        prop_assert_eq!(now.camera.up, camera.up);
        prop_assert!(near(now.camera.vertical_fov, camera.vertical_fov), "{:?}, {:?}", now.camera, camera);
    }
    let keys = edit.camera_keys.iter().flatten();
    for key in keys.clone() {
        let camera = now.at(key.time).camera;
        prop_assert!(key.position.is_none_or(|position| position == camera.position), "{key:?}: {camera:?}");
        prop_assert!(key.target.is_none_or(|target| target == camera.target), "{key:?}: {camera:?}");
    }
    for time in [0.0, 0.7, 3.0] {
        let (camera, before) = (now.at(time).camera, was.at(time).camera);
        match (&edit.camera, &edit.camera_keys) {
            (None, None) => prop_assert_eq!(camera, before),
            (Some(rest), Some(_)) => {
                if keys.clone().all(|key| key.position.is_none()) {
                    prop_assert_eq!(camera.position, rest.position);
                }
                if keys.clone().all(|key| key.target.is_none()) {
                    prop_assert_eq!(camera.target, rest.target);
                }
            }
            _ => {}
        }
    }
    prop_assert_eq!(now.lights.len(), was.lights.len());
    for (i, light) in was.lights.iter().enumerate() {
        let edited = edit.lights.iter().find(|edited| edited.name == light.name);
        let keys = edit.light_keys.get(&light.name);
        let Some(edited) = edited else {
            if keys.is_none() {
                prop_assert_eq!(&now.at(0.7).lights[i], &was.at(0.7).lights[i]);
            }
            continue;
        };
        if let (LightKind::Spot { inner, outer }, LightKind::Spot { inner: a, outer: b }) =
            (edited.kind, now.lights[i].kind)
        {
            prop_assert!(near(a, inner) && near(b, outer), "{:?}, {:?}", now.lights[i], edited);
        }
        let Some(keys) = keys else { continue };
        for key in keys {
            let light = &now.at(key.time).lights[i];
            prop_assert!(
                key.position.is_none_or(|position| position == light.position),
                "{key:?}: {light:?}"
            );
            prop_assert!(key.intensity.is_none_or(|power| power == light.intensity), "{key:?}: {light:?}");
            let same = key.direction.is_none_or(|direction| direction.abs_diff_eq(light.direction, 1e-6));
            prop_assert!(same, "{key:?}: {light:?}");
        }
        let light = &now.at(0.7).lights[i];
        if keys.iter().all(|key| key.position.is_none()) {
            prop_assert_eq!(light.position, edited.position);
        }
        if keys.iter().all(|key| key.direction.is_none()) {
            prop_assert!(light.direction.abs_diff_eq(edited.direction, 1e-6), "{light:?}, {edited:?}");
        }
        if keys.iter().all(|key| key.intensity.is_none()) {
            prop_assert_eq!(light.intensity, edited.intensity);
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn what_is_set_is_read_back_and_comments_remain(file in any::<prop::sample::Index>(), draw in draw()) {
        let source = file.get(&TEXTS);
        let was = scene_of(&source.text);
        let edit = make(&was, &draw, false);
        let text = edited(source, &edit).unwrap_or_else(|errors| panic!("{errors}"));
        assert_edited(&scene_of(&text), &was, &edit)?;
        prop_assert_eq!(comments(&text), comments(&source.text), "{}", text);
        for line in source.text.lines().filter(|line| line.starts_with("//")) {
            prop_assert!(text.contains(line), "{line} is lost");
        }
        let ends = text.replace("\r\n", "");
        prop_assert!(!ends.contains('\r'), "ends of lines");
        prop_assert!(!source.text.contains('\r') || !ends.contains('\n'), "ends of lines");
        let again = edited(&Source::new("again", &*text), &edit).unwrap_or_else(|errors| panic!("{errors}"));
        prop_assert_eq!(again, text, "the same edit again changes nothing");
    }

    #[test]
    fn the_later_of_two_edits_holds(file in any::<prop::sample::Index>(), first in draw(), second in draw()) {
        let source = file.get(&TEXTS);
        let was = scene_of(&source.text);
        let (first, second) = (make(&was, &first, true), make(&was, &second, true));
        let both = edit_text(&edit_text(&source.text, &first), &second);
        assert_edited(&scene_of(&both), &was, &second)?;
        prop_assert_eq!(comments(&both), comments(&source.text), "{}", both);
    }
}

#[test]
fn an_edit_of_nothing_and_of_equal_values_changes_nothing() {
    for source in &*TEXTS {
        let scene = scene_of(&source.text);
        assert_eq!(edit_text(&source.text, &SceneEdit::default()), source.text, "{}", source.name);
        if source.text.contains("keyframes") || !source.text.contains("camera:") {
            continue;
        }
        let edit = SceneEdit { camera: Some(scene.camera), lights: scene.lights, ..SceneEdit::default() };
        assert_eq!(edit_text(&source.text, &edit), source.text, "{}", source.name);
    }
}

#[test]
fn only_the_numbers_that_changed_are_replaced() {
    let scene = scene_of(ODD);
    let mut camera = Camera { up: Vec3::Y, vertical_fov: 45f32.to_radians(), ..scene.camera };
    (camera.position, camera.target) = (Vec3::new(1.0, 2.75, -3.0), Vec3::ZERO);
    let mut bulb = scene.lights[1].clone();
    bulb.intensity.z = 2.5;
    let edit = SceneEdit { camera: Some(camera), lights: vec![bulb], ..SceneEdit::default() };
    let expected = ODD.replace("(1, 2.50, /*", "(1, 2.75, /*").replace("(0.50, 1, 2)", "(0.50, 1, 2.5)");
    assert_eq!(edit_text(ODD, &edit), expected);
}

#[test]
fn what_is_missing_is_added_in_the_style_of_its_neighbours() {
    let text = "Scene(
  geometry: BuiltIn(\"cube\"), // a cube
  lights: [
    Spot(
      name: \"key\", position: (0, 2, 0), direction: (0, -1, 0),
      intensity: (1, 1, 1), outer_deg: 30, // wide
    ),
  ]
)
";
    let camera = Camera {
        position: Vec3::new(0.0, 1.0, 4.0),
        target: Vec3::ZERO,
        up: Vec3::Z,
        vertical_fov: 39.3077f32.to_radians(),
        near: 0.0,
    };
    let mut key = scene_of(text).lights[0].clone();
    key.kind = LightKind::Spot { inner: 20f32.to_radians(), outer: 30f32.to_radians() };
    let keys = vec![
        LightKey { time: 0.0, direction: Some(Vec3::NEG_Y), ..LightKey::default() },
        LightKey { time: 1.5, intensity: Some(Vec3::ONE), ..LightKey::default() },
    ];
    let edit = SceneEdit {
        camera: Some(camera),
        lights: vec![key],
        camera_keys: Some(vec![CameraKey { time: 0.0, position: Some(Vec3::X), target: None }]),
        light_keys: BTreeMap::from([("key".to_owned(), keys)]),
        ..SceneEdit::default()
    };
    let result = edit_text(text, &edit);
    assert_eq!(
        result,
        "Scene(
  geometry: BuiltIn(\"cube\"), // a cube
  lights: [
    Spot(
      name: \"key\", position: (0, 2, 0), direction: (0, -1, 0),
      intensity: (1, 1, 1), outer_deg: 30, inner_deg: 20.0, // wide
    ),
  ],
  camera: Camera(position: (0.0, 1.0, 4.0), target: (0.0, 0.0, 0.0), up: (0.0, 0.0, 1.0), vertical_fov_deg: 39.3077),
  keyframes: Keyframes(
    camera: [
      Key(time: 0.0, position: (1.0, 0.0, 0.0)),
    ],
    lights: {
      \"key\": [
        Key(time: 0.0, direction: (0.0, -1.0, 0.0)),
        Key(time: 1.5, intensity: (1.0, 1.0, 1.0)),
      ],
    },
  )
)
"
    );
    let keys = vec![
        CameraKey { time: 0.0, position: Some(Vec3::X), target: None },
        CameraKey { time: 2.0, position: Some(Vec3::ZERO), target: None },
    ];
    let longer = SceneEdit { camera_keys: Some(keys), ..SceneEdit::default() };
    let longer = edit_text(&result, &longer);
    let added = "(1.0, 0.0, 0.0)),\n      Key(time: 2.0, position: (0.0, 0.0, 0.0)),\n    ],";
    assert_eq!(longer, result.replacen("(1.0, 0.0, 0.0)),\n    ],", added, 1), "a key on a line of its own");
    let first = vec![CameraKey { time: 2.0, position: Some(Vec3::ZERO), target: None }];
    let shorter = edit_text(&longer, &SceneEdit { camera_keys: Some(first), ..SceneEdit::default() });
    let removed = "      Key(time: 0.0, position: (1.0, 0.0, 0.0)),\n";
    assert_eq!(shorter, longer.replacen(removed, "", 1), "its line is gone, and the other key as it was");
}

#[test]
fn lights_of_one_name_are_edited_in_their_order() {
    let text = "Scene(geometry: BuiltIn(\"cube\"), lights: [
        Point(name: \"a\", position: (1, 0, 0), intensity: (1, 1, 1)), Point(position: (2, 0, 0), intensity: (1, 1, 1)),
        Point(name: \"a\", position: (3, 0, 0), intensity: (1, 1, 1)),
    ])";
    let mut lights = scene_of(text).lights;
    lights[1].position.y = 5.0;
    lights[2].position.y = 7.0;
    let edit = SceneEdit { lights, ..SceneEdit::default() };
    let expected = text.replace("(2, 0, 0)", "(2, 5.0, 0)").replace("(3, 0, 0)", "(3, 7.0, 0)");
    assert_eq!(edit_text(text, &edit), expected, "a light without a name goes by its number");
    let one_more = SceneEdit { lights: vec![edit.lights[0].clone(); 3], ..SceneEdit::default() };
    assert!(refused(text, &one_more).contains("the light `a` is not in `lights`"), "the third is not there");
}

fn refused(text: &str, edit: &SceneEdit) -> String {
    edited(&Source::new("test.ron", text), edit).expect_err("refused").to_string()
}

/// A light can get another kind, and lights come and go; everything else stays as it is written.
#[test]
fn lights_are_added_removed_and_changed_in_kind() {
    let scene = scene_of(ODD);
    let mut first = scene.lights[0].clone();
    first.kind = LightKind::Point;
    let kind = edit_text(ODD, &SceneEdit { lights: vec![first], ..SceneEdit::default() });
    assert!(kind.contains("/* c11 */Point(name: \"a b\", position: (1.0, 2.0, 3.0), "), "{kind}");
    let mut lamp = scene.lights[1].clone();
    lamp.name = "lamp".to_owned();
    let edit =
        SceneEdit { added: vec![lamp.clone()], removed: vec!["light 1".to_owned()], ..SceneEdit::default() };
    let text = edit_text(ODD, &edit);
    let names = |text: &str| scene_of(text).lights.into_iter().map(|light| light.name).collect::<Vec<_>>();
    assert_eq!(names(&text), ["a b", "s\"un", "lamp"]);
    // Comments stay, those of the removed light too.
    (1..=28).for_each(|c| assert!(text.contains(&format!("c{c:02}")), "c{c:02} of {text}"));
    // The only light goes, and another comes.
    let only = "Scene(geometry: BuiltIn(\"cube\"), lights: [Point(name: \"a\", position: (0, 3, 0), intensity: (1, 1, 1))])";
    let edit = SceneEdit { added: vec![lamp], removed: vec!["a".to_owned()], ..SceneEdit::default() };
    assert_eq!(names(&edit_text(only, &edit)), ["lamp"]);
    // A file without lights gets a list of them.
    let added = SceneEdit { removed: Vec::new(), ..edit };
    assert_eq!(names(&edit_text(BARE, &added)), ["lamp"]);
    let gone = SceneEdit { removed: vec!["b".to_owned()], ..SceneEdit::default() };
    assert!(refused(only, &gone).contains("the light `b` is not in `lights`"));
}

#[test]
fn what_cannot_be_written_is_refused() {
    let scene = scene_of(ODD);
    let with = |change: fn(&mut Light)| {
        let mut light = scene.lights[0].clone();
        change(&mut light);
        SceneEdit { lights: vec![light], ..SceneEdit::default() }
    };
    let stranger = refused(ODD, &with(|light| light.name = "a c".to_owned()));
    assert!(stranger.contains("the light `a c` is not in `lights`"), "{stranger}");
    assert!(stranger.contains("glTF") && stranger.contains("did you mean `a b`?"), "{stranger}");
    let infinite = refused(ODD, &with(|light| light.position.x = f32::NAN));
    assert!(infinite.contains("expected a finite number, found NaN"), "{infinite}");
    assert!(infinite.contains("would have been written"), "{infinite}");
    let unsorted = [1.0, 0.5].map(|time| CameraKey { time, position: Some(Vec3::ZERO), target: None });
    let unsorted = SceneEdit { camera_keys: Some(unsorted.to_vec()), ..SceneEdit::default() };
    assert!(refused(ODD, &unsorted).contains("order of their times"));
    assert!(refused("Scene(geometry: )", &SceneEdit::default()).contains("E001"));
}

#[test]
fn a_file_is_replaced_as_a_whole_with_its_permissions() {
    let folder = folder_of(&[("odd.ron", ODD.as_bytes())]);
    let path = folder.path().join("odd.ron");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o640)).expect("permissions");
    }
    let permissions = std::fs::metadata(&path).expect("a file").permissions();
    let keys = vec![CameraKey { time: 3.0, position: Some(Vec3::X), target: None }];
    let edit = SceneEdit { camera_keys: Some(keys), ..SceneEdit::default() };
    save(&path, &edit).expect("saved");
    assert_eq!(std::fs::read_to_string(&path).expect("a file"), edit_text(ODD, &edit));
    assert_eq!(std::fs::metadata(&path).expect("a file").permissions(), permissions);
    let bad = SceneEdit {
        camera_keys: Some(vec![CameraKey { time: -1.0, ..CameraKey::default() }]),
        ..edit.clone()
    };
    assert!(matches!(save(&path, &bad), Err(SceneError::Description(_))));
    assert_eq!(std::fs::read_to_string(&path).expect("a file"), edit_text(ODD, &edit), "as it was");
    let mut read_only = permissions;
    read_only.set_readonly(true);
    std::fs::set_permissions(&path, read_only).expect("permissions");
    save(&path, &edit).expect("nothing to write");
    assert!(matches!(
        save(&path, &SceneEdit { camera_keys: Some(vec![]), ..edit }),
        Err(SceneError::Unwritable { .. })
    ));
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 1, "nothing else is left there");
    let missing = save(&folder.path().join("other.ron"), &SceneEdit::default());
    assert!(matches!(missing, Err(SceneError::Unreadable { .. })), "{missing:?}");
}

#[test]
fn a_bare_gltf_file_gets_a_scene_file() {
    let mut glb = Glb::square();
    let light = |kind: &str| json!({ "type": kind, "intensity": 2.0, "name": kind, "spot": { "outerConeAngle": 0.5 } });
    glb.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [light("point"), light("spot")] } });
    for index in 0..2 {
        let extensions = json!({ "KHR_lights_punctual": { "light": index } });
        glb.push("nodes", json!({ "translation": [index, 2, 3], "extensions": extensions }));
    }
    let folder = folder_of(&[("square.glb", &glb.bytes())]);
    let scene = glb.scene();
    let mut lights = scene.lights.clone();
    lights[1].intensity = Vec3::new(1.0, 2.0, 3.5);
    let edit = SceneEdit {
        lights: vec![lights[1].clone()],
        camera_keys: Some(vec![CameraKey { time: 1.0, position: Some(Vec3::X), target: None }]),
        ..SceneEdit::default()
    };
    let text = scene_file_for(&scene, "square.glb", &edit).expect("written");
    let read = scene_in(folder.path(), &text);
    assert_eq!((read.lights.len(), read.triangles()), (2, scene.triangles()), "{text}");
    for (read, light) in read.lights.iter().zip(&lights) {
        assert_eq!(
            (read.name.as_str(), read.position, read.intensity),
            (light.name.as_str(), light.position, light.intensity)
        );
        let aims = light.kind == LightKind::Point || read.direction.abs_diff_eq(light.direction, 1e-6);
        assert!(aims, "{read:?}");
    }
    let camera = Camera { position: Vec3::X, ..scene.camera };
    assert!(near(read.camera.vertical_fov, camera.vertical_fov), "{text}");
    assert_eq!(Camera { vertical_fov: camera.vertical_fov, ..read.camera }, camera, "{text}");
}

#[test]
fn keys_are_those_that_were_written() {
    let folder = folder_of(&[("scene.ron", BARE.as_bytes())]);
    let path = folder.path().join("scene.ron");
    assert_eq!(scene::keys_of(&path, DVec3::ZERO).unwrap(), scene::SceneKeys::default());
    let key = |time: f32| CameraKey {
        time,
        position: Some(Vec3::new(time, 1.0, 2.0)),
        target: (time > 0.5).then_some(Vec3::ZERO),
    };
    let edit = SceneEdit { camera_keys: Some(vec![key(0.0), key(1.5)]), ..SceneEdit::default() };
    scene::save(&path, &edit).unwrap();
    assert_eq!(scene::keys_of(&path, DVec3::ZERO).unwrap().camera, [key(0.0), key(1.5)]);
    assert!(scene::keys_of(&folder.path().join("none.ron"), DVec3::ZERO).is_err());
}
