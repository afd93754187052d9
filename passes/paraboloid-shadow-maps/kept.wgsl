// The maps to render where maps are kept: their number in each layer, and their place in the list.

struct LayerDraws {
    /// The draw that clears the maps of a layer: vertices, instances, first vertex, first instance.
    clear: vec4<u32>,
    /// The draw of the scene into them.
    scene: vec4<u32>,
}
