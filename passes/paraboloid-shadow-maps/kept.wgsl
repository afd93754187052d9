// What is to be rendered of maps that are kept: how many of each layer, and where they are in the list.

struct LayerDraws {
    /// The draw that clears the maps of a layer: vertices, instances, first vertex, first instance.
    clear: vec4<u32>,
    /// The draw of the scene into them.
    scene: vec4<u32>,
}
