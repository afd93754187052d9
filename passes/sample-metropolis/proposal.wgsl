// Uniform proposals: the same Halton sequence in every frame; each element gives a texel and a number to accept it by.

#import "algorithms/scaled.wgsl"
#import "random.wgsl"
#import "rsm-light.wgsl"
#import interface "importance"

/// Layer, column and row of the texel of an element ≥ 1 of Halton's sequence in bases 2, 3, 5.
fn proposed_texel(element: u32, seed: u32) -> vec3<u32> {
    let size = vec3(textureNumLayers(rsm_flux), textureDimensions(rsm_flux));
    // The product with a number below 1 can round up to the size itself.
    return min(vec3<u32>(halton3(element, seed) * vec3<f32>(size)), size - 1u);
}

/// f of the texel of an element, unnormalised.
fn proposed_importance(element: u32, seed: u32) -> f32 {
    let texel = proposed_texel(element, seed);
    return weight_of(importance(texel.x, texel.yz));
}

/// In [2^-24, 1]: the ratio of importances from which on an element is accepted; base 7, the next of the sequence.
fn threshold(element: u32, seed: u32) -> f32 {
    var number = radical_inverse(7u, element);
    if seed != 0u {
        number = fract(number + unit_float(hash2(seed, 3u)));
    }
    return 1.0 - min(number, 0.99999994);
}
