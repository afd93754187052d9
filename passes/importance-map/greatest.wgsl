// The greatest values of a map: of what texels reflect, and then of their importance, which needs the first.

#option OF reflected one_of [reflected, importance] internal // the value

#import "algorithms/reduce.wgsl"
#import "reflectance-values.wgsl"

struct Settings {
    texels: u32,
    view_weight: f32,
}

var<uniform> settings: Settings;
var<storage, read> values: array<ReflectanceValues>;
var<storage, read_write> greatest: GreatestValues;

alias Reduced = f32;

fn reduce_identity() -> f32 {
    return 0.0;
}

fn reduce_both(a: f32, b: f32) -> f32 {
    return max(a, b);
}

fn reduce_workgroup(thread: u32, own: f32) -> f32 {
    return workgroup_max(thread, own);
}

fn reduce_length() -> u32 {
    return settings.texels;
}

fn reduce_element(i: u32) -> f32 {
#if OF == reflected
    return values[i].reflected;
#else
    return importance_by_reflectance(values[i], greatest.reflected, settings.view_weight);
#endif
}

fn reduce_store(result: f32) {
#if OF == reflected
    greatest.reflected = result;
#else
    greatest.importance = result;
#endif
}
