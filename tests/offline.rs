//! Scenes of pbrt-v4 and Mitsuba 3 in the whole program: their path-traced pictures are those of the same scene in glTF, and
//! those of Mitsuba.

use crate::adapter::{done, renderer, root};
use crate::external::python_with_mitsuba;
use crate::program::{Done, Folder, command_of_tree};
use metrics::Image;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const SIZE: (u32, u32) = (48, 32);

/// The side of the blocks whose means are compared, in pixels.
const BLOCK: usize = 8;

const SEEDS: u32 = 8;

fn room(file: &str) -> PathBuf {
    root().join("crates/scene/tests/room").join(file)
}

/// A folder with the files of the room, and others.
fn folder_with_room(files: &[(&str, &str)]) -> Option<Folder> {
    let folder = Folder::with_gpu(&[])?;
    for entry in fs::read_dir(room("")).unwrap().flatten() {
        fs::copy(entry.path(), folder.at(&entry.file_name().to_string_lossy())).unwrap();
    }
    files.iter().for_each(|(name, text)| folder.write(name, text));
    Some(folder)
}

/// The means of blocks, each for several seeds.
struct Blocks(Vec<Vec<f64>>);

impl Blocks {
    fn of(pictures: &[Image]) -> Blocks {
        let (width, height) = (SIZE.0 as usize, SIZE.1 as usize);
        let mut blocks = vec![Vec::new(); 3 * (width / BLOCK) * (height / BLOCK)];
        for picture in pictures {
            assert_eq!((picture.width(), picture.height()), (width, height));
            let mut sums = vec![0.0; blocks.len()];
            for (i, pixel) in picture.pixels().iter().enumerate() {
                let block = (i / width / BLOCK) * (width / BLOCK) + i % width / BLOCK;
                (0..3).for_each(|c| sums[3 * block + c] += f64::from(pixel[c]) / (BLOCK * BLOCK) as f64);
            }
            blocks.iter_mut().zip(sums).for_each(|(block, sum)| block.push(sum));
        }
        Blocks(blocks)
    }

    /// Returns the mean and the square of its standard error of each block.
    fn estimates(&self) -> impl Iterator<Item = [f64; 2]> {
        self.0.iter().map(|values| {
            let count = values.len() as f64;
            let mean = values.iter().sum::<f64>() / count;
            let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
            [mean, variance / count]
        })
    }

    /// Returns the mean over the blocks of squared differences from another estimate, each over its variance: about 1 where both
    /// are of the same picture, and the greatest of these quotients. Differences up to a share of the mean do not count.
    fn quotients(&self, other: &Blocks, share: f64) -> [f64; 2] {
        let quotients: Vec<f64> = self
            .estimates()
            .zip(other.estimates())
            .map(|([a, u], [b, v])| ((a - b).abs() - share * b).max(0.0).powi(2) / (u + v))
            .collect();
        [
            quotients.iter().sum::<f64>() / quotients.len() as f64,
            quotients.iter().copied().fold(0.0, f64::max),
        ]
    }
}

/// Returns the means of a scene's path-traced pictures: direct light, and that of two bounces.
fn path_traced(scene: &Path) -> Option<Blocks> {
    let values = ["bounces=2", "samples=32", "filter=box"];
    let picture = |seed| {
        let mut renderer = renderer("reference", &scene.to_string_lossy(), SIZE, &values)?;
        renderer.set_seed(seed);
        done(&mut renderer);
        Some(renderer.output("image").unwrap())
    };
    Some(Blocks::of(&(0..SEEDS).map(picture).collect::<Option<Vec<_>>>()?))
}

/// Pictures with independent noise would have a mean of 7/5 with eight seeds, and exceed 2 once in thousands of times. The same
/// scene in two formats is sampled by the same random numbers, so its pictures are much nearer.
const MOST: f64 = 2.0;

