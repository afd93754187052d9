//! What passes read and write: textures and buffers, described without a GPU.

use std::fmt;
use unit_prefix::NumberPrefix;

/// The format of a texture's texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[allow(missing_docs, reason = "the names are WebGPU's")]
pub enum Format {
    R8Unorm,
    Rgba8Unorm,
    Rgba8UnormSrgb,
    R16Float,
    Rg16Float,
    Rgba16Float,
    R32Float,
    Rg32Float,
    Rgba32Float,
    R32Uint,
    Rg32Uint,
    Rgba32Uint,
    Depth32Float,
}

/// How a shader sees a texel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SampleKind {
    /// `f32`
    Float,
    /// `u32`
    Uint,
    /// A depth texture.
    Depth,
}

impl Format {
    /// Every format there is.
    pub const ALL: [Format; 13] = [
        Format::R8Unorm,
        Format::Rgba8Unorm,
        Format::Rgba8UnormSrgb,
        Format::R16Float,
        Format::Rg16Float,
        Format::Rgba16Float,
        Format::R32Float,
        Format::Rg32Float,
        Format::Rgba32Float,
        Format::R32Uint,
        Format::Rg32Uint,
        Format::Rgba32Uint,
        Format::Depth32Float,
    ];

    /// Returns the bytes of one texel.
    pub fn bytes(self) -> u64 {
        match self {
            Format::R8Unorm => 1,
            Format::R16Float => 2,
            Format::Rgba8Unorm
            | Format::Rgba8UnormSrgb
            | Format::Rg16Float
            | Format::R32Float
            | Format::R32Uint
            | Format::Depth32Float => 4,
            Format::Rgba16Float | Format::Rg32Float | Format::Rg32Uint => 8,
            Format::Rgba32Float | Format::Rgba32Uint => 16,
        }
    }

    /// Returns the name in RON and in WGSL: `rgba16float`.
    pub fn name(self) -> &'static str {
        match self {
            Format::R8Unorm => "r8unorm",
            Format::Rgba8Unorm => "rgba8unorm",
            Format::Rgba8UnormSrgb => "rgba8unorm-srgb",
            Format::R16Float => "r16float",
            Format::Rg16Float => "rg16float",
            Format::Rgba16Float => "rgba16float",
            Format::R32Float => "r32float",
            Format::Rg32Float => "rg32float",
            Format::Rgba32Float => "rgba32float",
            Format::R32Uint => "r32uint",
            Format::Rg32Uint => "rg32uint",
            Format::Rgba32Uint => "rgba32uint",
            Format::Depth32Float => "depth32float",
        }
    }

    /// Returns the format of this name.
    pub fn from_name(name: &str) -> Option<Format> {
        Format::ALL.into_iter().find(|format| format.name() == name)
    }

    /// Returns how a shader sees a texel of this format.
    pub fn sample_kind(self) -> SampleKind {
        match self {
            Format::R32Uint | Format::Rg32Uint | Format::Rgba32Uint => SampleKind::Uint,
            Format::Depth32Float => SampleKind::Depth,
            _ => SampleKind::Float,
        }
    }
}

/// Width and height as a relation to other sizes, computed in link order.
#[derive(Clone, Debug, PartialEq)]
pub enum Extent {
    /// The frame's size times `num / den`, rounded up, at least one.
    Frame {
        /// Numerator.
        num: u32,
        /// Denominator.
        den: u32,
    },
    /// The size of the first texture of an input port times `num / den`, rounded up, at least one.
    Like {
        /// Name of the input port.
        input: String,
        /// Numerator.
        num: u32,
        /// Denominator.
        den: u32,
    },
    /// Fixed: `(width, height)` in texels.
    Fixed(u32, u32),
}

/// A texture as a pass declares it (`S` = [`Extent`]) or with known size (`S` = `(u32, u32)`).
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct TextureDesc<S> {
    /// Format of the texels.
    pub format: Format,
    /// Width and height in texels.
    pub size: S,
    /// Layers of a 2d array; a texture with `array` unset has one.
    pub layers: u32,
    /// Bound as `texture_2d_array` even where there is one layer.
    pub array: bool,
}

