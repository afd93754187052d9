//! The device: opened here, or passed in by an application.

use crate::error::ExecutorError;
use crate::pipeline::Pipelines;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use wgpu::{Adapter, AdapterInfo, Backends, Device, Features, Instance, Limits, Queue};

/// A device with its queue, and the first error that it reported.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// The device.
    pub device: Device,
    /// Its queue.
    pub queue: Queue,
    /// The adapter's name, driver and type.
    pub info: AdapterInfo,
    /// Where the device was opened here: it counts the objects.
    instance: Option<Instance>,
    /// The bytes that plans may take; `None` where the memory of the adapter is not known.
    memory: Option<u64>,
    faults: Arc<Faults>,
    /// What the executors on this device share, where they do.
    pipelines: Option<Arc<Mutex<Pipelines>>>,
}

/// The errors that a device has reported outside of the calls that caused them.
#[derive(Debug, Default)]
struct Faults {
    /// The first error that nobody has taken.
    first: Mutex<Option<String>>,
    /// Why the device is gone. It never comes back.
    lost: OnceLock<String>,
}

impl Gpu {
    /// Features that are used where the adapter has them; none is required.
    pub const WANTED: Features = Features::TIMESTAMP_QUERY
        .union(Features::FLOAT32_FILTERABLE)
        .union(Features::INDIRECT_FIRST_INSTANCE)
        .union(Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES)
        .union(Features::EXPERIMENTAL_RAY_QUERY);

    /// Opens the best adapter, without a window. `WGPU_ADAPTER_NAME` and `WGPU_BACKEND` choose another.
    ///
    /// # Errors
    /// [`ExecutorError::NoAdapter`] with what to install, or the error of the driver.
    pub fn open() -> Result<Gpu, ExecutorError> {
        let _phase = tracing::info_span!(target: "phase", "adapter and device").entered();
        pollster::block_on(Self::open_async(None))
    }

    /// Opens an adapter by its place in [`Gpu::adapters`], from 0, or by a part of its name, without a window.
    ///
    /// # Errors
    /// [`ExecutorError::NoSuchAdapter`] with the adapters that there are, or the error of the driver.
    pub fn open_adapter(wanted: &str) -> Result<Gpu, ExecutorError> {
        let _phase = tracing::info_span!(target: "phase", "adapter and device").entered();
        pollster::block_on(Self::open_async(Some(wanted)))
    }

    /// Returns the adapters, with the one that [`Gpu::open`] chooses first.
    pub fn adapters() -> Vec<AdapterInfo> {
        pollster::block_on(Self::sorted_adapters()).1.iter().map(Adapter::get_info).collect()
    }

    async fn sorted_adapters() -> (Instance, Vec<Adapter>) {
        let instance = Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        let backends = Backends::from_env().unwrap_or(Backends::PRIMARY);
        let mut adapters: Vec<Adapter> = instance.enumerate_adapters(backends).await;
        if let Ok(wanted) = std::env::var("WGPU_ADAPTER_NAME") {
            let wanted = wanted.to_lowercase();
            adapters.retain(|adapter| adapter.get_info().name.to_lowercase().contains(&wanted));
        }
        adapters.sort_by_key(|adapter| match adapter.get_info().device_type {
            wgpu::DeviceType::DiscreteGpu => 0,
            wgpu::DeviceType::IntegratedGpu => 1,
            wgpu::DeviceType::VirtualGpu => 2,
            wgpu::DeviceType::Cpu => 3,
            wgpu::DeviceType::Other => 4,
        });
        (instance, adapters)
    }

