//! The layout of a buffer is found among the shaders that bind it.

use frame_graph::plan::{HistoryId, ResourceId};
use pass::{Bound, Compute, Library, LinkedStep, LinkedSteps, Request, Source, Step, Threads, layout_of};
use shader_library::MemoryFiles;
use std::ops::Range;
use std::sync::Arc;

const FILES: [(&str, &str); 3] = [
    (
        "clear.wgsl",
        "var<storage, read_write> words: array<u32>;
        @compute @workgroup_size(1) fn main() { words[0] = 0u; }",
    ),
    (
        "trace.wgsl",
        "struct Hit { position: vec3<f32>, count: u32 }
        struct Hits { total: atomic<u32>, list: array<Hit> }
        var<storage, read_write> hits: Hits;
        @compute @workgroup_size(1) fn main() { hits.list[0].count = atomicAdd(&hits.total, 1u); }",
    ),
    (
        "shade.wgsl",
        "struct Point { position: vec3<f32>, count: u32 }
        var<storage, read> points: array<Point>;
        var<storage, read_write> sum: u32;
        @compute @workgroup_size(1) fn main() { sum = points[0].count; }",
    ),
];

/// A step of a file, with its globals in the order of their names bound to these.
fn step(path: &str, bound: &[(Source, Option<Range<u64>>)]) -> LinkedSteps {
    let library = Library::new(Arc::new(MemoryFiles::new(FILES)));
    let request = Request::new(path);
    let shader = library.load(&request).unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!(shader.interface.globals.len(), bound.len());
    let bindings = bound.iter().cloned().enumerate();
    vec![Arc::new(LinkedStep {
        step: Step::Compute(Compute::new(request, "main", Threads::Row(1))),
        shader,
        entries: vec![0],
        bindings: bindings.map(|(global, (source, window))| Bound { global, source, window }).collect(),
        uniforms: Vec::new(),
        targets: Vec::new(),
        depth: None,
        indirect: None,
    })]
}

fn whole(id: u32) -> (Source, Option<Range<u64>>) {
    (Source::Resource(ResourceId(id)), None)
}

#[test]
fn structs_come_before_words_and_writers_before_readers() {
    let clear = step("clear.wgsl", &[whole(3)]);
    let trace = step("trace.wgsl", &[whole(3)]);
    let shade = step("shade.wgsl", &[whole(3), whole(4)]);
    let found = |steps: &[&LinkedSteps], id: u32| {
        let steps: Vec<LinkedSteps> = steps.iter().map(|steps| (*steps).clone()).collect();
        layout_of(&steps, ResourceId(id)).map(|found| (found.global, found.writes))
    };
    let of = |name: &str, writes: bool| Some((name.to_owned(), writes));
    assert_eq!(found(&[&clear, &shade, &trace], 3), of("hits", true));
    assert_eq!(found(&[&clear, &shade], 3), of("points", false));
    assert_eq!(found(&[&clear], 3), of("words", true));
    assert_eq!(found(&[&shade, &clear], 4), of("sum", true));
    assert_eq!(found(&[&clear, &shade, &trace], 5), None);
    assert_eq!(found(&[], 3), None);
}

#[test]
fn the_whole_buffer_comes_before_a_part_of_it() {
    let id = || Source::Resource(ResourceId(3));
    let part = step("trace.wgsl", &[(id(), Some(256..512))]);
    let words = step("clear.wgsl", &[whole(3)]);
    let found = layout_of(&[part.clone(), words], ResourceId(3)).expect("both bind it");
    assert_eq!((found.global.as_str(), found.window), ("words", None));
    let found = layout_of(&[part], ResourceId(3)).expect("it is bound");
    assert_eq!((found.global.as_str(), found.window), ("hits", Some(256..512)));
    let names: Vec<&str> = found.layout.columns.iter().map(|column| column.name.as_str()).collect();
    assert_eq!((found.layout.ty.as_str(), names), ("Hits", vec!["position", "count"]));
}

#[test]
fn the_frame_before_and_scene_bindings_are_no_resources_of_the_frame() {
    let past = step("clear.wgsl", &[(Source::Past(HistoryId(3)), None)]);
    let scene = step("clear.wgsl", &[(Source::SceneBinding("scene_lights"), None)]);
    assert_eq!(layout_of(&[past, scene], ResourceId(3)), None);
}
