//! A frame like the one before allocates nothing but what wgpu does: held against the same calls of wgpu made by hand.

#[expect(dead_code, reason = "other tests use the rest")]
#[path = "main/harness.rs"]
mod harness;

use executor::{Executor, FrameOptions, Gpu, Object, wgpu};
use frame_graph::Change;
use harness::{Running, TestPass, Workshop, every_frame, gpu, shader, texture, words};
use pass::{Clear, Compute, Draw, Format, OutputDesc, Raster, Step, Target, Threads, Usage};
use std::sync::{Mutex, MutexGuard, Once, PoisonError};

/// Counts what this thread allocates.
fn allocations(work: impl FnMut()) -> u64 {
    allocation_counter::measure(work).count_total
}

/// Keeps other tests from the device until it is dropped: a submission also clears up what other threads have left there.
fn alone() -> MutexGuard<'static, ()> {
    static DEVICE: Mutex<()> = Mutex::new(());
    static NO_BACKTRACES: Once = Once::new();
    // wgpu takes one in each submission where they are asked for, with more allocations from deeper down.
    NO_BACKTRACES.call_once(|| {
        #[expect(unsafe_code, reason = "the variable is read once, by the first backtrace")]
        // SAFETY: every test waits here before it does anything that could read the environment.
        unsafe {
            std::env::set_var("RUST_LIB_BACKTRACE", "0");
        }
    });
    DEVICE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Frames that are counted.
const FRAMES: usize = 25;

/// Returns the allocations of a frame of the executor, and of one by hand: medians of many, since lists inside wgpu grow now
/// and then.
/// The GPU is idle before each, so that wgpu finds the memory of earlier command buffers free.
fn usual(gpu: &Gpu, mut frame: impl FnMut(), mut by_hand: impl FnMut()) -> (u64, u64) {
    let usual = |work: &mut dyn FnMut()| {
        let mut counts = [0; FRAMES];
        for count in &mut counts {
            *count = allocations(&mut *work);
            gpu.wait().unwrap();
        }
        counts.sort_unstable();
        counts[FRAMES / 2]
    };
    (usual(&mut frame), usual(&mut by_hand))
}

fn run(executor: &mut Executor, change: &Change) {
    executor.frame(change, FrameOptions::default()).unwrap();
}

/// Everything runs again.
fn all() -> Change {
    Change { all: true, ..Change::default() }
}

fn encoder(gpu: &Gpu) -> wgpu::CommandEncoder {
    gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") })
}

/// Encodes what the executor dispatched in its last frame.
fn dispatch(encoder: &mut wgpu::CommandEncoder, dispatches: &[Owned]) {
    let descriptor = wgpu::ComputePassDescriptor { label: Some("dispatches"), ..Default::default() };
    let mut pass = encoder.begin_compute_pass(&descriptor);
    let mut set = None;
    for Owned { pipeline, bind_group, workgroups: [x, y, z] } in dispatches {
        if set != Some(pipeline) {
            pass.set_pipeline(pipeline);
            set = Some(pipeline);
        }
        pass.set_bind_group(0, bind_group, &[]);
        pass.dispatch_workgroups(*x, *y, *z);
    }
}

/// A dispatch that is not borrowed from the executor.
struct Owned {
    pipeline: wgpu::ComputePipeline,
    bind_group: wgpu::BindGroup,
    workgroups: [u32; 3],
}

fn dispatches(executor: &Executor) -> Vec<Owned> {
    let owned = executor.dispatches().map(|dispatch| Owned {
        pipeline: dispatch.pipeline.clone(),
        bind_group: dispatch.bind_group.clone(),
        workgroups: dispatch.workgroups,
    });
    owned.collect()
}

const NEXT: &str = "
    struct Settings { before_size: vec2<u32>, seed: u32 }
    var<uniform> settings: Settings;
    var before: texture_2d<u32>;
    var out: texture_storage_2d<r32uint, write>;
    @compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) at: vec3<u32>) {
        textureStore(out, at.xy, textureLoad(before, at.xy % settings.before_size, 0) + settings.seed);
    }";

const FIRST: &str = "
    var out: texture_storage_2d<r32uint, write>;
    @compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) at: vec3<u32>) {
        textureStore(out, at.xy, vec4(at.x));
    }";

