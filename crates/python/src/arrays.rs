//! Pictures and buffers as NumPy arrays, which own what was read back.

use anyhow::{Result, ensure};
use frame_graph::plan::PlannedResource;
use frame_graph::{Format, ResourceDesc};
use metrics::Image;
use numpy::{
    PyArray1, PyArray2, PyArray3, PyArrayMethods as _, PyReadonlyArray3, PyUntypedArrayMethods as _,
};
use pass::BoundLayout;
use pyo3::prelude::*;
use serde_json::{Value as Json, json};

/// Returns a picture as an array `[height, width, 4]`, which takes its memory.
pub(crate) fn pixels(py: Python<'_>, image: Image) -> PyResult<Bound<'_, PyArray3<f32>>> {
    let shape = [image.height(), image.width(), 4];
    PyArray1::from_vec(py, bytemuck::cast_vec::<[f32; 4], f32>(image.into_pixels())).reshape(shape)
}

/// Returns numbers as an array `[height, width]`, which takes their memory.
pub(crate) fn grid(
    py: Python<'_>,
    numbers: Vec<f32>,
    shape: [usize; 2],
) -> PyResult<Bound<'_, PyArray2<f32>>> {
    PyArray1::from_vec(py, numbers).reshape(shape)
}

/// Returns an array `[height, width, 3 or 4]` as a picture.
pub(crate) fn image_of(array: &PyReadonlyArray3<'_, f32>) -> Result<Image> {
    let &[height, width, channels] = array.shape() else { unreachable!("it has three dimensions") };
    ensure!(
        matches!(channels, 3 | 4),
        "a picture is an array [height, width, 3] or [height, width, 4]; found [{height}, {width}, {channels}]"
    );
    let view = array.as_array();
    let of = |x: usize, y: usize| {
        let channel = |c| if c < channels { view[[y, x, c]] } else { 1.0 };
        [channel(0), channel(1), channel(2), channel(3)]
    };
    Ok(Image::from_fn(width, height, of)?)
}

/// Describes the bytes of a resource, for NumPy: `dtype` and `shape` of a texture, of which the last dimension is that of
/// channels; `header`, `start` and `dtype` of a buffer that a shader declares, and nothing of one that none does. A structured
/// type is an object of names, formats, offsets and itemsize.
pub(crate) fn described(resource: &PlannedResource, layout: Option<&BoundLayout>) -> Json {
    if let ResourceDesc::Texture(texture) = &resource.desc {
        let (channels, dtype) = texels(texture.format);
        let (width, height) = texture.size;
        return json!({ "dtype": dtype, "shape": [texture.layers, height, width, channels] });
    }
    let Some(BoundLayout { layout, window, .. }) = layout else { return json!({}) };
    let structured = |columns: &[shader_library::decode::Column], size: usize| {
        let each =
            |f: &dyn Fn(&shader_library::decode::Column) -> Json| columns.iter().map(f).collect::<Json>();
        json!({
            "names": each(&|column| json!(column.name)),
            "formats": each(&|column| {
                let (scalar, dimensions) = column.held();
                json!([scalar, dimensions])
            }),
            "offsets": each(&|column| json!(column.offset)),
            "itemsize": size,
        })
    };
    json!({
        "header": structured(&layout.header, layout.start()),
        "start": layout.start(),
        "dtype": structured(&layout.columns, layout.stride()),
        "window": window.as_ref().map(|window| [window.start, window.end]),
    })
}

/// The number of channels of a texel, and the type of each as NumPy names it.
fn texels(format: Format) -> (usize, &'static str) {
    match format {
        Format::R8Unorm => (1, "u1"),
        Format::Rgba8Unorm | Format::Rgba8UnormSrgb => (4, "u1"),
        Format::R16Float => (1, "<f2"),
        Format::Rg16Float => (2, "<f2"),
        Format::Rgba16Float => (4, "<f2"),
        Format::R32Float | Format::Depth32Float => (1, "<f4"),
        Format::Rg32Float => (2, "<f4"),
        Format::Rgba32Float => (4, "<f4"),
        Format::R32Uint => (1, "<u4"),
        Format::Rg32Uint => (2, "<u4"),
        Format::Rgba32Uint => (4, "<u4"),
    }
}
