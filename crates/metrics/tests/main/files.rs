//! Pictures go to disk and come back; what goes wrong is told and harms nothing.

use std::fs;
use std::path::PathBuf;

use metrics::{Display, Image, ImageError, Tonemap, read_provenance};

const PROVENANCE: &str = r#"{"plan":"51c3","note":"ꟻLIP, α = 1\n"}"#;

fn picture() -> Image {
    Image::from_fn(5, 3, |x, y| [x as f32 * 0.37, 1e-6 * y as f32, 1e6 * (x * y) as f32, 1.0]).unwrap()
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

fn names(folder: &tempfile::TempDir) -> Vec<PathBuf> {
    fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect()
}

#[test]
fn exr_keeps_every_bit_and_the_provenance() {
    let folder = folder();
    let path = folder.path().join("a.EXR");
    let mut image = picture();
    image.pixels_mut()[3] = [f32::NAN, f32::INFINITY, -1.0, 1.0];
    image.write(&path, Display::default(), Some(PROVENANCE)).unwrap();
    let bits = |image: &Image| -> Vec<_> { image.pixels().iter().map(|p| p.map(f32::to_bits)).collect() };
    assert_eq!(bits(&Image::read(&path).unwrap()), bits(&image));
    assert_eq!(read_provenance(&path).unwrap().as_deref(), Some(PROVENANCE));
    assert_eq!(names(&folder).len(), 1, "no temporary file is left");

    image.pixels_mut()[0][3] = 0.25;
    image.write(&path, Display::default(), None).unwrap();
    assert_eq!(bits(&Image::read(&path).unwrap()), bits(&image), "with alpha");
    assert_eq!(read_provenance(&path).unwrap(), None);
}

#[test]
fn pfm_keeps_every_bit_of_rgb() {
    let folder = folder();
    let path = folder.path().join("a.pfm");
    let image = picture();
    image.write(&path, Display::default(), Some(PROVENANCE)).unwrap();
    assert_eq!(Image::read(&path).unwrap(), image);
    assert_eq!(read_provenance(&path).unwrap(), None);
    // Big-endian grey: 1.0 below 2.0, the rows from the bottom up.
    fs::write(&path, b"Pf 1 2 1.0\n\x3f\x80\0\0\x40\0\0\0").unwrap();
    assert_eq!(Image::read(&path).unwrap().pixels(), [[2.0, 2.0, 2.0, 1.0], [1.0, 1.0, 1.0, 1.0]]);
}

#[test]
fn png_is_tone_mapped_srgb_with_provenance() {
    let folder = folder();
    let path = folder.path().join("a.png");
    let grey = |v: f32| [v, v, v, 1.0];
    let pixels = vec![grey(0.0), grey(0.5), grey(1.0), [f32::NAN, 0.0, 0.0, 1.0]];
    let image = Image::new(2, 2, pixels).unwrap();
    image.write(&path, Display::AS_IS, Some(PROVENANCE)).unwrap();
    assert_eq!(read_provenance(&path).unwrap().as_deref(), Some(PROVENANCE));
    let bytes = image::open(&path).unwrap().into_rgb8();
    // 0.5 linear is 187.5 in 8-bit sRGB, which 0.735357 · 255 = 187.516 rounds up.
    assert_eq!(bytes.as_raw()[..], [0, 0, 0, 188, 188, 188, 255, 255, 255, 255, 0, 255]);
    // Reading decodes to linear again: equal after one more round.
    let back = Image::read(&path).unwrap();
    assert!((back.pixels()[1][0] - 0.5).abs() < 3e-3);

    image.write(&path, Display { tonemap: Tonemap::default(), exposure: 0.0 }, None).unwrap();
    let bytes = image::open(&path).unwrap().into_rgb8();
    assert_eq!(bytes.get_pixel(0, 1).0, [188; 3], "Reinhard takes 1 to 0.5");
    assert_eq!(read_provenance(&path).unwrap(), None);
}

#[test]
fn every_byte_of_a_png_survives_a_round() {
    let folder = folder();
    let (first, second) = (folder.path().join("a.png"), folder.path().join("b.png"));
    let bytes = image::RgbaImage::from_fn(16, 16, |x, y| image::Rgba([(16 * y + x) as u8, 7, 99, x as u8]));
    bytes.save(&first).unwrap();
    Image::read(&first).unwrap().write(&second, Display::AS_IS, None).unwrap();
    assert_eq!(image::open(&second).unwrap().into_rgba8(), bytes);
}

#[test]
fn failures_name_the_file_and_what_was_expected() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let write = |name: &str| picture().write(at(name), Display::default(), None).unwrap_err();
    let error = write("none/a.exr");
    assert!(matches!(error, ImageError::NoFolder { .. }) && error.to_string().contains("none"), "{error}");
    for name in ["a.jpg", "a.hdr", "a", ".exr"] {
        let error = write(name);
        assert!(matches!(error, ImageError::UnknownFormat { .. }), "{error}");
        assert!(error.to_string().contains(".pfm"), "{error}");
    }
    let error = Image::read(at("absent.exr")).unwrap_err();
    assert!(matches!(error, ImageError::Io { .. }) && error.to_string().contains("absent.exr"), "{error}");
    assert_eq!(names(&folder), Vec::<PathBuf>::new());
}

