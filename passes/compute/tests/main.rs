//! The pass type reads declarations from a shader. Those that it shares with `fullscreen` are tested there.

mod a_trous;
mod gpu;

use compute::PASS;

use frame_graph::port::{InputDesc, OutputOverride};
use pass::{
    Clear, Compute, Define, Extent, Format, OutputDesc, PortDesc, ResourceDesc, SceneBindings, Step, Threads,
    Traits, Usage, Value,
};
use pass_test::ShaderUse;
use std::sync::Arc;

fn shader_use(wgsl: &str, inputs: &[&str]) -> ShaderUse<'static> {
    ShaderUse::new(PASS, wgsl, inputs)
}

/// Its dispatches, with these outputs and every setting but `set` at its default.
fn dispatches(case: &ShaderUse<'_>, outputs: &[OutputDesc], set: &[(&str, Value)]) -> Vec<Compute> {
    let port = |output: &OutputDesc| {
        let members = output.members.iter();
        PortDesc {
            name: (&*output.port).into(),
            interface: "".into(),
            members: members.map(|(name, desc, _)| ((&**name).into(), worked_out(desc))).collect(),
            facts: Arc::new(output.facts.clone()),
            connected: true,
            past: false,
        }
    };
    let ports: Vec<PortDesc> = outputs.iter().map(port).collect();
    let dispatch = |step| match step {
        Step::Compute(dispatch) => dispatch,
        Step::Raster(_) => panic!("a dispatch: {step:?}"),
    };
    case.record(&ports, set, &Traits::default()).unwrap().steps.into_iter().map(dispatch).collect()
}

/// Returns the threads of its only dispatch, with these outputs.
fn threads(case: &ShaderUse<'_>, outputs: &[OutputDesc]) -> Threads {
    let steps = dispatches(case, outputs, &[]);
    assert_eq!(steps.len(), 1);
    steps[0].threads.clone()
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
    let case = shader_use(wgsl, &["picture"]);
    let ports = case.ports(&[]).unwrap();
    assert_eq!((&*ports.inputs[0].name, &*ports.inputs[0].interface), ("picture", "Texture"));
    assert_eq!((&*ports.outputs[0].name, &*ports.outputs[0].interface), ("brighter", "Texture"));
    assert_eq!((ports.inputs.len(), ports.outputs.len(), ports.scene_bindings), (1, 1, SceneBindings::FRAME));
    let outputs = case.outputs(&[]).unwrap();
    let frame = ResourceDesc::texture_2d(Format::R32Float, Extent::FRAME);
    assert_eq!(outputs[0].members[0].1, frame);
    assert_eq!(outputs[0].members[0].2, Usage::ClearFirst(Clear::Zero));
    assert_eq!(threads(&case, &outputs), Threads::Grid([64, 48, 1]));
}

#[test]
fn a_buffer_has_as_many_elements_as_the_pipeline_says() {
    let wgsl = "#import \"virtual-lights.wgsl\"
        var<storage, read_write> lights: VirtualLights;
        @compute @workgroup_size(64) fn place() { lights.count = 1u; }";
    let case = shader_use(wgsl, &[]);
    let error = case.outputs(&[]).unwrap_err();
    assert!(error.message.contains("how many elements `lights: VirtualLights` has"), "{}", error.message);
    assert_eq!(error.help.as_deref(), Some("say it in the pipeline: out: { \"lights\": Out(count: 1024) }"));
    let said = OutputOverride {
        interface: Some("VirtualLights".into()),
        count: Some(100),
        ..OutputOverride::default()
    };
    let case = case.out("lights", said);
    let outputs = case.outputs(&[]).unwrap();
    // A header of 16 bytes, and 48 a light.
    assert_eq!(outputs[0].members[0].1, ResourceDesc::buffer(16 + 100 * 48));
    assert_eq!(outputs[0].facts.get("count"), Some(&Value::U32(100)));
    assert_eq!(threads(&case, &outputs), Threads::Row(100));
    let ports = case.ports(&[]).unwrap();
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
    let case = shader_use(wgsl, &["rsm"]);
    let outputs = case.outputs(&[rsm]).unwrap();
    assert_eq!(
        outputs[0].members[0].1,
        ResourceDesc::texture_2d_array(Format::R32Float, Extent::like("rsm"), 6)
    );
    assert_eq!(threads(&case, &outputs), Threads::Grid([64, 48, 6]));
}

#[test]
fn a_shader_that_writes_nothing_is_refused() {
    let case = shader_use("@compute @workgroup_size(1) fn idle() {}", &[]);
    let error = case.ports(&[]).unwrap_err();
    assert!(error.message.contains("writes nothing"), "{}", error.message);
}

