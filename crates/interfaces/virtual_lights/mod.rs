//! Virtual lights: lights that represent reflected or emitted light, or light from infinitely far.

use pass::{Content, Fact, Interface, Member, OutputDesc, PassTypeError, Struct, UseContext};

/// The most lights there can be.
pub const COUNT: Fact<u32> = Fact::required("count", "the most lights there can be");

/// The struct, for interfaces that have it as a member.
pub const LIGHTS: Struct =
    Struct::new("crates/interfaces/virtual_lights/virtual-lights.wgsl", "VirtualLights");

/// The interface `VirtualLights`.
pub const INTERFACE: Interface = Interface::new(
    "VirtualLights",
    "Virtual lights, which represent reflected light.",
    &[
        Member::required("", Content::Struct(LIGHTS), "how many lights there are, and the lights"),
        Member::optional(
            "lobes",
            Content::Array("VirtualLobe"),
            "what the surface of each light reflects specularly (virtual-lobe.wgsl), where the sampler is asked for it",
        ),
    ],
)
.with_facts(&[COUNT.decl()])
.with_folder("crates/interfaces/virtual_lights");

wgsl_structs::wgsl! {
    "virtual_lights/virtual-lights.wgsl" {
        pub struct VirtualLight;
        pub struct VirtualLights as VirtualLightsHeader;
    }
    "virtual_lights/virtual-lobe.wgsl" {
        pub struct VirtualLobe;
    }
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
    let header = VirtualLightsHeader { count: lights.len() as u32, ..Default::default() };
    [bytemuck::bytes_of(&header), bytemuck::cast_slice(lights)].concat()
}

/// Returns the lights in the bytes of a buffer; `None` where there are too few bytes for its count of lights.
pub fn from_bytes(bytes: &[u8]) -> Option<Vec<VirtualLight>> {
    let (_, lights) = crate::with_rows(bytes, |header: &VirtualLightsHeader| header.count)?;
    Some(lights)
}