/// A chain of dispatches: each reads the texture of the one before and a uniform.
fn chain(length: usize) -> Option<Running> {
    let texel = OutputDesc::one("out", texture(Format::R32Uint));
    let kind = TestPass::new("kind").optional("before", "Texture").output(texel).steps(|cx| {
        let shader = shader(if cx.connected("before") { "next.wgsl" } else { "first.wgsl" });
        vec![Step::Compute(Compute::per_texel(shader, "main", cx.frame))]
    });
    let passes = (0..length).map(|i| match i.checked_sub(1) {
        Some(before) => format!(r#""p{i}": Pass(kind: "kind", in: {{ "before": "p{before}" }})"#),
        None => r#""p0": Pass(kind: "kind")"#.to_owned(),
    });
    let passes = passes.collect::<Vec<_>>().join(", ");
    let workshop = Workshop::new(vec![kind], &[("first.wgsl", FIRST), ("next.wgsl", NEXT)]);
    workshop.start(&passes, &format!(r#""out": "p{}""#, length - 1))
}

#[test]
fn dispatches_allocate_what_wgpu_does() {
    const LENGTH: usize = 100;
    let _alone = alone();
    let Some(gpu) = gpu() else { return };
    let Some(Running(mut executor)) = chain(LENGTH) else { return };
    executor.set_sample(3, 0);
    run(&mut executor, &all());
    let owned = dispatches(&executor);
    assert_eq!(owned.len(), LENGTH);
    let change = all();
    let frame = || run(&mut executor, &change);
    let (frame, by_hand) = usual(&gpu, frame, || {
        let mut encoder = encoder(&gpu);
        dispatch(&mut encoder, &owned);
        gpu.submit(Some(encoder.finish()));
    });
    assert!(frame <= by_hand, "{frame} allocations, {by_hand} by hand");
}

#[test]
fn a_frame_that_runs_nothing_allocates_what_an_empty_submission_does() {
    let _alone = alone();
    let Some(gpu) = gpu() else { return };
    let Some(Running(mut executor)) = chain(20) else { return };
    run(&mut executor, &Change::default());
    let change = Change::default();
    let frame = || {
        let report = executor.frame(&change, FrameOptions::default()).unwrap();
        assert!(report.ran.iter().all(|ran| !ran));
    };
    let (frame, by_hand) = usual(&gpu, frame, || {
        gpu.submit(None);
    });
    assert!(frame <= by_hand, "{frame} allocations, {by_hand} by hand");
}

/// A counter that reads its past, whose uniform holds the age, and a picture that is cleared and drawn over: what changes
/// in every frame is a bind group, a view and the bytes of a uniform.
const COUNT: &str = "
    struct Settings { past_age: u32 }
    var<uniform> settings: Settings;
    var<storage, read> past: array<u32>;
    var<storage, read_write> out: array<u32>;
    @compute @workgroup_size(1) fn main() { out[0] = past[0] + settings.past_age; }";

const DRAW: &str = "
    @vertex fn corner(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
        return vec4(vec2<f32>(vec2(i & 1u, i >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
    }
    @fragment fn color() -> @location(0) vec4<f32> { return vec4(1.0); }";

#[test]
fn pasts_uniforms_clears_and_draws_allocate_what_wgpu_does() {
    let _alone = alone();
    let Some(gpu) = gpu() else { return };
    let count = every_frame(TestPass::new("count").optional("past", "Buffer"));
    let count = count
        .output(OutputDesc::one("out", words(4)))
        .steps(|_| vec![Step::Compute(Compute::new(shader("count.wgsl"), "main", Threads::Grid([1; 3])))]);
    let mut cleared = OutputDesc::one("cleared", texture(Format::Rgba16Float));
    cleared.members[0].2 = Usage::ClearFirst(Clear::Color([1.0; 4]));
    let draw = every_frame(TestPass::new("draw").output(cleared));
    let draw = draw.output(OutputDesc::one("drawn", texture(Format::Rgba16Float))).steps(|_| {
        vec![Step::Raster(Raster {
            shader: shader("draw.wgsl"),
            vertex: "corner".into(),
            fragment: Some("color".into()),
            targets: vec![Target::clear("drawn")],
            depth: None,
            draw: Draw::Fullscreen,
            values: Vec::new(),
            bind: Vec::new(),
            windows: Vec::new(),
        })]
    });
    let workshop = Workshop::new(vec![count, draw], &[("count.wgsl", COUNT), ("draw.wgsl", DRAW)]);
    let passes = r#"
        "count": Pass(kind: "count", in: { "past": "prev count" }),
        "draw": Pass(kind: "draw")"#;
    let outputs = r#""count": "count", "cleared": "draw.cleared", "drawn": "draw.drawn""#;
    let Some(running) = workshop.start(passes, outputs) else { return };
    let views = ["draw.cleared", "draw.drawn"].map(|name| match running.0.object(running.id(name)) {
        Some(Object::Texture { view, .. }) => view.clone(),
        _ => panic!("{name} is a texture"),
    });
    let mut executor = running.0;
    let change = Change::default();
    // Both bind groups are made.
    (0..2).for_each(|_| run(&mut executor, &change));
    let owned = dispatches(&executor);
    assert_eq!(owned.len(), 1);
    let by_hand = ByHand::new(&gpu, views, owned);
    let frame = || run(&mut executor, &change);
    let (frame, by_hand) = usual(&gpu, frame, || by_hand.frame(&gpu));
    assert!(frame <= by_hand, "{frame} allocations, {by_hand} by hand");
}

/// The same frame without the executor.
struct ByHand {
    views: [wgpu::TextureView; 2],
    dispatches: Vec<Owned>,
    pipeline: wgpu::RenderPipeline,
    bind_group: wgpu::BindGroup,
    uniform: wgpu::Buffer,
}

impl ByHand {
    fn new(gpu: &Gpu, views: [wgpu::TextureView; 2], dispatches: Vec<Owned>) -> ByHand {
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(DRAW.into()),
        });
        // The executor binds an empty group where a step binds nothing.
        let layout = gpu
            .device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &[] });
        let pipeline_layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: None,
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("corner"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("color"),
                compilation_options: Default::default(),
                targets: &[Some(wgpu::TextureFormat::Rgba16Float.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let bind_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &layout,
            entries: &[],
        });
        let uniform = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 16,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        ByHand { views, dispatches, pipeline, bind_group, uniform }
    }

    fn frame(&self, gpu: &Gpu) {
        gpu.queue.write_buffer(&self.uniform, 0, &[1; 4]);
        let mut encoder = encoder(gpu);
        dispatch(&mut encoder, &self.dispatches);
        let _ = self.draw(&mut encoder, "clear", 0);
        let mut pass = self.draw(&mut encoder, "draw: corner", 1);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bind_group, &[]);
        pass.draw(0..3, 0..1);
        drop(pass);
        gpu.submit(Some(encoder.finish()));
    }

    fn draw<'a>(
        &self,
        encoder: &'a mut wgpu::CommandEncoder,
        label: &str,
        view: usize,
    ) -> wgpu::RenderPass<'a> {
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(label),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.views[view],
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        })
    }
}
