//! What the kind reads from a shader. What it shares with `fullscreen` is tested there.

mod gpu;

use compute::PASS;

use frame_graph::port::{InputDesc, OutputOverride};
use pass::{
    Clear, Extent, Externals, Format, KindError, Library, OutputContext, OutputDesc, RecordContext,
    ResourceDesc, Settings, Step, Threads, Traits, Usage, Use, UseContext, Value,
};
use shader_library::{DiskFiles, MemoryFiles, Overlay};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

struct Case {
    library: Library,
    inputs: Vec<String>,
    outputs: BTreeMap<String, OutputOverride>,
}

impl Case {
    fn new(wgsl: &str, inputs: &[&str]) -> Case {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let own = MemoryFiles::new([("own.wgsl", wgsl)]);
        let files = Overlay(vec![Arc::new(own), Arc::new(DiskFiles::new(root))]);
        let library = Library::new(Arc::new(files)).with_roots(["shaders", ""]);
        Case { library, inputs: inputs.iter().map(ToString::to_string).collect(), outputs: BTreeMap::new() }
    }

    fn cx(&self) -> UseContext<'_> {
        let use_ =
            Use { kind: "compute", shader: Some("own.wgsl"), inputs: &self.inputs, outputs: &self.outputs };
        UseContext { use_, shaders: &self.library }
    }

    fn outputs(&self, inputs: &[InputDesc]) -> Result<Vec<OutputDesc>, KindError> {
        let (settings, traits) = (Settings::default(), Traits::default());
        let context = OutputContext {
            use_: self.cx().use_,
            settings: &settings,
            inputs,
            frame: (64, 48),
            traits: &traits,
        };
        PASS.outputs(&self.cx(), &context)
    }

    /// How many threads it asks for, with these outputs.
    fn threads(&self, outputs: &[OutputDesc]) -> Threads {
        let ports: Vec<pass::PortDesc> = outputs
            .iter()
            .map(|output| pass::PortDesc {
                name: (&*output.port).into(),
                interface: "".into(),
                members: output
                    .members
                    .iter()
                    .map(|(name, desc, _)| ((&**name).into(), worked_out(desc)))
                    .collect(),
                facts: Arc::new(output.facts.clone()),
                connected: true,
                past: false,
            })
            .collect();
        let (settings, traits) = (Settings::default(), Traits::default());
        let recording = PASS
            .record(&RecordContext {
                name: "own",
                use_: self.cx().use_,
                settings: &settings,
                inputs: &[],
                outputs: &ports,
                frame: (64, 48),
                traits: &traits,
                shaders: &self.library,
            })
            .unwrap();
        let [Step::Compute(dispatch)] = recording.steps.as_slice() else {
            panic!("one dispatch: {recording:?}")
        };
        dispatch.threads.clone()
    }
}

/// A description with every size that of the frame.
fn worked_out(desc: &ResourceDesc<Extent>) -> ResourceDesc {
    match desc {
        ResourceDesc::Texture(t) if t.array => ResourceDesc::texture_2d_array(t.format, (64, 48), t.layers),
        ResourceDesc::Texture(t) => ResourceDesc::texture_2d(t.format, (64, 48)),
        ResourceDesc::Buffer(b) => ResourceDesc::Buffer(b.clone()),
    }
}

#[test]
fn what_is_stored_to_is_an_output() {
    let wgsl = "#import \"frame.wgsl\"
        struct Settings { picture_size: vec2<u32> }
        var<uniform> settings: Settings;
        var picture: texture_2d<f32>;
        var brighter: texture_storage_2d<r32float, write>;
        @compute @workgroup_size(8, 8) fn brighten(@builtin(global_invocation_id) id: vec3<u32>) {
            let added = f32(frame.index) + f32(settings.picture_size.x);
            textureStore(brighter, id.xy, textureLoad(picture, id.xy, 0) + added);
        }";
    let case = Case::new(wgsl, &["picture"]);
    let ports = PASS.ports(&case.cx(), &Settings::default()).unwrap();
    assert_eq!((&*ports.inputs[0].name, &*ports.inputs[0].interface), ("picture", "Texture"));
    assert_eq!((&*ports.outputs[0].name, &*ports.outputs[0].interface), ("brighter", "Texture"));
    assert_eq!((ports.inputs.len(), ports.outputs.len(), ports.externals), (1, 1, Externals::FRAME));
    let outputs = case.outputs(&[]).unwrap();
    let frame = ResourceDesc::texture_2d(Format::R32Float, Extent::FRAME);
    assert_eq!(outputs[0].members[0].1, frame);
    assert_eq!(outputs[0].members[0].2, Usage::ClearFirst(Clear::Zero));
    assert_eq!(case.threads(&outputs), Threads::Grid([64, 48, 1]));
}

#[test]
fn a_buffer_has_as_many_elements_as_the_pipeline_says() {
    let wgsl = "#import \"virtual-lights.wgsl\"
        var<storage, read_write> lights: VirtualLights;
        @compute @workgroup_size(64) fn place() { lights.count = 1u; }";
    let mut case = Case::new(wgsl, &[]);
    let error = case.outputs(&[]).unwrap_err();
    assert!(error.message.contains("how many elements `lights: VirtualLights` has"), "{}", error.message);
    assert_eq!(error.help.as_deref(), Some("say it in the pipeline: out: { \"lights\": Out(count: 1024) }"));
    let said = OutputOverride {
        interface: Some("VirtualLights".into()),
        count: Some(100),
        ..OutputOverride::default()
    };
    case.outputs.insert("lights".into(), said);
    let outputs = case.outputs(&[]).unwrap();
    // A header of 16 bytes, and 48 a light.
    assert_eq!(outputs[0].members[0].1, ResourceDesc::buffer(16 + 100 * 48));
    assert_eq!(outputs[0].facts.get("count"), Some(&Value::U32(100)));
    assert_eq!(case.threads(&outputs), Threads::Row(100));
    let ports = PASS.ports(&case.cx(), &Settings::default()).unwrap();
    assert_eq!(&*ports.outputs[0].interface, "VirtualLights");
}

#[test]
fn arrays_have_the_layers_of_the_first_array_that_is_linked() {
    let wgsl = "var rsm_flux: texture_2d_array<f32>;
        var importance: texture_storage_2d_array<r32float, write>;
        @compute @workgroup_size(8, 8) fn weigh(@builtin(global_invocation_id) id: vec3<u32>) {
            textureStore(importance, id.xy, id.z, textureLoad(rsm_flux, id.xy, id.z, 0));
        }";
    let rsm = InputDesc {
        name: "rsm".into(),
        interface: "ReflectiveShadowMap".into(),
        members: vec![("flux".into(), ResourceDesc::texture_2d_array(Format::Rgba32Float, (256, 256), 6))],
        facts: Arc::default(),
    };
    let case = Case::new(wgsl, &["rsm"]);
    let outputs = case.outputs(&[rsm]).unwrap();
    assert_eq!(
        outputs[0].members[0].1,
        ResourceDesc::texture_2d_array(Format::R32Float, Extent::like("rsm"), 6)
    );
    assert_eq!(case.threads(&outputs), Threads::Grid([64, 48, 6]));
}

#[test]
fn a_shader_that_writes_nothing_is_refused() {
    let case = Case::new("@compute @workgroup_size(1) fn idle() {}", &[]);
    let error = PASS.ports(&case.cx(), &Settings::default()).unwrap_err();
    assert!(error.message.contains("writes nothing"), "{}", error.message);
}
