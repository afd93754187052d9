//! Pictures at the extremes: headers that state any size, palettes that are cut, texts that unpack to gigabytes; and good
//! files with edits. Each is read or refused, without a panic.

use metrics::{Display, Image, ImageError, PROVENANCE_KEY, decode, read_provenance};
use proptest::prelude::*;
use std::fs;
use std::path::Path;
use std::sync::LazyLock;
use std::time::Duration;

const LIMIT: Duration = Duration::from_secs(20);

/// A chunk of a PNG file.
fn chunk(kind: &[u8; 4], content: &[u8]) -> Vec<u8> {
    let mut chunk = (content.len() as u32).to_be_bytes().to_vec();
    chunk.extend(kind);
    chunk.extend(content);
    // CRC-32 of kind and content, bit by bit.
    let mut crc = u32::MAX;
    for byte in &chunk[4..] {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
        }
    }
    chunk.extend((!crc).to_be_bytes());
    chunk
}

/// A PNG file of 8 bits a sample; `packed` is its content.
fn png(width: u32, height: u32, color: u8, between: &[Vec<u8>], packed: &[u8]) -> Vec<u8> {
    let mut header = [width, height].map(u32::to_be_bytes).concat();
    header.extend([8, color, 0, 0, 0]);
    let mut png = b"\x89PNG\r\n\x1a\n".to_vec();
    png.extend(chunk(b"IHDR", &header));
    png.extend(between.concat());
    png.extend(chunk(b"IDAT", packed));
    png.extend(chunk(b"IEND", &[]));
    png
}

/// A zlib stream of so many zeros, in stored blocks where they are few, else packed by the encoder of the crate.
fn packed(zeros: usize) -> Vec<u8> {
    let side = 1 << 10;
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, side, (zeros / side as usize) as u32);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_compression(png::Compression::High);
    encoder.set_filter(png::Filter::NoFilter);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&vec![0; zeros]).unwrap();
    writer.finish().unwrap();
    // All its IDAT chunks.
    let (mut rest, mut stream) = (&file[8..], Vec::new());
    while rest.len() >= 12 {
        let length = u32::from_be_bytes(rest[..4].try_into().unwrap()) as usize;
        if &rest[4..8] == b"IDAT" {
            stream.extend(&rest[8..8 + length]);
        }
        rest = &rest[12 + length..];
    }
    stream
}

fn read(name: &str, bytes: &[u8]) -> Result<Image, ImageError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, bytes).unwrap();
    Image::read(path)
}

/// The error of a file, which names it.
fn refused(name: &str, bytes: &[u8]) -> String {
    let error = read(name, bytes).expect_err("it is broken");
    assert!(matches!(error, ImageError::Malformed { .. }), "{error}");
    let error = error.to_string();
    assert!(error.contains(name), "{error}");
    error
}

#[test]
fn a_palette_that_is_cut_is_refused() {
    let content = packed(1 << 10);
    let trns = chunk(b"tRNS", &[1, 2, 3, 4]);
    for length in [0, 1, 4, 5, 767, 769, 1024] {
        let palette = chunk(b"PLTE", &vec![7; length]);
        for between in [vec![palette.clone()], vec![palette.clone(), trns.clone()]] {
            let error = refused("a.png", &png(31, 31, 3, &between, &content));
            assert!(error.contains(&format!("its palette has {length} bytes")), "{error}");
        }
    }
    let whole = [chunk(b"PLTE", &[7; 3]), chunk(b"tRNS", &[9])];
    let image = read("a.png", &png(31, 31, 3, &whole, &content)).expect("a good palette");
    assert_eq!((image.width(), image.height()), (31, 31));
}

