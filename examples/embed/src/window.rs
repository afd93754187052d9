//! A program with a window, as there are many on winit and wgpu; nothing here knows Lightloom.

use anyhow::{Context as _, Result};
use std::sync::Arc;
use std::time::Instant;
use wgpu::CurrentSurfaceTexture::{Lost, Outdated, Suboptimal, Success};
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::{ElementState, KeyEvent, WindowEvent};
use winit::event_loop::{ActiveEventLoop, EventLoop};
use winit::keyboard::{Key, NamedKey};
use winit::window::{Window, WindowAttributes, WindowId};

/// A picture that is drawn in the window.
pub(crate) trait Program: Sized {
    /// Is called once, with the size of the window in pixels.
    fn new(graphics: &Graphics, size: (u32, u32)) -> Result<Self>;

    /// Is called when the window has another size in pixels.
    fn resize(&mut self, size: (u32, u32)) -> Result<()>;

    /// Draws into the window, at a time since the start in seconds.
    fn draw(&mut self, graphics: &Graphics, target: &wgpu::TextureView, seconds: f32) -> Result<()>;
}

/// The device and the target of a program that draws.
pub(crate) struct Graphics {
    pub(crate) adapter: wgpu::Adapter,
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    /// The format of the window, not encoded in sRGB when it is written.
    pub(crate) format: wgpu::TextureFormat,
}

/// Describes the device to be requested from an adapter.
type Describe = fn(&wgpu::Adapter) -> wgpu::DeviceDescriptor<'static>;

/// Opens a window and draws the program in it, until it is closed or Escape is pressed.
pub(crate) fn run<P: Program>(title: &'static str, describe: Describe) -> Result<()> {
    let mut app = App::<P> { title, describe, start: Instant::now(), open: None, result: Ok(()) };
    EventLoop::new()?.run_app(&mut app)?;
    app.result
}

/// Creates a pipeline without vertex buffers, of two entry points.
pub(crate) fn pipeline(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    vertex: &str,
    fragment: &str,
    format: wgpu::TextureFormat,
) -> wgpu::RenderPipeline {
    let compilation_options = wgpu::PipelineCompilationOptions::default();
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(fragment),
        layout: None,
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(vertex),
            compilation_options: compilation_options.clone(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(fragment),
            compilation_options,
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// Begins a render pass over the whole target.
pub(crate) fn begin_pass<'encoder>(
    encoder: &'encoder mut wgpu::CommandEncoder,
    target: &wgpu::TextureView,
) -> wgpu::RenderPass<'encoder> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: target,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations::default(),
        })],
        ..Default::default()
    })
}

/// The window, and what draws in it.
struct Open<P> {
    program: P,
    graphics: Graphics,
    config: wgpu::SurfaceConfiguration,
    surface: wgpu::Surface<'static>,
    window: Arc<Window>,
}

impl<P: Program> Open<P> {
    fn new(event_loop: &ActiveEventLoop, title: &str, describe: Describe) -> Result<Self> {
        let attributes =
            WindowAttributes::default().with_title(title).with_inner_size(PhysicalSize::new(320, 320));
        let window = Arc::new(event_loop.create_window(attributes)?);
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        let surface = instance.create_surface(Arc::clone(&window))?;
        let options =
            wgpu::RequestAdapterOptions { compatible_surface: Some(&surface), ..Default::default() };
        let adapter = pollster::block_on(instance.request_adapter(&options))?;
        let (device, queue) = pollster::block_on(adapter.request_device(&describe(&adapter)))?;
        let size = window.inner_size();
        let config = surface.get_default_config(&adapter, size.width.max(1), size.height.max(1));
        let mut config = config.context("the adapter cannot draw in this window")?;
        let formats = surface.get_capabilities(&adapter).formats;
        let plain = formats.into_iter().find(|format| !format.is_srgb());
        config.format = plain.context("the window has no format without sRGB")?;
        surface.configure(&device, &config);
        let graphics = Graphics { adapter, device, queue, format: config.format };
        let program = P::new(&graphics, (config.width, config.height))?;
        Ok(Self { program, graphics, config, surface, window })
    }

    fn resize(&mut self, size: PhysicalSize<u32>) -> Result<()> {
        (self.config.width, self.config.height) = (size.width.max(1), size.height.max(1));
        self.surface.configure(&self.graphics.device, &self.config);
        self.program.resize((self.config.width, self.config.height))
    }

    fn draw(&mut self, seconds: f32) -> Result<()> {
        self.window.request_redraw();
        match self.surface.get_current_texture() {
            Success(texture) | Suboptimal(texture) => {
                let target = texture.texture.create_view(&Default::default());
                self.program.draw(&self.graphics, &target, seconds)?;
                self.window.pre_present_notify();
                self.graphics.queue.present(texture);
            }
            Outdated | Lost => self.surface.configure(&self.graphics.device, &self.config),
            // Hidden or busy: the next frame will do.
            _ => {}
        }
        Ok(())
    }
}

/// The application that winit calls.
struct App<P> {
    title: &'static str,
    describe: Describe,
    start: Instant,
    open: Option<Open<P>>,
    result: Result<()>,
}

impl<P: Program> App<P> {
    /// Ends the program at its first error.
    fn check(&mut self, event_loop: &ActiveEventLoop, result: Result<()>) {
        if result.is_err() {
            self.result = result;
            event_loop.exit();
        }
    }
}

impl<P: Program> ApplicationHandler for App<P> {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.open.is_none() {
            let opened = Open::new(event_loop, self.title, self.describe).map(|open| self.open = Some(open));
            self.check(event_loop, opened);
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(open) = &mut self.open else { return };
        let escape = Key::Named(NamedKey::Escape);
        let done = match event {
            WindowEvent::Resized(size) => open.resize(size),
            WindowEvent::RedrawRequested => open.draw(self.start.elapsed().as_secs_f32()),
            WindowEvent::KeyboardInput {
                event: KeyEvent { logical_key, state: ElementState::Pressed, .. },
                ..
            } if logical_key == escape => {
                event_loop.exit();
                Ok(())
            }
            WindowEvent::CloseRequested => {
                event_loop.exit();
                Ok(())
            }
            _ => Ok(()),
        };
        self.check(event_loop, done);
    }
}