    async fn open_async(wanted: Option<&str>) -> Result<Gpu, ExecutorError> {
        let (instance, adapters) = Self::sorted_adapters().await;
        let names: Vec<String> = adapters.iter().map(|adapter| adapter.get_info().name).collect();
        let place = wanted.map_or(Some(0), |wanted| place_of(wanted, &names));
        let adapter = match (place.and_then(|place| adapters.get(place)), wanted) {
            (Some(adapter), _) => adapter,
            (None, Some(wanted)) if !names.is_empty() => {
                let known = names.iter().enumerate().map(|(index, name)| format!("{index}: {name}"));
                let known = known.collect::<Vec<_>>().join(", ");
                return Err(ExecutorError::NoSuchAdapter { wanted: wanted.to_owned(), known });
            }
            (None, _) => return Err(ExecutorError::NoAdapter),
        };
        let (device, queue) =
            adapter.request_device(&Self::device_descriptor(adapter)).await.map_err(|error| {
                ExecutorError::Device { adapter: adapter.get_info().name, message: error.to_string() }
            })?;
        let gpu = Gpu::from_device(device, queue, adapter.get_info());
        Ok(Gpu { instance: Some(instance), memory: memory_of(adapter), ..gpu })
    }

    /// Lets all executors on this device and its clones share their pipelines, and keeps those that none uses any more, some
    /// hundreds of them: for a program in which one renderer follows another.
    pub fn with_shared_pipelines(self) -> Gpu {
        const MOST_UNUSED: usize = 256;
        Gpu { pipelines: Some(Arc::new(Mutex::new(Pipelines::keeping(MOST_UNUSED)))), ..self }
    }

    /// Returns the pipelines for an executor: its own, or those that all share.
    pub(crate) fn pipelines(&self) -> Arc<Mutex<Pipelines>> {
        self.pipelines.clone().unwrap_or_default()
    }

    /// Refuses plans that need more bytes, before any of their objects is created.
    pub fn with_memory(self, bytes: u64) -> Gpu {
        Gpu { memory: Some(bytes), ..self }
    }

    /// Returns the bytes that plans may take: the memory of an adapter that was opened here, where the system says it.
    pub(crate) fn memory(&self) -> Option<u64> {
        self.memory
    }

