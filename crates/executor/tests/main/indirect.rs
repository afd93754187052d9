//! Dispatches and draws whose size is on the GPU.

use crate::harness::{Running, TestPass, Workshop, shader, texture, words};
use pass::{Compute, Draw, Format, OutputDesc, Raster, ResourceDesc, Step, Target, Threads, Value};

/// Writes the arguments of a step; or, where it reads its own past, the same and one more each frame in the first of
/// them.
const ARGUMENTS: &str = "
    struct Settings { first: u32, second: u32, third: u32, fourth: u32 }
    var<uniform> settings: Settings;
    var<storage, read_write> args: array<u32>;
    @compute @workgroup_size(1) fn write() {
        args[0] = 7u;
        args[1] = settings.first;
        args[2] = settings.second;
        args[3] = settings.third;
        args[4] = settings.fourth;
    }";

/// Counts frames: the arguments of a dispatch of this many workgroups, and of a draw of this many instances.
const COUNTER: &str = "
    var<storage, read> before: array<u32>;
    var<storage, read_write> args: array<u32>;
    @compute @workgroup_size(1) fn count() {
        let n = before[1] + 1u;
        args[0] = 0u;
        args[1] = n;
        args[2] = 1u;
        args[3] = 1u;
        args[4] = 6u;
        args[5] = n;
        args[6] = 0u;
        args[7] = 0u;
    }";

/// Every workgroup leaves a mark.
const MARK: &str = "
    var<storage, read_write> marks: array<atomic<u32>>;
    @compute @workgroup_size(1) fn mark(@builtin(workgroup_id) group: vec3<u32>) {
        atomicAdd(&marks[group.x + 4u * group.y], 1u + group.z);
    }";