/// A filter whose variants are chosen from the pipeline.
const VARIANTS: &str = "#option TAPS 9 one_of [1, 9, 25] // how many texels count
    #option FILTER box one_of [box, gauss] // their weights
    #option CLAMPED true
    #option TEXTURED false
    struct Settings {
        /// Not a setting.
        image_size: vec2<u32>,
    #if FILTER == gauss
        /// Width of the bell. [default: 1.5, min: 0.1, unit: \"px\"]
        sigma: f32,
    #endif
    }
    var<uniform> settings: Settings;
    #if TAPS == 25
    var weights: texture_2d<f32>;
    #endif
    var image: texture_storage_2d<r32float, write>;
    @compute @workgroup_size(8, 8) fn blur(@builtin(global_invocation_id) id: vec3<u32>) {
        var value = f32(settings.image_size.x) + f32(TAPS);
    #if TAPS == 25
        value += textureLoad(weights, id.xy, 0).x;
    #endif
    #if FILTER == gauss
        value += settings.sigma;
    #endif
        textureStore(image, id.xy, vec4(value));
    }";

#[test]
fn options_are_settings_that_choose_the_variant() {
    let case = shader_use(VARIANTS, &[]);
    let settings = case.schema().unwrap();
    let told: Vec<_> =
        settings.iter().map(|s| (&*s.name, s.default.clone(), s.one_of.len(), &*s.doc)).collect();
    assert_eq!(
        told,
        [
            // Declared by one variant alone, and a setting of all.
            ("sigma", Value::F32(1.5), 0, "Width of the bell."),
            ("taps", Value::U32(9), 3, "how many texels count"),
            ("filter", Value::Text("box".into()), 2, "their weights"),
            // `TEXTURED` is the scene's to say.
            ("clamped", Value::Bool(true), 0, ""),
        ]
    );
    assert!(settings[1].check(Value::U32(16)).is_err(), "16 is none of 1, 9 and 25");
    let inputs = |set: &[(&str, Value)]| case.ports(set).unwrap().inputs;
    assert!(inputs(&[]).is_empty());
    let of_25 = inputs(&[("taps", Value::U32(25))]);
    assert_eq!(of_25.iter().map(|input| &*input.name).collect::<Vec<_>>(), ["weights"]);
    let outputs = case.outputs(&[]).unwrap();
    let set = [("taps", Value::U32(1)), ("filter", Value::Text("gauss".into()))];
    let steps = dispatches(&case, &outputs, &set);
    let defines = &steps[0].shader.defines;
    assert_eq!(defines["TAPS"], Define::Int(1));
    assert_eq!(defines["FILTER"], Define::Text("gauss".into()));
    assert_eq!(defines["CLAMPED"], Define::Bool(true));
    assert!(!defines.contains_key("TEXTURED"), "the scene does not say");
}

#[test]
fn a_name_is_one_setting() {
    let twice = "#option TAPS 9
        struct Settings {
            /// Also. [default: 1.0]
            taps: f32,
        }
        var<uniform> settings: Settings;
        var<storage, read_write> sum: f32;
        @compute @workgroup_size(1) fn add() { sum = settings.taps; }";
    let refusal = shader_use(twice, &[]).schema().unwrap_err().message;
    assert!(refusal.contains("`taps` is an option and a member of `Settings`"), "{refusal}");
}

/// Three entry points that hand on by scratch.
const STEPS: &str = "struct Settings {
        /// Rounds. [default: 3, max: 10]
        rounds: u32,
        round: u32,
    }
    var<uniform> settings: Settings;
    var<storage, read> numbers: array<u32>;
    /// Sums of groups of 64. [scratch]
    var<storage, read_write> sums: array<u32, 16>;
    /// In [0, 1]; the square of the picture. [scratch]
    var square: texture_storage_2d<rgba16float, write>;
    /// [reads: square]
    var squared: texture_2d<f32>;
    var picture: texture_storage_2d<rgba16float, write>;

    /// Adds up, one thread per number. [threads: elements(numbers)]
    @compute @workgroup_size(64) fn add(@builtin(global_invocation_id) id: vec3<u32>) {
        sums[id.x / 64u] = numbers[id.x];
    }
    /// [threads: (4, 2, rounds), repeat: rounds]
    @compute @workgroup_size(1) fn spread() {
        sums[settings.round % 16u] += 1u;
    }
    @compute @workgroup_size(8, 8) fn multiply(@builtin(global_invocation_id) id: vec3<u32>) {
        textureStore(square, id.xy, vec4(f32(sums[0])));
    }
    @compute @workgroup_size(8, 8) fn show(@builtin(global_invocation_id) id: vec3<u32>) {
        textureStore(picture, id.xy, textureLoad(squared, id.xy, 0));
    }";

