//! Results of a study that never ran: two scenes, three pipelines, two axes, three seeds, with pictures.

use std::collections::BTreeMap;
use std::path::Path;

use metrics::{Display, Image, PIXELS_PER_DEGREE, Pair, flip};
use study::{AxisValue, Cell, CellImages, FrameSeries, Memory, Outcome, PassTime, Results, StudyRecord};

pub(super) const SCENES: [&str; 2] = ["cornell-box", "hall of <b>mirrors</b> & \"smoke\""];
pub(super) const PIPELINES: [&str; 3] = ["imperfect maps", "RSM & clusters <v2>", "sequential"];
pub(super) const LIGHTS: [f64; 3] = [64.0, 256.0, 1024.0];
pub(super) const SEEDS: [u32; 3] = [1, 2, 3];
/// Width and height of the pictures [px].
pub(super) const SIZE: (usize, usize) = (48, 32);
const PASSES: [&str; 4] = ["gbuffer", "reflective-shadow-map", "visibility", "gather"];

/// The results, with references, images and maps written to `folder`.
pub(super) fn with_pictures(folder: &Path) -> Results {
    let mut results = results();
    for sub in ["references", "images"] {
        std::fs::create_dir_all(folder.join(sub)).expect("a folder");
    }
    let references: Vec<Image> = (0..SCENES.len()).map(|scene| picture(scene, 0.0, 0)).collect();
    for (scene, (record, image)) in results.study.references.iter_mut().zip(&references).enumerate() {
        let path = format!("references/{scene}.exr");
        image.write(folder.join(&path), Display::AS_IS, None).expect("a reference");
        record.image = Some(path);
    }
    for (index, cell) in
        results.cells.iter_mut().enumerate().filter(|(_, cell)| cell.outcome == Outcome::Done)
    {
        let scene = SCENES.iter().position(|name| *name == cell.scene).expect("a scene");
        let noise = cell.measures["rel-mse"].expect("an error").sqrt() as f32;
        let image = picture(scene, noise, index as u32 + 1);
        let (path, map) = (format!("images/{}.exr", cell.key), format!("images/{}-flip.png", cell.key));
        image.write(folder.join(&path), Display::AS_IS, None).expect("an image");
        let pair = Pair::new(&image, &references[scene]).expect("one size");
        let errors = flip(&pair, Display::default(), PIXELS_PER_DEGREE);
        errors.to_image().write(folder.join(&map), Display::AS_IS, None).expect("a map");
        cell.images = CellImages { image: Some(path), flip: Some(map), reference: None };
    }
    results
}

/// The results without pictures. The last seed of the last cell of the first scene failed.
pub(super) fn results() -> Results {
    let mut cells = Vec::new();
    for (scene_index, scene) in SCENES.iter().enumerate() {
        for (pipeline_index, pipeline) in PIPELINES.iter().enumerate() {
            for lights in LIGHTS {
                for filter in [false, true] {
                    for seed in SEEDS {
                        cells.push(cell(
                            (scene_index, scene),
                            (pipeline_index, pipeline),
                            lights,
                            filter,
                            seed,
                        ));
                    }
                }
            }
        }
    }
    let count = cells.len();
    let failed = &mut cells[count / SCENES.len() - 1];
    failed.outcome =
        Outcome::Failed { error: "pass `gather`: out of memory, 3 GiB asked for <here>".to_owned() };
    failed.measures.clear();
    failed.passes.clear();
    Results { study: study(count), cells }
}