/// Every instance covers a column of the target with its number and the number of its first vertex.
const COLUMNS: &str = "
    struct Corner { @builtin(position) position: vec4<f32>, @location(0) @interpolate(flat) mark: u32 }
    @vertex fn column(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Corner {
        let corner = vertex % 6u;
        let side = vec2(f32(corner == 1u || corner == 2u || corner == 4u), f32(corner == 2u || corner >= 4u));
        let at = vec2((f32(instance) + side.x) / 8.0, side.y) * 2.0 - 1.0;
        return Corner(vec4(at, 0.0, 1.0), 1u + instance + 100u * (vertex / 6u));
    }
    @fragment fn cover(corner: Corner) -> @location(0) vec4<u32> {
        return vec4(corner.mark, 0u, 0u, 0u);
    }";

const SHADERS: &[(&str, &str)] =
    &[("args.wgsl", ARGUMENTS), ("counter.wgsl", COUNTER), ("mark.wgsl", MARK), ("columns.wgsl", COLUMNS)];

/// Where the arguments begin in the buffer, in bytes: not at its start.
const OFFSET: u64 = 4;

fn write(args: [u32; 4]) -> Step {
    let values = ["first", "second", "third", "fourth"].into_iter().zip(args);
    let step = Compute::new(shader("args.wgsl"), "write", Threads::Grid([1; 3]));
    Step::Compute(values.fold(step, |step, (name, value)| step.value(name, Value::U32(value))))
}

fn count() -> Step {
    Step::Compute(Compute::new(shader("counter.wgsl"), "count", Threads::Grid([1; 3])))
}

fn mark(buffer: &str, offset: u64) -> Step {
    let threads = Threads::Indirect { buffer: buffer.into(), offset };
    Step::Compute(Compute::new(shader("mark.wgsl"), "mark", threads))
}

fn columns(buffer: &str, offset: u64) -> Step {
    Step::Raster(Raster {
        shader: shader("columns.wgsl"),
        vertex: "column".into(),
        fragment: Some("cover".into()),
        targets: vec![Target::clear("columns")],
        depth: None,
        draw: Draw::Indirect { buffer: buffer.into(), offset },
        values: Vec::new(),
        bind: Vec::new(),
        windows: Vec::new(),
    })
}

fn marks() -> OutputDesc {
    OutputDesc::one("marks", words(16)).cleared()
}

/// A pass that takes the sizes of a dispatch and a draw from its input, and one that writes them for itself.
fn workshop(args: [u32; 4]) -> Workshop {
    let consumer = |name| {
        TestPass::new(name).output(marks()).output(OutputDesc::one("columns", texture(Format::R32Uint)))
    };
    Workshop::new(
        vec![
            TestPass::new("source")
                .output(OutputDesc::one("args", words(8)))
                .steps(move |_| vec![write(args)]),
            TestPass::new("counter")
                .optional("before", "Buffer")
                .output(OutputDesc::one("args", words(8)))
                .steps(|_| vec![count()]),
            consumer("by-input")
                .optional("args", "Buffer")
                .steps(|_| vec![mark("args", OFFSET), columns("args", OFFSET)]),
            consumer("by-both")
                .optional("args", "Buffer")
                .steps(|_| vec![mark("args", OFFSET), columns("args", 16)]),
            consumer("by-scratch")
                .output(OutputDesc::scratch("args", words(8)))
                .steps(move |_| vec![write(args), mark("args", OFFSET), columns("args", OFFSET)]),
        ],
        SHADERS,
    )
}

const OUTPUTS: &str = r#""marks": "use.marks", "columns": "use.columns""#;

/// The pipelines that take their sizes from their own scratch, and from an input of the same frame.
const SAME_FRAME: [&str; 2] = [
    r#""use": Pass(kind: "by-scratch")"#,
    r#""args": Pass(kind: "source"), "use": Pass(kind: "by-input", in: { "args": "args" })"#,
];

/// Returns the marks that a dispatch of these workgroups leaves.
fn expected_marks([x, y, z]: [u32; 3]) -> Vec<u32> {
    let each = z * (z + 1) / 2;
    (0..16).map(|i| if i % 4 < x && i / 4 < y { each } else { 0 }).collect()
}

/// Returns the first row of 8 texels after a draw.
fn expected_columns([vertices, instances, first_vertex, first_instance]: [u32; 4]) -> Vec<u32> {
    let covered = |i| vertices >= 6 && (first_instance..first_instance + instances).contains(&i);
    (0..8).map(|i| if covered(i) { 1 + i + 100 * (first_vertex / 6) } else { 0 }).collect()
}

fn first_row(running: &Running) -> Vec<u32> {
    running.read("use.columns")[..8].to_vec()
}

#[test]
fn a_dispatch_takes_its_size_from_this_frame() {
    for groups in [[0, 1, 1], [1, 1, 1], [3, 2, 2], [4, 4, 0], [4, 4, 1]] {
        for pipeline in SAME_FRAME {
            let [x, y, z] = groups;
            let Some(mut running) = workshop([x, y, z, 0]).start(pipeline, OUTPUTS) else { return };
            running.frame();
            assert_eq!(running.read("use.marks"), expected_marks(groups), "{groups:?} by {pipeline}");
        }
    }
}

#[test]
fn a_draw_takes_its_size_from_this_frame() {
    for size in [[6, 0, 0, 0], [0, 8, 0, 0], [6, 1, 0, 0], [6, 8, 0, 0], [6, 3, 12, 2]] {
        for pipeline in SAME_FRAME {
            let Some(mut running) = workshop(size).start(pipeline, OUTPUTS) else { return };
            running.frame();
            assert_eq!(first_row(&running), expected_columns(size), "{size:?} by {pipeline}");
        }
    }
}

/// In the first frame the past is zeros: nothing is dispatched and nothing drawn. Then it counts on, in one copy of the
/// history and the other.
#[test]
fn the_past_gives_sizes_too() {
    let pipeline = r#"
        "args": Pass(kind: "counter", in: { "before": "prev args" }),
        "use": Pass(kind: "by-both", in: { "args": "prev args" })"#;
    let Some(mut running) = workshop([0; 4]).start(pipeline, OUTPUTS) else { return };
    for n in 0..4 {
        running.frame();
        assert_eq!(running.read("use.marks"), expected_marks([n, 1, 1]), "frame {n}");
        assert_eq!(first_row(&running), expected_columns([6, n, 0, 0]), "frame {n}");
    }
}

/// Linking refuses steps that cannot work, and names the pass.
#[test]
fn what_has_no_size_is_refused() {
    let cases: [(Vec<Step>, &str); 9] = [
        (vec![mark("args", 0)], "no earlier step of the pass writes it"),
        (vec![columns("args", 0), write([0; 4])], "no earlier step of the pass writes it"),
        (vec![mark("marks", 0)], "the same step writes it"),
        (vec![write([0; 4]), mark("args", 2)], "the offset 2 is no multiple of 4"),
        (vec![write([0; 4]), mark("args", 24)], "12 bytes from the offset 24 go beyond its 32 bytes"),
        (vec![write([0; 4]), columns("args", 20)], "16 bytes from the offset 20 go beyond its 32 bytes"),
        (vec![write([0; 4]), columns("args", u64::MAX - 3)], "go beyond its 32 bytes"),
        (vec![mark("columns", 0)], "not a buffer"),
        (vec![write([0; 4]), mark("arg", 0)], "did you mean `args`?"),
    ];
    for (steps, why) in cases {
        let kind = TestPass::new("use")
            .output(marks())
            .output(OutputDesc::one("columns", texture(Format::R32Uint)))
            .output(OutputDesc::scratch("args", words(8)))
            .steps(move |_| steps.clone());
        let refused = Workshop::new(vec![kind], SHADERS).link(r#""use": Pass(kind: "use")"#, OUTPUTS);
        let refused = refused.map(|_| ()).unwrap_err();
        assert!(refused.contains(why) && refused.contains("pass `use`"), "{why}: {refused}");
    }
}

/// The last bytes of a buffer are enough.
#[test]
fn sizes_may_end_with_the_buffer() {
    let args: ResourceDesc<_> = words(8);
    let kind = TestPass::new("use")
        .output(marks())
        .output(OutputDesc::one("columns", texture(Format::R32Uint)))
        .output(OutputDesc::scratch("args", args))
        .steps(|_| vec![write([0; 4]), mark("args", 20), columns("args", 16)]);
    let linked = Workshop::new(vec![kind], SHADERS).link(r#""use": Pass(kind: "use")"#, OUTPUTS);
    assert!(linked.is_ok(), "{}", linked.map(|_| ()).unwrap_err());
}