#[test]
fn entry_points_are_run_in_the_order_of_the_text_and_share_scratch() {
    let said = OutputOverride { size: Some(Extent::Fixed(8, 8)), ..Default::default() };
    let case = shader_use(STEPS, &["numbers"]).out("square", said);
    let ports = case.ports(&[]).unwrap();
    let names = |ports: &[&str]| ports.iter().map(ToString::to_string).collect::<Vec<_>>();
    assert_eq!(ports.inputs.iter().map(|p| p.name.clone()).collect::<Vec<_>>(), names(&["numbers"]));
    assert_eq!(ports.outputs.iter().map(|p| p.name.clone()).collect::<Vec<_>>(), names(&["picture"]));
    let outputs = case.outputs(&[]).unwrap();
    let told: Vec<_> = outputs.iter().map(|o| (&*o.port, o.scratch)).collect();
    assert_eq!(told, [("square", true), ("picture", false), ("sums", true)]);
    assert_eq!(outputs[0].members[0].1, ResourceDesc::texture_2d(Format::Rgba16Float, Extent::Fixed(8, 8)));
    assert_eq!(outputs[2].members[0].1, ResourceDesc::buffer(64));

    let mut with_numbers = outputs.clone();
    // An input here: only its name and its bytes are used.
    with_numbers.push(OutputDesc::one("numbers", ResourceDesc::buffer(4 * 1000)));
    let steps = dispatches(&case, &with_numbers, &[("rounds", Value::U32(2))]);
    let told: Vec<_> = steps.iter().map(|s| (&*s.entry, s.threads.clone())).collect();
    let frame = Threads::Grid([64, 48, 1]);
    let spread = || ("spread", Threads::Grid([4, 2, 2]));
    assert_eq!(
        told,
        [("add", Threads::Row(1000)), spread(), spread(), ("multiply", frame.clone()), ("show", frame)]
    );
    let rounds: Vec<_> = steps[1..3].iter().map(|s| s.values.clone()).collect();
    assert_eq!(rounds, [0, 1].map(|round| vec![("round".to_owned(), Value::U32(round))]));
    assert_eq!(steps[4].bind, [("squared".to_owned(), "square".to_owned())]);
}

#[test]
fn attributes_that_mean_nothing_are_told_where_they_stand() {
    let cases = [
        (
            "elements(numbers)",
            "elements(number)",
            "own.wgsl:16:41: `add`: there is no input, output or scratch `number` | did you mean `numbers`?",
        ),
        ("repeat: rounds", "repeat: round", "there is no setting `round` | did you mean `rounds`?"),
        ("repeat: rounds", "repeet: rounds", "did you mean `repeat`?"),
        ("elements(numbers)", "lanes(numbers)", "there are `texels(NAME)` and `elements(NAME)`"),
        ("(4, 2, rounds)", "(4, 2)", "expected `,`, as in `(8, 8, 1)`"),
        ("(4, 2, rounds)", "-4", "expected a whole number, or an expression that is one"),
        (
            "[reads: square]",
            "[reads: squares]",
            "reads `squares`, which the shader does not write | did you mean `square`?",
        ),
        ("[reads: square]", "[scratch]", "`squared` is scratch, but the shader does not write it"),
        (
            "[reads: square]",
            "[threads: 4]",
            "`threads`, `repeat`, `items`, `iterations` and `sampled` are of entry points",
        ),
        ("/// Adds up, ", "/// [reads: sums] ", "there are two brackets of attributes"),
        (
            "textureStore(picture",
            "textureStore(square",
            "`show` reads `squared`, which it writes itself as `square`",
        ),
    ];
    for (from, to, expected) in cases {
        let refusal = shader_use(&STEPS.replace(from, to), &["numbers"]).refusal();
        assert!(refusal.contains(expected), "{to}: {refusal}");
    }
}

#[test]
fn the_module_of_an_interface_is_an_input() {
    let wgsl = "#import \"virtual-lights.wgsl\"
        #import interface \"visibility\"
        var<storage, read> lights: VirtualLights;
        var<storage, read_write> seen: array<f32>;
        @compute @workgroup_size(64) fn look(@builtin(global_invocation_id) id: vec3<u32>) {
            let light = lights.lights[id.x];
            seen[id.x] = visibility(id.x, light, vec3(0.0), vec3(0.0, 1.0, 0.0));
        }";
    for links in [&[][..], &["visibility", "lights"]] {
        let case = shader_use(wgsl, links);
        let ports = case.ports(&[]).unwrap();
        let interface =
            |name: &str| ports.inputs.iter().find(|p| p.name == name).map(|p| p.interface.to_string());
        assert_eq!(interface("visibility").as_deref(), Some("Visibility"));
        assert_eq!(interface("lights").as_deref(), Some("Buffer"));
        assert_eq!(ports.inputs.len(), 2);
    }
    let unknown = shader_use(&wgsl.replace("interface \"visibility", "interface \"shadows"), &[]);
    let refusal = unknown.schema().unwrap_err();
    assert!(
        refusal.message.contains("imports the interface \"shadows\", and no producer has such a module"),
        "{refusal:?}"
    );
}
