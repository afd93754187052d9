// Importance whose greatest value is 1, so that ACRSM Eq. 4.4 and 4.6 can add and compare it with what else is at most 1.

#import "reflectance-values.wgsl"

struct Settings {
    view_weight: f32,
}

var<uniform> settings: Settings;
var<storage, read> values: array<ReflectanceValues>;
var<storage, read> greatest: GreatestValues;
var importance_map: texture_storage_2d_array<r32float, write>;

@compute @workgroup_size(16, 16)
fn normalise(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(importance_map);
    if any(id.xy >= size) {
        return;
    }
    let value = values[(id.z * size.y + id.y) * size.x + id.x];
    let importance = importance_by_reflectance(value, greatest.reflected, settings.view_weight);
    textureStore(importance_map, id.xy, id.z, vec4(part_of(importance, greatest.importance)));
}