#[test]
fn a_header_that_states_more_than_the_file_can_hold_is_refused() {
    for (width, height) in
        [(1 << 20, 1 << 20), (u32::MAX >> 1, u32::MAX >> 1), (16_384, 16_384), (16_384, 3000)]
    {
        let error = refused("a.png", &png(width, height, 6, &[], &packed(1 << 10)));
        assert!(error.contains(&format!("{width} x {height}")) && error.contains("a file of"), "{error}");
        let hdr = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n");
        refused("a.hdr", hdr.as_bytes());
        refused("a.pfm", format!("PF\n{width} {height}\n-1.0\n").as_bytes());
    }
    let error = refused("a.png", &png(40_000, 4, 0, &[], &packed(1 << 10)));
    assert!(error.contains("40000 x 4") || error.contains("limit"), "{error}");
    // The header of an EXR file, with another window: 64 bits a corner, behind the attribute's name, type and size.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("good.exr");
    Image::from_fn(8, 8, |_, _| [0.5; 4]).unwrap().write(&path, Display::AS_IS, None).unwrap();
    let mut bytes = fs::read(&path).unwrap();
    for name in [&b"dataWindow\0box2i\0"[..], b"displayWindow\0box2i\0"] {
        let at = bytes.windows(name.len()).position(|window| window == name).expect("an attribute");
        bytes[at + name.len() + 12..][..8].copy_from_slice(&[[0xff, 0xff, 0, 0]; 2].concat());
    }
    let error = refused("a.exr", &bytes);
    assert!(error.contains("65536 x 65536"), "{error}");
}

#[test]
fn a_header_of_one_long_word_is_quoted_in_part() {
    for start in ["PF\n", "PF\n8 ", ""] {
        let error = refused("a.pfm", format!("{start}{}\n", "(".repeat(100_000)).as_bytes());
        assert!(error.contains("`((((") && error.len() < 500, "{} bytes", error.len());
    }
}

#[test]
fn what_a_file_can_hold_grows_with_it() {
    assert!(decode::check_size(8192, 4096, 0).is_ok());
    assert!(decode::check_size(8192, 4097, 0).is_err());
    assert!(decode::check_size(16_384, 8192, 100 << 10).is_ok());
    assert!(decode::check_size(16_384, 16_384, 1 << 20).is_ok());
    assert!(decode::check_size(16_384, 16_385, u64::MAX).is_err());
    assert!(decode::check_size(u64::MAX, u64::MAX, 1 << 40).is_err());
}

#[test]
fn provenance_that_unpacks_to_gigabytes_is_refused() {
    let mut text = PROVENANCE_KEY.as_bytes().to_vec();
    // Packed, by zlib, without a language or another keyword.
    text.extend([0, 1, 0, 0, 0]);
    let zeros = 32 << 20;
    text.extend(packed(zeros));
    assert!(text.len() < zeros / 500, "{} bytes", text.len());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    fs::write(&path, png(31, 31, 0, &[chunk(b"iTXt", &text)], &packed(1 << 10))).unwrap();
    let error = read_provenance(&path).expect_err("it is too long").to_string();
    assert!(error.contains("a.png"), "{error}");
    assert!(Image::read(&path).is_ok(), "the picture is good");
}

#[test]
fn what_is_no_file_is_not_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    fs::create_dir(&path).unwrap();
    assert!(matches!(Image::read(&path), Err(ImageError::Io { .. })));
    #[cfg(unix)]
    {
        let device = folder.path().join("b.png");
        std::os::unix::fs::symlink("/dev/zero", &device).unwrap();
        let error = Image::read(&device).expect_err("it has no end").to_string();
        assert!(error.contains("it is no file"), "{error}");
    }
}

