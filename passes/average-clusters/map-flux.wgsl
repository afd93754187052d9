// The flux of all texels of a reflective shadow map, whether they are in a cluster or not.

#import "algorithms/sum-vec4.wgsl"
#import "clustering.wgsl"

var rsm_position: texture_2d_array<f32>;
var rsm_flux: texture_2d_array<f32>;
var<storage, read_write> averaged: Clusters;

fn reduce_length() -> u32 {
    let size = textureDimensions(rsm_position);
    return size.x * size.y * textureNumLayers(rsm_position);
}

fn reduce_element(i: u32) -> vec4<f32> {
    let size = textureDimensions(rsm_position);
    let texel = vec2(i % size.x, i / size.x % size.y);
    let layer = i / (size.x * size.y);
    if !is_lit(textureLoad(rsm_position, texel, layer, 0)) {
        return vec4(0.0);
    }
    return vec4(flux_of(textureLoad(rsm_flux, texel, layer, 0).rgb), 1.0);
}

fn reduce_store(result: vec4<f32>) {
    averaged.header.map_flux = flux_of(result.rgb);
}
