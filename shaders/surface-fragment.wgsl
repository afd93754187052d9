// The surface of a fragment.

#import "surface.wgsl"

/// The material at a fragment, filtered over a pixel. Where it is cut out at the pixel's centre, the fragment is discarded.
fn fragment_surface(material: u32, uv: vec2<f32>, change: Change) -> Surface {
    if !surface_exists(material, uv) {
        discard;
    }
    return surface(material, uv, change.uv_x, change.uv_y);
}
