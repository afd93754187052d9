//! The device: opened here, or passed in by an application.

use crate::error::ExecutorError;
use std::sync::{Arc, Mutex};
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
    faults: Arc<Mutex<Option<String>>>,
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
        pollster::block_on(Self::open_async())
    }

    /// Returns the adapters, with the one that [`Gpu::open`] chooses first.
    pub fn adapters() -> Vec<AdapterInfo> {
        pollster::block_on(Self::sorted_adapters()).iter().map(Adapter::get_info).collect()
    }

    async fn sorted_adapters() -> Vec<Adapter> {
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
        adapters
    }

    async fn open_async() -> Result<Gpu, ExecutorError> {
        let adapters = Self::sorted_adapters().await;
        let adapter = adapters.first().ok_or(ExecutorError::NoAdapter)?;
        let (device, queue) =
            adapter.request_device(&Self::device_descriptor(adapter)).await.map_err(|error| {
                ExecutorError::Device { adapter: adapter.get_info().name, message: error.to_string() }
            })?;
        Ok(Gpu::from_device(device, queue, adapter.get_info()))
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
        let faults = Arc::new(Mutex::new(None));
        let sink = Arc::clone(&faults);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            let mut first = sink.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            first.get_or_insert_with(|| error.to_string());
        }));
        let sink = Arc::clone(&faults);
        device.set_device_lost_callback(move |reason, message| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                let mut first = sink.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                first.get_or_insert_with(|| format!("the device was lost: {message}"));
            }
        });
        Gpu { device, queue, info, faults }
    }

    /// Returns the first error since the last call, if there was one.
    pub fn take_fault(&self) -> Option<String> {
        self.faults.lock().unwrap_or_else(std::sync::PoisonError::into_inner).take()
    }

    /// Returns the limits of the device.
    pub fn limits(&self) -> Limits {
        self.device.limits()
    }

    /// Returns whether passes can be timed on the GPU.
    pub fn has_timestamps(&self) -> bool {
        self.device.features().contains(Features::TIMESTAMP_QUERY)
    }

    /// Returns whether shaders can query an acceleration structure.
    pub fn has_ray_queries(&self) -> bool {
        self.device.features().contains(Features::EXPERIMENTAL_RAY_QUERY)
    }

    /// Returns whether an indirect draw can have a first instance other than 0.
    pub fn has_first_instance(&self) -> bool {
        self.device.features().contains(Features::INDIRECT_FIRST_INSTANCE)
    }

    /// Returns the adapter and driver in one line, for provenance.
    pub fn describe(&self) -> String {
        let info = &self.info;
        format!("{} ({:?}, {} {})", info.name, info.backend, info.driver, info.driver_info)
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
        self.device
            .poll(wgpu::PollType::Wait { submission_index: None, timeout: None })
            .map(|_| ())
            .map_err(|error| ExecutorError::Lost { message: error.to_string() })
    }
}

/// Leave to use ray queries where an adapter has them. Nothing else that wgpu counts as experimental is requested.
#[expect(unsafe_code, reason = "wgpu's way of asking whether its warning was read")]
fn experimental() -> wgpu::ExperimentalFeatures {
    // SAFETY: the warning, that validation of experimental features may have holes, was read. Shaders initialise a
    // query before they proceed, and every structure is built before what traverses it is submitted.
    unsafe { wgpu::ExperimentalFeatures::enabled() }
}