/// Good files: of each format, with and without alpha and provenance.
static GOOD: LazyLock<Vec<(&'static str, Vec<u8>)>> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let image = Image::from_fn(9, 7, |x, y| [x as f32, y as f32 * 0.1, 0.5, 1.0]).unwrap();
    let alpha = Image::from_fn(40, 33, |x, y| [x as f32, y as f32, 0.25, 0.5]).unwrap();
    let mut files = Vec::new();
    for (name, image, text) in [
        ("a.exr", &image, None),
        ("b.exr", &alpha, Some("{}")),
        ("a.png", &image, Some("{}")),
        ("b.png", &alpha, None),
        ("a.pfm", &image, None),
    ] {
        let path = folder.path().join(name);
        image.write(&path, Display::AS_IS, text).unwrap();
        files.push((name, fs::read(path).unwrap()));
    }
    let palette = [chunk(b"PLTE", &[7; 30]), chunk(b"tRNS", &[9; 4])];
    files.push(("c.png", png(31, 31, 3, &palette, &packed(1 << 10))));
    let rows = [[2, 2, 0, 8, 136, 9, 136, 8, 136, 7, 136, 128].as_slice(); 4].concat();
    files.push(("a.hdr", [b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n".as_slice(), &rows].concat()));
    let mut jpeg = std::io::Cursor::new(Vec::new());
    image::RgbImage::from_fn(20, 20, |x, y| image::Rgb([x as u8 * 12, y as u8 * 9, 99]))
        .write_to(&mut jpeg, image::ImageFormat::Jpeg)
        .unwrap();
    files.push(("a.jpg", jpeg.into_inner()));
    files
});

#[test]
fn the_good_files_are_good() {
    for (name, bytes) in &*GOOD {
        if *name == "a.jpg" {
            decode::picture(bytes, None).expect("a picture");
        } else {
            read(name, bytes).unwrap_or_else(|error| panic!("{error}"));
        }
    }
}

/// Decodes in every way there is.
fn decode_all(name: &str, bytes: &[u8]) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let path: &Path = &folder.path().join(name);
    fs::write(path, bytes).unwrap();
    let mut errors = vec![decode::picture(bytes, None).err()];
    if name != "a.jpg" {
        errors.push(Image::read(path).err().map(|error| error.to_string()));
        errors.push(read_provenance(path).err().map(|error| error.to_string()));
    }
    errors.into_iter().flatten().collect()
}

/// Gives every chunk of a PNG file the checksum that it should have: edits are to reach what is behind it.
fn with_checksums(bytes: &[u8]) -> Vec<u8> {
    let Some(mut rest) = bytes.strip_prefix(b"\x89PNG\r\n\x1a\n") else { return bytes.to_vec() };
    let mut whole = bytes[..8].to_vec();
    while rest.len() >= 12 {
        let length = u32::from_be_bytes([rest[0], rest[1], rest[2], rest[3]]) as usize;
        let Some(content) = rest.get(8..length.saturating_add(8)) else { break };
        whole.extend(chunk(&[rest[4], rest[5], rest[6], rest[7]], content));
        rest = rest.get(length + 12..).unwrap_or_default();
    }
    whole.extend(rest);
    whole
}

proptest! {
    #![proptest_config(mutation::config(600))]

    #[test]
    fn pictures_with_edits(which in 0..8_usize, bytes in mutation::bytes(GOOD.iter().map(|(_, bytes)| bytes.clone())), sums in any::<bool>()) {
        let name = GOOD[which].0;
        let bytes = if sums { with_checksums(&bytes) } else { bytes };
        for error in mutation::within(LIMIT, move || decode_all(name, &bytes)) {
            prop_assert!(!error.is_empty() && error.len() < 2000, "{error}");
        }
    }

    #[test]
    fn pictures_with_edits_under_their_own_names(which in 0..8_usize, seed in any::<prop::sample::Selector>(), at in any::<prop::sample::Index>(), byte in any::<u8>(), cut in 0..20_usize) {
        let (name, mut bytes) = GOOD[which].clone();
        // Among the first bytes, where headers are, more often than elsewhere.
        let near = seed.select([bytes.len(), bytes.len().min(400), bytes.len().min(64)]);
        let at = at.index(near);
        bytes[at] = byte;
        bytes.drain(at..(at + cut.saturating_sub(14)).min(bytes.len()));
        let bytes = with_checksums(&bytes);
        for error in mutation::within(LIMIT, move || decode_all(name, &bytes)) {
            prop_assert!(!error.is_empty() && error.len() < 2000, "{error}");
        }
    }
}