    /// Describes the device that Lightloom requests: all limits of the adapter, and the optional features that it has.
    /// An application that opens its own device should request the same.
    pub fn device_descriptor(adapter: &Adapter) -> wgpu::DeviceDescriptor<'static> {
        wgpu::DeviceDescriptor {
            label: Some("lightloom"),
            required_features: adapter.features() & Self::WANTED,
            required_limits: adapter.limits(),
            experimental_features: experimental(),
            ..Default::default()
        }
    }

    /// Uses a device that an application has opened. From now on, [`Gpu::take_fault`] returns its uncaptured errors.
    pub fn from_device(device: Device, queue: Queue, info: AdapterInfo) -> Gpu {
        let faults = Arc::new(Faults::default());
        let sink = Arc::clone(&faults);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            let mut first = sink.first.lock().unwrap_or_else(PoisonError::into_inner);
            first.get_or_insert_with(|| match &error {
                // Its own text does not say which object it is about.
                wgpu::Error::OutOfMemory { source } => format!("out of memory: {source}"),
                _ => error.to_string(),
            });
        }));
        let sink = Arc::clone(&faults);
        device.set_device_lost_callback(move |reason, message| {
            // wgpu reports nothing else of a device that is gone: what is asked of it does nothing, without an error.
            let _ = sink.lost.set(match reason {
                wgpu::DeviceLostReason::Destroyed => "it was destroyed".to_owned(),
                wgpu::DeviceLostReason::Unknown => message,
            });
        });
        Gpu { device, queue, info, instance: None, memory: None, faults, pipelines: None }
    }

    /// Returns the first error since the last call, if there was one. A device that is gone has one in every call.
    pub fn take_fault(&self) -> Option<String> {
        let first = self.faults.first.lock().unwrap_or_else(PoisonError::into_inner).take();
        self.check().err().map(|lost| lost.to_string()).or(first)
    }

    /// Checks that the device is there, as far as it is known without a wait: one that an application has destroyed is
    /// found to be gone when it is next waited for.
    ///
    /// # Errors
    /// [`ExecutorError::Lost`] where the device is gone.
    pub fn check(&self) -> Result<(), ExecutorError> {
        match self.faults.lost.get() {
            Some(message) => Err(ExecutorError::Lost { message: message.clone() }),
            None => Ok(()),
        }
    }

    /// Returns how many objects there are, as wgpu counts them: buffers, textures, bind groups, pipelines, commands and what
    /// belongs to them. `None` where an application opened the device.
    pub fn objects(&self) -> Option<usize> {
        let hub = self.instance.as_ref()?.generate_report()?.hub;
        let kinds = [
            hub.buffers,
            hub.textures,
            hub.texture_views,
            hub.bind_groups,
            hub.render_pipelines,
            hub.compute_pipelines,
            hub.shader_modules,
            hub.command_encoders,
            hub.command_buffers,
            hub.query_sets,
        ];
        Some(kinds.iter().map(|kind| kind.num_allocated).sum())
    }

    /// Returns the limits of the device.
    pub fn limits(&self) -> Limits {
        self.device.limits()
    }

    /// Checks that steps can bind a storage buffer of `bytes`; `resource` says whose it is.
    ///
    /// # Errors
    /// Where the adapter binds less.
    pub fn check_storage(&self, resource: &str, bytes: u64) -> Result<(), ExecutorError> {
        let allowed = self.limits().max_storage_buffer_binding_size;
        if bytes <= allowed {
            return Ok(());
        }
        Err(ExecutorError::Limit {
            resource: resource.to_owned(),
            wanted: format!("{bytes} bytes"),
            allowed: format!("{allowed} bytes"),
            limit: "max_storage_buffer_binding_size",
            from: String::new(),
        })
    }

    /// Returns whether shaders should read what is uniform from storage buffers. The lavapipe of Mesa 22 compiles a shader
    /// again in each frame where values of a uniform buffer decide branches or loops that make up half of it, and keeps
    /// every version until the device is dropped.
    pub(crate) fn recompiles_by_uniforms(&self) -> bool {
        let mesa = self.info.driver_info.strip_prefix("Mesa ").and_then(|version| version.split('.').next());
        let before = mesa.and_then(|major| major.parse::<u32>().ok()).is_some_and(|major| major < 23);
        self.info.driver == "llvmpipe" && before
    }

    /// Returns whether passes can be timed on the GPU.
    pub fn has_timestamps(&self) -> bool {
        self.device.features().contains(Features::TIMESTAMP_QUERY)
    }

    /// Returns whether shaders can query an acceleration structure.
    pub fn has_ray_queries(&self) -> bool {
        self.device.features().contains(Features::EXPERIMENTAL_RAY_QUERY)
    }

    /// Returns whether shaders can query an acceleration structure over so many triangles.
    pub fn can_query_rays(&self, triangles: u32) -> bool {
        self.has_ray_queries() && triangles <= self.device.limits().max_blas_primitive_count
    }

    /// Returns whether an indirect draw can have a first instance other than 0.
    pub fn has_first_instance(&self) -> bool {
        self.device.features().contains(Features::INDIRECT_FIRST_INSTANCE)
    }

    /// Returns the adapter and driver in one line, for provenance.
    pub fn describe(&self) -> String {
        describe(&self.info)
    }

    /// Runs `f` between the start and the end of a capture of the graphics debugger that is attached to the process
    /// (RenderDoc, Xcode, PIX). Without one, only runs it.
    pub fn capture<T>(&self, f: impl FnOnce() -> T) -> T {
        #[expect(unsafe_code, reason = "wgpu's way of asking whether a debugger may be called")]
        // SAFETY: the debugger that is called is the one that the user attached to this process.
        unsafe {
            self.device.start_graphics_debugger_capture();
        }
        let done = f();
        #[expect(unsafe_code, reason = "as above")]
        // SAFETY: as above.
        unsafe {
            self.device.stop_graphics_debugger_capture();
        }
        done
    }

    /// Submits commands and what was written into buffers; the latter alone where there are no commands.
    pub fn submit(&self, commands: Option<wgpu::CommandBuffer>) {
        self.queue.submit(commands);
    }

    /// Waits until all submitted work is done.
    ///
    /// # Errors
    /// [`ExecutorError::Lost`] where the device is gone.
    pub fn wait(&self) -> Result<(), ExecutorError> {
        self.poll(wgpu::PollType::Wait { submission_index: None, timeout: None })
    }

    /// Calls back whoever waits for work that is done.
    ///
    /// # Errors
    /// [`ExecutorError::Lost`] where the device is gone.
    pub(crate) fn poll(&self, how: wgpu::PollType) -> Result<(), ExecutorError> {
        // wgpu 30 panics where the driver loses the device in a poll; it holds no lock then.
        let polled = catch_unwind(AssertUnwindSafe(|| self.device.poll(how)));
        self.check()?;
        let lost = |message| Err(ExecutorError::Lost { message });
        match polled {
            Ok(Ok(_)) => Ok(()),
            Ok(Err(error)) => lost(error.to_string()),
            Err(_) => lost("the driver failed while it was waited for".to_owned()),
        }
    }
}

