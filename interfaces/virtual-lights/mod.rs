//! Virtual lights: lights that represent reflected light.

use bytemuck::{Pod, Zeroable};
use pass::{Content, Fact, Interface, Member, OutputDesc, PassTypeError, Struct, UseContext};

/// The most lights there can be.
pub const COUNT: Fact<u32> = Fact::required("count", "the most lights there can be");

/// The struct, for interfaces that have it as a member.
pub const LIGHTS: Struct = Struct::new("interfaces/virtual-lights/virtual-lights.wgsl", "VirtualLights");

/// The interface `VirtualLights`.
pub const INTERFACE: Interface = Interface::new(
    "VirtualLights",
    "Virtual lights, which represent reflected light.",
    &[Member::required("", Content::Struct(LIGHTS), "how many lights there are, and the lights")],
)
.with_facts(&[COUNT.decl()])
.with_folder("interfaces/virtual-lights");

/// `struct VirtualLight` of virtual-lights.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct VirtualLight {
    /// Position in world space \[m\].
    pub position: [f32; 3],
    /// Area of the surface that it represents \[m²\], 1 / (N p) where N lights were sampled with the density p, of a surface
    /// that several lights of the scene see their share; 0 for a point light.
    pub area: f32,
    /// Normal of that surface, unit.
    pub normal: [f32; 3],
    /// Index of the texel that it was sampled from.
    pub texel: u32,
    /// Reflected flux \[W\].
    pub flux: [f32; 3],
    /// Unused; zero.
    pub pad: f32,
}

/// What precedes the lights in `struct VirtualLights` of virtual-lights.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct VirtualLightsHeader {
    /// How many lights there are; those beyond have no meaning.
    pub count: u32,
    /// Unused; zero.
    pub pad: [u32; 3],
}

/// Describes an output of at most `count` virtual lights.
///
/// # Errors
/// Where virtual-lights.wgsl is refused.
pub fn output(cx: &UseContext<'_>, port: &str, count: u32) -> Result<OutputDesc, PassTypeError> {
    Ok(OutputDesc::one(port, cx.buffer(LIGHTS, u64::from(count))?).fact(COUNT, count))
}

/// Returns the bytes of a buffer with these lights, as a pass that writes them leaves it.
pub fn to_bytes(lights: &[VirtualLight]) -> Vec<u8> {
    let header = VirtualLightsHeader { count: lights.len() as u32, pad: [0; 3] };
    [bytemuck::bytes_of(&header), bytemuck::cast_slice(lights)].concat()
}

/// Returns the lights in the bytes of a buffer; `None` where there are too few bytes for its count of lights.
pub fn from_bytes(bytes: &[u8]) -> Option<Vec<VirtualLight>> {
    let (header, rest) = bytes.split_at_checked(size_of::<VirtualLightsHeader>())?;
    let count = bytemuck::pod_read_unaligned::<VirtualLightsHeader>(header).count as usize;
    let lights = rest.get(..count.checked_mul(size_of::<VirtualLight>())?)?;
    Some(bytemuck::pod_collect_to_vec(lights))
}
