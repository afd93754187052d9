//! Pictures that other implementations can make again, byte for byte.

use metrics::{Image, linear_from_srgb};

pub(crate) const WIDTH: usize = 64;
pub(crate) const HEIGHT: usize = 48;

/// A picture of bytes, from column, row and channel.
pub(crate) type Pattern = fn(u32, u32, u32) -> u32;

pub(crate) fn noise(x: u32, y: u32, channel: u32) -> u32 {
    let n = x
        .wrapping_mul(374_761_393)
        .wrapping_add(y.wrapping_mul(668_265_263))
        .wrapping_add(channel.wrapping_mul(2_246_822_519));
    let n = (n ^ (n >> 13)).wrapping_mul(1_274_126_177);
    (n ^ (n >> 16)) & 0xff
}

pub(crate) fn gradient(x: u32, y: u32, channel: u32) -> u32 {
    [x * 4, y * 5, (x + y) * 2][channel as usize]
}

pub(crate) fn noisy_gradient(x: u32, y: u32, channel: u32) -> u32 {
    (gradient(x, y, channel) + noise(x, y, channel) / 4).saturating_sub(32).min(255)
}

pub(crate) fn shifted_gradient(x: u32, y: u32, channel: u32) -> u32 {
    gradient(x.saturating_sub(2), y, channel)
}

pub(crate) fn checkers(x: u32, y: u32, _: u32) -> u32 {
    if (x / 8 + y / 8) % 2 == 1 { 230 } else { 25 }
}

pub(crate) fn tinted_checkers(x: u32, y: u32, channel: u32) -> u32 {
    if ((x + 1) / 8 + y / 8) % 2 == 1 { 230 } else { [25, 60, 25][channel as usize] }
}

pub(crate) fn picture(pattern: Pattern, decode: fn(f32) -> f32) -> Image {
    Image::from_fn(WIDTH, HEIGHT, |x, y| {
        let [r, g, b] = [0, 1, 2].map(|c| decode(pattern(x as u32, y as u32, c) as f32));
        [r, g, b, 1.0]
    })
    .unwrap()
}

pub(crate) fn srgb(byte: f32) -> f32 {
    linear_from_srgb(byte / 255.0)
}

/// Radiance from 0 to some 63.
pub(crate) fn radiance(byte: f32) -> f32 {
    (byte / 32.0).powi(2)
}