/// Returns an adapter and its driver in one line.
pub fn describe(adapter: &wgpu::AdapterInfo) -> String {
    format!("{} ({:?}, {} {})", adapter.name, adapter.backend, adapter.driver, adapter.driver_info)
}

/// Returns the place of an adapter that is given by that place or a part of its name.
fn place_of(wanted: &str, names: &[String]) -> Option<usize> {
    if let Ok(place) = wanted.parse::<usize>() {
        return (place < names.len()).then_some(place);
    }
    let wanted = wanted.to_lowercase();
    names.iter().position(|name| !wanted.is_empty() && name.to_lowercase().contains(&wanted))
}

/// Returns the memory of an adapter: that of the machine where it renders on the processor.
fn memory_of(adapter: &Adapter) -> Option<u64> {
    if adapter.get_info().device_type == wgpu::DeviceType::Cpu {
        let about = std::fs::read_to_string("/proc/meminfo").ok()?;
        let total = about.lines().find_map(|line| line.strip_prefix("MemTotal:"))?;
        let kib: u64 = total.trim().strip_suffix(" kB")?.parse().ok()?;
        return Some(kib * 1024);
    }
    memory_by_vulkan(adapter)
}

#[cfg(not(target_vendor = "apple"))]
fn memory_by_vulkan(adapter: &Adapter) -> Option<u64> {
    #[expect(unsafe_code, reason = "wgpu does not say how much memory there is")]
    // SAFETY: the adapter of the driver is asked for its properties, and nothing is changed or kept.
    let memory = unsafe {
        let adapter = adapter.as_hal::<wgpu::hal::api::Vulkan>()?;
        let instance = adapter.shared_instance().raw_instance();
        instance.get_physical_device_memory_properties(adapter.raw_physical_device())
    };
    // VK_MEMORY_HEAP_DEVICE_LOCAL_BIT
    let own = memory.memory_heaps_as_slice().iter().filter(|heap| heap.flags.as_raw() & 1 != 0);
    own.map(|heap| heap.size).max()
}

#[cfg(target_vendor = "apple")]
fn memory_by_vulkan(_: &Adapter) -> Option<u64> {
    None
}

/// Leave to use ray queries where an adapter has them. Nothing else that wgpu counts as experimental is requested.
#[expect(unsafe_code, reason = "wgpu's way of asking whether its warning was read")]
fn experimental() -> wgpu::ExperimentalFeatures {
    // SAFETY: the warning, that validation of experimental features may have holes, was read. Shaders initialise a
    // query before they proceed, and every structure is built before what traverses it is submitted.
    unsafe { wgpu::ExperimentalFeatures::enabled() }
}
