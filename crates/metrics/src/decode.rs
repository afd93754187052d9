//! Decoding of foreign pictures: bounded in size before memory is allocated, and without panics.

use std::fs::{self, File};
use std::io::{self, Cursor, Read};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use image::{DynamicImage, ImageFormat, ImageReader, Limits};

/// The greatest width and height: GPUs guarantee no more.
pub const MAX_SIDE: u32 = 16384;

/// The most bytes of a file: those of an EXR picture of 2¹⁶ × 2¹² pixels that cannot be compressed.
const MAX_BYTES: u64 = 4 << 30;

/// The most pixels of a picture, whatever the size of its file: 4 GiB once they are `f32`.
const MAX_PIXELS: u64 = 1 << 28;

/// Pixels that a file of any size may hold: 8192 × 4096, 0.5 GiB once they are `f32`.
const FREE_PIXELS: u64 = 1 << 25;

/// The first bytes of a PNG file.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Pixels that each byte of a file may hold beyond that: deflate, the best of what the formats use, packs 258 bytes into
/// two bits, so that a picture of a single color stays below it, and a header that states any size does not.
const PIXELS_PER_BYTE: u64 = 1024;

/// Checks that a picture is not larger than its file can hold.
///
/// # Errors
/// The requested size and the bound, in words that follow "but ".
pub fn check_size(width: u64, height: u64, file_bytes: u64) -> Result<(), String> {
    let most = FREE_PIXELS.saturating_add(file_bytes.saturating_mul(PIXELS_PER_BYTE)).min(MAX_PIXELS);
    if width.saturating_mul(height) <= most {
        return Ok(());
    }
    Err(format!("the header says {width} x {height} pixels; a file of {file_bytes} bytes may have {most}"))
}

/// Returns width and height of a PNG, JPEG or HDR picture, from its header alone. Without a `format`, its first bytes tell
/// whether it is PNG or JPEG.
///
/// # Errors
/// The error of the file, in words that follow "but ".
pub fn size(bytes: &[u8], format: Option<ImageFormat>) -> Result<(u32, u32), String> {
    match bytes.strip_prefix(PNG) {
        Some(chunks) => png_size(chunks),
        None => guarded(|| reader(bytes, format)?.into_dimensions().map_err(|error| error.to_string())),
    }
}

/// Decodes a PNG, JPEG or HDR picture of at most [`MAX_SIDE`] pixels each way. Without a `format`, its first bytes tell
/// whether it is PNG or JPEG.
///
/// # Errors
/// The error of the file, in words that follow "but ".
pub fn picture(bytes: &[u8], format: Option<ImageFormat>) -> Result<DynamicImage, String> {
    let (width, height) = size(bytes, format)?;
    check_size(width.into(), height.into(), bytes.len() as u64)?;
    guarded(|| {
        let mut reader = reader(bytes, format)?;
        let mut limits = Limits::default();
        limits.max_image_width = Some(MAX_SIDE);
        limits.max_image_height = Some(MAX_SIDE);
        // Four channels of 32 bits, and as much for what the decoder keeps beside.
        limits.max_alloc = Some((u64::from(width) * u64::from(height) * 32).saturating_add(64 << 20));
        reader.limits(limits);
        let decoded = reader.decode().map_err(|error| error.to_string())?;
        if decoded.width() == 0 || decoded.height() == 0 {
            return Err("it has no pixels".to_owned());
        }
        Ok(decoded)
    })
}

fn reader(bytes: &[u8], format: Option<ImageFormat>) -> Result<ImageReader<Cursor<&[u8]>>, String> {
    let guessed = || image::guess_format(bytes).ok();
    match format.or_else(|| guessed().filter(|guess| matches!(guess, ImageFormat::Png | ImageFormat::Jpeg))) {
        Some(format) => Ok(ImageReader::with_format(Cursor::new(bytes), format)),
        None => Err("it is neither PNG nor JPEG".to_owned()),
    }
}

/// Calls a decoder. Those of the formats are others' work and handed whatever is in a file; a panic of one (png 0.18 has
/// some, for palettes) is an error of that file and not the end of the program. What the decoder worked on is dropped
/// with it, so that nothing half done is seen.
///
/// # Errors
/// Those of the decoder, and that it failed.
pub(crate) fn guarded<T>(decoder: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(decoder)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no reason given");
        Err(format!("its decoder failed: {text}"))
    })
}

/// Returns the size that the chunks of a PNG file state. The decoder of `image` gives it only within a limit on memory,
/// which has to follow from it. Also checks the palette, for which png 0.18 panics: it must have whole colors.
fn png_size(mut chunks: &[u8]) -> Result<(u32, u32), String> {
    let number = |bytes: &[u8]| u32::from_be_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
    let mut size = None;
    // A chunk: its length, its kind, its content, a checksum.
    while let Some((head, behind)) = chunks.split_at_checked(8) {
        let length = number(head) as usize;
        match (&head[4..], behind.split_at_checked(8)) {
            (b"IHDR", Some((sides, _))) => size = size.or(Some((number(sides), number(&sides[4..])))),
            (b"PLTE", _) if length == 0 || !length.is_multiple_of(3) || length > 3 * 256 => {
                return Err(format!(
                    "its palette has {length} bytes; expected 3 for each of 1 to 256 colors"
                ));
            }
            (b"IDAT", _) => break,
            _ => {}
        }
        chunks = behind.get(length.saturating_add(4)..).unwrap_or_default();
    }
    size.ok_or_else(|| "it has no PNG header".to_owned())
}

/// Reads a file of a scene or a picture whole.
///
/// # Errors
/// Those of the system; and where it is no file, such as a device without an end, or larger than any picture.
pub fn read_file(path: &Path) -> io::Result<Vec<u8>> {
    let refused = |why: &str| io::Error::new(io::ErrorKind::InvalidInput, why);
    // Before it is opened: a FIFO would wait for its writer.
    let about = fs::metadata(path)?;
    if !about.is_file() {
        return Err(refused("it is no file"));
    }
    if about.len() > MAX_BYTES {
        return Err(refused(&format!("it has {} bytes; at most {MAX_BYTES} are read", about.len())));
    }
    let mut bytes = Vec::with_capacity(about.len() as usize);
    File::open(path)?.take(MAX_BYTES).read_to_end(&mut bytes)?;
    Ok(bytes)
}