fn cell(
    (scene_index, scene): (usize, &str),
    (pipeline_index, pipeline): (usize, &str),
    lights: f64,
    filter: bool,
    seed: u32,
) -> Cell {
    let slower = [1.0, 0.55, 1.7][pipeline_index] * [1.0, 2.2][scene_index];
    let worse = [1.0, 2.6, 0.42][pipeline_index] * if filter { 0.3 } else { 1.0 };
    let jitter = |salt: u32| 1.0 + 0.18 * (f64::from(random(seed * 977 + salt)) - 0.5);
    let salt = (lights as u32) ^ (pipeline_index as u32 * 31) ^ (u32::from(filter) << 9);
    let rel_mse = worse * 9.0 / lights * jitter(salt);
    let passes: Vec<PassTime> = PASSES
        .iter()
        .zip([0.4, 0.25, lights * 0.011 * slower, lights * 0.006 + if filter { 0.9 } else { 0.3 }])
        .map(|(pass, ms)| PassTime { pass: (*pass).to_owned(), gpu_ms: ms * jitter(salt + 7) })
        .collect();
    let total: f64 = passes.iter().map(|pass| pass.gpu_ms).sum();
    let megabytes = |factor: f64| ((18.0 + lights * 0.08 * slower) * factor * 1024.0 * 1024.0) as u64;
    let measures = [
        ("rel-mse", Some(rel_mse)),
        ("flip", Some((rel_mse.sqrt() * 0.22).min(0.9) * jitter(salt + 1))),
        ("ssim", Some(1.0 / (1.0 + 0.4 * rel_mse))),
        ("energy", Some(1.0 - 0.03 * worse * jitter(salt + 2))),
        ("gpu-ms", Some(total)),
        ("tid", None),
    ];
    let key = format!("{:08x}{seed:08x}", salt.wrapping_mul(0x9e37_79b9) ^ (scene_index as u32 * 7919));
    Cell {
        provenance: format!(
            "{{\"version\":\"0.1.0\",\"resolved\":\"(\\n  passes: [\\\"{pipeline_index}\\\"],\\n)\",\
             \"plan\":\"{key}\",\"seed\":{seed},\"shaders\":{{\"gather.wgsl\":\"0f3c\"}}}}"
        ),
        key,
        scene: scene.to_owned(),
        pipeline: pipeline.to_owned(),
        axes: BTreeMap::from([
            ("lights".to_owned(), AxisValue::Number(lights)),
            ("gather.filter".to_owned(), AxisValue::Bool(filter)),
        ]),
        seed,
        outcome: Outcome::Done,
        measures: measures.into_iter().map(|(key, value)| (key.to_owned(), value)).collect(),
        passes,
        series: FrameSeries::default(),
        memory: Memory {
            unshared: megabytes(1.6),
            shared: megabytes(1.0),
            bound: megabytes(0.9),
            held: megabytes(1.15),
        },
        chosen: BTreeMap::new(),
        frames: 8,
        seconds: 0.75,
        images: CellImages::default(),
        notes: Vec::new(),
        ..Cell::default()
    }
}

fn study(cell_count: usize) -> StudyRecord {
    let study: StudyRecord = serde_json::from_str(include_str!("sample.json")).expect("a record");
    StudyRecord { cell_count, ..study }
}

/// Two lit discs over a gradient, the scenes mirrored, with relative noise.
pub(super) fn picture(scene: usize, noise: f32, salt: u32) -> Image {
    let (width, height) = SIZE;
    Image::from_fn(width, height, |x, y| {
        let (u, v) = (x as f32 / width as f32, y as f32 / height as f32);
        let u = if scene == 0 { u } else { 1.0 - u };
        let disc = |cx: f32, cy: f32, r: f32| if (u - cx).hypot((v - cy) * 0.67) < r { 1.0 } else { 0.0 };
        let base = [0.1 + 0.5 * u, 0.15 + 0.2 * v, 0.4 - 0.3 * u];
        let lit = [disc(0.3, 0.4, 0.15), disc(0.3, 0.4, 0.15) + disc(0.7, 0.6, 0.1), disc(0.7, 0.6, 0.1)];
        let gain = 1.0 + noise * (random((y * width + x) as u32 ^ salt.wrapping_mul(0x85eb_ca6b)) - 0.5);
        let [r, g, b]: [f32; 3] = std::array::from_fn(|c| 3.0 * (base[c] + lit[c]) * gain.max(0.0));
        [r, g, b, 1.0]
    })
    .expect("pixels")
}

/// Uniform in 0..1 (Jarzynski and Olano 2020, PCG).
pub(super) fn random(index: u32) -> f32 {
    let state = index.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    ((word >> 22) ^ word) as f32 / u32::MAX as f32
}