/// A buffer.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct BufferDesc {
    /// Size in bytes; a multiple of four.
    pub bytes: u64,
}

/// A texture or a buffer.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum ResourceDesc<S = (u32, u32)> {
    /// A texture.
    Texture(TextureDesc<S>),
    /// A buffer.
    Buffer(BufferDesc),
}

/// The value that fills a resource: before its first use, at the reset of a history buffer, or in place of a pass that
/// is switched off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Clear {
    /// Zero in every bit.
    Zero,
    /// This color in every texel; for textures of floats.
    Color([f32; 4]),
}

/// Returns a number of bytes as people read it: `512 B`, `1.5 KiB`, `46.1 MiB`.
pub fn human_bytes(bytes: u64) -> String {
    match NumberPrefix::binary(bytes as f64) {
        NumberPrefix::Standalone(_) => format!("{bytes} B"),
        NumberPrefix::Prefixed(prefix, number) => format!("{number:.1} {prefix}B"),
    }
}

impl ResourceDesc<(u32, u32)> {
    /// Returns the size in bytes, without any padding of the driver's.
    pub fn bytes(&self) -> u64 {
        match self {
            ResourceDesc::Texture(t) => {
                u64::from(t.size.0) * u64::from(t.size.1) * u64::from(t.layers) * t.format.bytes()
            }
            ResourceDesc::Buffer(b) => b.bytes,
        }
    }

    /// Returns the texture, if it is one.
    pub fn texture(&self) -> Option<&TextureDesc<(u32, u32)>> {
        if let ResourceDesc::Texture(t) = self { Some(t) } else { None }
    }
}

impl fmt::Display for ResourceDesc<(u32, u32)> {
    /// `rgba16float 480×270`, `r32uint 64×64×8`, or `buffer of 4096 bytes`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ResourceDesc::Texture(t) => {
                write!(f, "{} {}×{}", t.format.name(), t.size.0, t.size.1)?;
                if t.array { write!(f, "×{}", t.layers) } else { Ok(()) }
            }
            ResourceDesc::Buffer(b) => write!(f, "buffer of {} bytes", b.bytes),
        }
    }
}

impl fmt::Display for Clear {
    /// Writes the value as RON does.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Clear::Zero => f.write_str("Zero"),
            Clear::Color([r, g, b, a]) => write!(f, "Color({r:?}, {g:?}, {b:?}, {a:?})"),
        }
    }
}

impl<S> ResourceDesc<S> {
    /// Describes a texture of one layer.
    pub fn texture_2d(format: Format, size: S) -> Self {
        ResourceDesc::Texture(TextureDesc { format, size, layers: 1, array: false })
    }

    /// Describes a texture array.
    pub fn texture_2d_array(format: Format, size: S, layers: u32) -> Self {
        ResourceDesc::Texture(TextureDesc { format, size, layers, array: true })
    }

    /// Describes a buffer of `bytes`, rounded up to a multiple of 16.
    pub fn buffer(bytes: u64) -> Self {
        ResourceDesc::Buffer(BufferDesc { bytes: bytes.next_multiple_of(16).max(16) })
    }
}

impl Extent {
    /// The frame's own size.
    pub const FRAME: Extent = Extent::Frame { num: 1, den: 1 };

    /// Returns the size of an input.
    pub fn like(input: &str) -> Extent {
        Extent::Like { input: input.to_owned(), num: 1, den: 1 }
    }
}

impl fmt::Display for Extent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (num, den) = match self {
            Extent::Frame { num, den } => {
                f.write_str("frame")?;
                (*num, *den)
            }
            Extent::Like { input, num, den } => {
                write!(f, "like({input:?})")?;
                (*num, *den)
            }
            Extent::Fixed(w, h) => return write!(f, "({w}, {h})"),
        };
        if num != 1 {
            write!(f, " * {num}")?;
        }
        if den != 1 {
            write!(f, " / {den}")?;
        }
        Ok(())
    }
}