#[test]
fn the_pictures_of_a_scene_are_the_same_in_all_formats() {
    let Some(expected) = path_traced(&room("room.gltf")) else { return };
    for file in ["room.pbrt", "room.xml"] {
        let found = path_traced(&room(file)).unwrap();
        let [mean, most] = found.quotients(&expected, 0.0);
        eprintln!("{file}: quotients of {mean:.2}, at most {most:.1}");
        assert!(mean < MOST, "{file}: {mean}");
    }
    // Other scenes are told apart: a camera that is wider by 2 %, and a lamp that is brighter by 3 %.
    let text = fs::read_to_string(room("room.pbrt")).unwrap();
    for (from, to) in [("\"float fov\" 36", "\"float fov\" 36.7"), ("[ 5 4 3 ]", "[ 5.15 4.12 3.09 ]")] {
        let folder = folder_with_room(&[("other.pbrt", &text.replace(from, to))]).unwrap();
        let [mean, _] = path_traced(&folder.at("other.pbrt")).unwrap().quotients(&expected, 0.0);
        eprintln!("{to}: quotients of {mean:.2}");
        assert!(mean > MOST, "{to}: {mean}");
    }
}

#[test]
fn scenes_of_offline_renderers_are_rendered_and_checked() {
    let glass =
        "WorldBegin\nMaterial \"dielectric\"\nShape \"sphere\"\nMaterial \"diffuse\"\nShape \"disk\"\n";
    let own = "Scene(geometry: File(\"room.xml\"), lights_from_file: false, lights: [
        Point(position: (0.2, 1.2, 0.5), intensity: (1, 1, 1))])";
    let Some(folder) =
        folder_with_room(&[("glass.pbrt", glass), ("own.ron", own), ("broken.pbrt", "Sphere")])
    else {
        return;
    };
    let run = |arguments: &[&str]| Done::of(command_of_tree(&folder).args(arguments));
    for scene in ["room.pbrt", "room.xml", "own.ron"] {
        run(&["render", "ism-invtm", scene, "-o", "a.exr", "--size", "24x16", "--set", "lights=64"])
            .success();
        let image = Image::read(folder.at("a.exr")).unwrap();
        assert!(crate::adapter::energy(&image) > 0.01, "{scene} is dark");
    }
    let done = run(&["check", "glass.pbrt"]).success();
    done.says(&["scene of 64 triangles", "note: glass.pbrt:2:1: material `dielectric` is of glass"]);
    run(&["check", "broken.pbrt"]).failure(1, &["1 of 1 failed"]).says(&["error[C006]", "broken.pbrt:1:1"]);
}

/// Renders a scene for several seeds; the first argument is the scene, the second the start of the names of pictures.
const SCRIPT: &str = "
import sys
import mitsuba as mi
mi.set_variant('scalar_rgb')
scene = mi.load_file(sys.argv[1])
for seed in range(8):
    picture = mi.render(scene, seed=seed + 1, spp=128)
    mi.Bitmap(picture).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False).write(f'{sys.argv[2]}{seed}.exr')
";

#[test]
#[ignore = "slow"]
fn mitsuba_renders_its_scenes_as_path_tracing_does() {
    let Some(folder) = folder_with_room(&[("render.py", SCRIPT)]) else { return };
    let Some(python) = python_with_mitsuba() else { return };
    let text = fs::read_to_string(room("room.xml")).unwrap();
    // Without the metal, whose Fresnel factor Mitsuba does not raise towards grazing angles.
    let (start, rest) = text.split_once("<bsdf type=\"roughconductor\">").unwrap();
    let (_, end) = rest.split_once("</bsdf>").unwrap();
    folder.write("matte.xml", &format!("{start}<ref id=\"blue\"/>{end}"));
    // Shares of a block's mean by which the two may differ, beside noise.
    for (file, share) in [("matte.xml", 0.01), ("room.xml", 0.02)] {
        let scene = folder.at(file);
        let of_mitsuba = folder.at("mitsuba-");
        let status =
            Command::new(&python).arg(folder.at("render.py")).arg(&scene).arg(&of_mitsuba).status().unwrap();
        assert!(status.success());
        let pictures = (0..8).map(|seed| Image::read(folder.at(&format!("mitsuba-{seed}.exr"))).unwrap());
        let expected = Blocks::of(&pictures.collect::<Vec<_>>());
        let found = path_traced(&scene).unwrap();
        for share in [0.0, share] {
            let [mean, most] = found.quotients(&expected, share);
            eprintln!("{file}, beyond {share}: quotients of {mean:.2}, at most {most:.1}");
        }
        let [mean, _] = found.quotients(&expected, share);
        assert!(mean < 1.0, "{file}: {mean}");
    }
}
