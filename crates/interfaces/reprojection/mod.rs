//! Where what pixels show was in the frame before.

use pass::{Content, Format, Interface, Member};

/// The interface `Reprojection`.
pub const INTERFACE: Interface = Interface::new(
    "Reprojection",
    "Where what each pixel shows was in the frame before.",
    &[
        Member::required(
            "place",
            Content::Texture(Format::Rg32Float),
            "the place in the frame before; the centre of the first pixel is at 0.5 [px]",
        ),
        Member::required(
            "texels",
            Content::Texture(Format::R32Uint),
            "which of the four texels around the place showed it: bits 0 to 3 for left and right above, left and right below; \
             bit 4 where nothing at all has moved",
        ),
    ],
)
.with_folder("crates/interfaces/reprojection");

wgsl_structs::wgsl! {
    "reprojection/reprojection.wgsl" {
        pub const ALL_TEXELS;
        pub const STANDS_STILL;
    }
}