#[test]
fn damaged_files_are_errors() {
    let folder = folder();
    for name in ["a.exr", "a.png", "a.pfm"] {
        let path = folder.path().join(name);
        picture().write(&path, Display::default(), Some(PROVENANCE)).unwrap();
        let good = fs::read(&path).unwrap();
        for length in [0, 1, 8, 20, good.len() / 2, good.len() - 9] {
            fs::write(&path, &good[..length]).unwrap();
            let error = Image::read(&path).expect_err("a cut file");
            assert!(matches!(error, ImageError::Malformed { .. }), "{error}");
            // Never a panic; the header may still be whole.
            let _ = read_provenance(&path);
        }
        // Each byte of the header wrong in turn: any answer, but no panic.
        for index in 0..good.len().min(400) {
            let mut bad = good.clone();
            bad[index] ^= 0xff;
            fs::write(&path, &bad).unwrap();
            let _ = (Image::read(&path), read_provenance(&path));
        }
    }
    fs::write(folder.path().join("b.hdr"), "no picture").unwrap();
    assert!(matches!(Image::read(folder.path().join("b.hdr")), Err(ImageError::Malformed { .. })));
    fs::write(folder.path().join("b.pfm"), "PF 4000000000 4000000000 -1\n").unwrap();
    assert!(matches!(Image::read(folder.path().join("b.pfm")), Err(ImageError::Malformed { .. })));
}

#[test]
fn a_failed_write_keeps_the_old_file() {
    let folder = folder();
    // A folder stands in the place of the picture: the last step, the rename, fails.
    let path = folder.path().join("a.exr");
    fs::create_dir(&path).unwrap();
    fs::write(path.join("kept"), "old").unwrap();
    assert!(matches!(picture().write(&path, Display::default(), None), Err(ImageError::Io { .. })));
    assert_eq!(fs::read_to_string(path.join("kept")).unwrap(), "old");
    assert_eq!(names(&folder), [path], "the temporary file is gone");
}

#[cfg(unix)]
#[test]
fn others_may_read_a_picture_as_the_umask_allows() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    let (picture_path, plain) = (folder.path().join("a.png"), folder.path().join("plain"));
    picture().write(&picture_path, Display::default(), None).unwrap();
    fs::write(&plain, "").unwrap();
    let mode = |path| fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&picture_path), mode(&plain));
}

#[test]
fn squares_have_their_mean() {
    let fine = Image::from_fn(7, 4, |x, y| [x as f32, y as f32, (x * y) as f32, 1.0]).unwrap();
    let pixels = fine.mean_of_squares(2).unwrap();
    assert_eq!((pixels.width(), pixels.height()), (3, 2));
    // The mean of a product is that of its factors', as they vary in different directions.
    let expected = |i: usize| {
        let (x, y) = ((i % 3 * 2) as f32 + 0.5, (i / 3 * 2) as f32 + 0.5);
        [x, y, x * y, 1.0]
    };
    assert!(pixels.pixels().iter().enumerate().all(|(i, pixel)| *pixel == expected(i)), "{pixels:?}");
    assert!(fine.mean_of_squares(0).is_err() && fine.mean_of_squares(5).is_err());
}
