//! Portable float map: `PF`, width and height, a scale whose sign is the byte order, then rows of
//! `f32` from the bottom up (<https://www.pauldebevec.com/Research/HDR/PFM/>).

use std::io::{self, Write};

use crate::Image;

/// Writes little-endian RGB; alpha is dropped, since the format has none.
pub(crate) fn write(image: &Image, out: &mut impl Write) -> io::Result<()> {
    write!(out, "PF\n{} {}\n-1.0\n", image.width(), image.height())?;
    for row in image.pixels().chunks_exact(image.width()).rev() {
        for channel in row.iter().flat_map(|rgba| &rgba[..3]) {
            out.write_all(&channel.to_le_bytes())?;
        }
    }
    Ok(())
}

/// Returns the beginning of a word: without blanks, a whole file is one.
fn quoted(word: &str) -> String {
    word.chars().take(16).collect()
}

/// Reads RGB (`PF`) or grey (`Pf`) of either byte order. The error says what was found instead.
pub(crate) fn read(bytes: &[u8]) -> Result<Image, String> {
    let mut rest = bytes;
    let mut word = || -> Result<&str, String> {
        let start = rest.iter().position(|b| !b.is_ascii_whitespace()).ok_or("the header ends early")?;
        let length = rest[start..].iter().position(u8::is_ascii_whitespace).ok_or("the header ends early")?;
        let text = std::str::from_utf8(&rest[start..start + length]).map_err(|_| "the header is not text")?;
        // One blank ends the header; the samples themselves may begin with the byte of a blank.
        rest = &rest[start + length + 1..];
        Ok(text)
    };
    let channels = match word()? {
        "PF" => 3,
        "Pf" => 1,
        other => return Err(format!("the file begins with `{}`", quoted(other))),
    };
    let mut number = |what: &str| -> Result<f64, String> {
        let text = word()?;
        text.parse().map_err(|_| format!("{what} is `{}`", quoted(text)))
    };
    let (width, height, scale) = (number("the width")?, number("the height")?, number("the scale")?);
    let whole = |side: f64| side.fract() == 0.0 && (1.0..=f64::from(u32::MAX)).contains(&side);
    if !whole(width) || !whole(height) || !scale.is_finite() || scale == 0.0 {
        return Err(format!("the header says {width} x {height}, scale {scale}"));
    }
    let (width, height) = (width as usize, height as usize);
    let expected = width.checked_mul(height).and_then(|n| n.checked_mul(4 * channels));
    if expected != Some(rest.len()) {
        return Err(format!("{width} x {height} x {channels} samples do not fit {} bytes", rest.len()));
    }
    let sample = |index: usize| {
        let raw = [0, 1, 2, 3].map(|byte| rest[4 * index + byte]);
        if scale < 0.0 { f32::from_le_bytes(raw) } else { f32::from_be_bytes(raw) }
    };
    Image::from_fn(width, height, |x, y| {
        let first = ((height - 1 - y) * width + x) * channels;
        match channels {
            1 => [sample(first), sample(first), sample(first), 1.0],
            _ => [sample(first), sample(first + 1), sample(first + 2), 1.0],
        }
    })
    .map_err(|error| error.to_string())
}
