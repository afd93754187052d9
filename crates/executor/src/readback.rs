//! Copies of resources in the program's memory, after a frame.

use crate::error::ExecutorError;
use crate::gpu::Gpu;
use crate::object::Object;
use frame_graph::ResourceDesc;

/// Maps a buffer of usage `MAP_READ`, waits for the GPU, and copies its bytes. `name` is that in errors.
///
/// # Errors
/// [`ExecutorError::ReadBack`], and those of [`Gpu::wait`].
pub fn map(gpu: &Gpu, buffer: &wgpu::Buffer, name: &str) -> Result<Vec<u8>, ExecutorError> {
    let error = |message: String| ExecutorError::ReadBack { resource: name.to_owned(), message };
    let (sender, receiver) = std::sync::mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        // The receiver waits below; it cannot be gone.
        let _ = sender.send(result);
    });
    gpu.wait()?;
    // Another thread's poll may be the one that runs the callback: it comes in any case, and is waited for.
    match receiver.recv() {
        Ok(Ok(())) => {}
        // Why the buffer is none that can be mapped was reported before.
        Ok(Err(refused)) => return Err(error(gpu.take_fault().unwrap_or_else(|| refused.to_string()))),
        Err(_) => return Err(error("the device did not answer".to_owned())),
    }
    let mut bytes = room(name, buffer.size())?;
    bytes.extend_from_slice(&buffer.get_mapped_range(..).map_err(|refused| error(refused.to_string()))?);
    buffer.unmap();
    Ok(bytes)
}

/// Returns an empty vector for this many bytes: a picture may be larger than the memory, which is an error.
fn room(name: &str, size: u64) -> Result<Vec<u8>, ExecutorError> {
    let mut bytes = Vec::new();
    match usize::try_from(size).map(|size| bytes.try_reserve_exact(size)) {
        Ok(Ok(())) => Ok(bytes),
        _ => Err(no_memory(name, size)),
    }
}

fn no_memory(name: &str, size: u64) -> ExecutorError {
    let message = format!("out of memory: the copy needs {size} bytes");
    ExecutorError::ReadBack { resource: name.to_owned(), message }
}

/// The bytes of an object, row by row and layer by layer, without padding.
pub(crate) fn read(
    gpu: &Gpu,
    name: &str,
    desc: &ResourceDesc,
    object: &Object,
) -> Result<Vec<u8>, ExecutorError> {
    let staging = |size: u64| {
        let memory = gpu.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("read back"),
            size,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        match pollster::block_on(memory.pop()) {
            Some(_) => Err(no_memory(name, size)),
            None => Ok(buffer),
        }
    };
    let mut encoder =
        gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("read back") });
    match (desc, object) {
        (ResourceDesc::Buffer(buffer), Object::Buffer(source)) => {
            let target = staging(buffer.bytes)?;
            encoder.copy_buffer_to_buffer(source, 0, &target, 0, buffer.bytes);
            gpu.submit(Some(encoder.finish()));
            map(gpu, &target, name)
        }
        (ResourceDesc::Texture(texture), Object::Texture { texture: source, .. }) => {
            let row = u64::from(texture.size.0) * texture.format.bytes();
            let padded = row.next_multiple_of(u64::from(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT));
            let rows = u64::from(texture.size.1) * u64::from(texture.layers);
            let target = staging(padded * rows)?;
            encoder.copy_texture_to_buffer(
                source.as_image_copy(),
                wgpu::TexelCopyBufferInfo {
                    buffer: &target,
                    layout: wgpu::TexelCopyBufferLayout {
                        offset: 0,
                        bytes_per_row: u32::try_from(padded).ok(),
                        rows_per_image: Some(texture.size.1),
                    },
                },
                wgpu::Extent3d {
                    width: texture.size.0,
                    height: texture.size.1,
                    depth_or_array_layers: texture.layers,
                },
            );
            gpu.submit(Some(encoder.finish()));
            let bytes = map(gpu, &target, name)?;
            let mut dense = room(name, row * rows)?;
            for padded_row in bytes.chunks_exact(padded as usize) {
                dense.extend_from_slice(&padded_row[..row as usize]);
            }
            Ok(dense)
        }
        _ => Err(ExecutorError::ReadBack {
            resource: name.to_owned(),
            message: "its object is of another sort".to_owned(),
        }),
    }
}
