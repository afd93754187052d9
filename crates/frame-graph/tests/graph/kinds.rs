//! Pass types for tests: small, and wide enough to reach every rule of linking.

use frame_graph::port::{OutputContext, OutputDesc, PassTypes, Use};
use frame_graph::resolve::Files;
use frame_graph::{
    Content, Extent, Fact, Format, InputPort, Interface, Member, OutputPort, PassTypeError, Ports,
    ResourceDesc, SceneBindings, Setting, Settings, Source, Traits, Usage, Value,
};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// How many lights there are.
const COUNT: Fact<u32> = Fact::required("count", "how many there are");
/// A fact that nothing but tests reads.
const BIAS: Fact<f32> = Fact::optional("bias", "");

pub(super) const INTERFACES: &[Interface] = &[
    Interface::new(
        "GBuffer",
        "",
        &[
            Member::required("depth", Content::Texture(Format::R32Float), ""),
            Member::required("normal", Content::Texture(Format::Rgba16Float), ""),
            Member::optional("motion", Content::Texture(Format::Rg32Float), ""),
        ],
    )
    .with_facts(&[BIAS.decl()]),
    Interface::new("Lights", "", &[Member::required("", Content::Buffer, "")]).with_facts(&[COUNT.decl()]),
    Interface::new("Visibility", "", &[Member::required("", Content::Buffer, "")]),
    Interface::new("Irradiance", "", &[Member::required("", Content::Texture(Format::Rgba32Float), "")]),
];

/// Makes the outputs of a use.
type Outputs = fn(&OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError>;

struct Kind {
    name: &'static str,
    settings: Arc<[Setting]>,
    ports: Arc<Ports>,
    outputs: Outputs,
}

pub(super) struct TestPassTypes(Vec<Kind>);

/// The value of a setting that the pass type declares.
fn given<'a>(cx: &OutputContext<'a>, name: &str) -> &'a Value {
    cx.settings.get(name).unwrap()
}

fn setting(name: &str, default: Value, min: f64, max: f64, one_of: &[&str]) -> Setting {
    let numeric = matches!(default, Value::U32(_) | Value::I32(_) | Value::F32(_));
    Setting {
        name: name.into(),
        ty: default.ty(),
        default,
        min: numeric.then_some(min),
        max: numeric.then_some(max),
        one_of: one_of.iter().map(|s| Value::Text((*s).into())).collect(),
        unit: String::new(),
        doc: String::new(),
        declared: String::new(),
    }
}

/// Inputs as `name: Interface` or `name?: Interface`, outputs as `name: Interface`.
fn ports(inputs: &[&str], outputs: &[&str], scene_bindings: SceneBindings) -> Arc<Ports> {
    let split = |text: &str| {
        let (name, interface) = text.split_once(": ").unwrap();
        (name.trim_end_matches('?').to_owned(), interface.to_owned(), name.ends_with('?'))
    };
    Arc::new(Ports {
        inputs: inputs
            .iter()
            .map(|text| {
                let (name, interface, optional) = split(text);
                InputPort { name, interface, optional, doc: "what it reads".into() }
            })
            .collect(),
        outputs: outputs
            .iter()
            .map(|text| {
                let (name, interface, _) = split(text);
                OutputPort { name, interface, doc: String::new() }
            })
            .collect(),
        scene_bindings,
    })
}

fn image(port: &str) -> OutputDesc {
    OutputDesc::one(port, ResourceDesc::texture_2d(Format::Rgba16Float, Extent::FRAME))
}

impl TestPassTypes {
    pub(super) fn new() -> TestPassTypes {
        let none = SceneBindings::NONE;
        let kind = |name, settings: Vec<Setting>, ports, outputs| Kind {
            name,
            settings: settings.into(),
            ports,
            outputs,
        };
        TestPassTypes(vec![
            kind(
                "gbuffer",
                vec![setting("motion", Value::Bool(true), 0.0, 0.0, &[])],
                ports(&[], &["view: GBuffer"], SceneBindings::SCENE.and(SceneBindings::CAMERA)),
                |c| {
                    let texture = |name: &str, format| {
                        (name.to_owned(), ResourceDesc::texture_2d(format, Extent::FRAME), Usage::Overwrites)
                    };
                    let mut members =
                        vec![texture("depth", Format::Depth32Float), texture("normal", Format::Rgba16Float)];
                    if given(c, "motion").as_bool() == Some(true) {
                        members.push(texture("motion", Format::Rg16Float));
                    }
                    Ok(vec![OutputDesc::of("view", members)])
                },
            ),
            kind(
                "lights",
                vec![
                    setting("count", Value::U32(1024), 1.0, 65536.0, &[]),
                    setting("mode", Value::Text("uniform".into()), 0.0, 0.0, &["uniform", "importance"]),
                ],
                ports(&["view: GBuffer"], &["lights: Lights"], SceneBindings::LIGHTS),
                |c| {
                    let count = given(c, "count").as_u32().unwrap();
                    let lights = OutputDesc::one("lights", ResourceDesc::buffer(u64::from(count) * 48));
                    let scan = OutputDesc::scratch("scan", ResourceDesc::buffer(u64::from(count) * 4));
                    Ok(vec![lights.fact(COUNT, count), scan])
                },
            ),
            kind(
                "shadows",
                vec![setting("map", Value::U32(64), 1.0, 512.0, &[])],
                ports(&["lights: Lights"], &["atlas: Visibility"], SceneBindings::SCENE),
                |c| {
                    let Ok(count) = c.fact("lights", COUNT) else {
                        return Err(PassTypeError::input("lights", "the lights do not say their count"));
                    };
                    let map = given(c, "map").as_u32().unwrap();
                    if map * count > 1 << 20 {
                        let error =
                            PassTypeError::setting("map", format!("{count} maps of {map} do not fit"));
                        return Err(error.help("use fewer lights or smaller maps"));
                    }
                    let atlas = ResourceDesc::texture_2d(Format::R32Uint, Extent::Fixed(map, map));
                    Ok(vec![OutputDesc::one("atlas", atlas).cleared()])
                },
            ),
            kind(
                "splat",
                vec![setting("map", Value::U32(8), 1.0, 512.0, &[])],
                ports(&["lights: Lights"], &["maps: Lights"], none),
                |c| {
                    let (count, map) = (c.fact("lights", COUNT)?, given(c, "map").as_u32().unwrap());
                    if count > 8192 / map {
                        let error = PassTypeError::setting("map", format!("{count} maps are too many"));
                        let most = u64::from(8192 / map);
                        return Err(error.help("take smaller maps").limit("lights", COUNT, most, "lights"));
                    }
                    Ok(vec![OutputDesc::one("maps", ResourceDesc::buffer(64)).fact(COUNT, count)])
                },
            ),
            kind(
                "fill",
                vec![setting("most", Value::U32(100), 0.0, 65536.0, &[])],
                ports(&["maps: Lights", "past?: Visibility"], &["atlas: Visibility"], none),
                |c| {
                    let (count, most) = (c.fact("maps", COUNT)?, given(c, "most").as_u32().unwrap());
                    if count > most {
                        let error = PassTypeError::input("maps", format!("{count} maps are too many"));
                        return Err(error.limit("maps", COUNT, u64::from(most), "lights"));
                    }
                    Ok(vec![OutputDesc::one("atlas", ResourceDesc::buffer(64))])
                },
            ),
            kind(
                "gather",
                vec![],
                ports(
                    &["view: GBuffer", "lights: Lights", "visibility?: Visibility"],
                    &["irradiance: Irradiance"],
                    none,
                ),
                |_| Ok(vec![image("irradiance")]),
            ),
            kind(
                "blur",
                vec![
                    setting("radius", Value::F32(4.0), 0.0, 32.0, &[]),
                    setting("mode", Value::Text("box".into()), 0.0, 0.0, &["box", "gauss"]),
                    setting("weights", Value::Vector(vec![0.5, 0.5]), 0.0, 0.0, &[]),
                    setting("offset", Value::I32(0), -4.0, 4.0, &[]),
                ],
                ports(&["view?: GBuffer", "irradiance: Irradiance"], &["irradiance: Irradiance"], none),
                |_| {
                    Ok(vec![OutputDesc::one(
                        "irradiance",
                        ResourceDesc::texture_2d(Format::Rgba16Float, Extent::like("irradiance")),
                    )])
                },
            ),
            kind(
                "guided",
                vec![],
                ports(&["view: GBuffer", "irradiance: Irradiance"], &["irradiance: Irradiance"], none),
                |_| {
                    Ok(vec![OutputDesc::one(
                        "irradiance",
                        ResourceDesc::texture_2d(Format::Rgba16Float, Extent::like("irradiance")),
                    )])
                },
            ),
            kind("noise", vec![], ports(&[], &["irradiance: Irradiance"], SceneBindings::FRAME), |_| {
                Ok(vec![image("irradiance")])
            }),
            kind(
                "composite",
                vec![setting("exposure", Value::F32(0.0), -8.0, 8.0, &[])],
                ports(
                    &["indirect: Irradiance", "direct?: Irradiance", "glossy?: Irradiance"],
                    &["image: Texture"],
                    none,
                ),
                |_| Ok(vec![image("image")]),
            ),
            kind(
                "accumulate",
                vec![],
                ports(&["color: Texture", "history: Texture"], &["color: Texture"], none),
                |_| {
                    Ok(vec![OutputDesc::one(
                        "color",
                        ResourceDesc::texture_2d(Format::Rgba16Float, Extent::like("color")),
                    )])
                },
            ),
            kind(
                "pair",
                vec![],
                ports(&["irradiance?: Irradiance"], &["a: Irradiance", "b: Irradiance"], none),
                |_| Ok(vec![image("a"), image("b")]),
            ),
            kind(
                "mix",
                vec![],
                ports(&["a: Irradiance", "b: Irradiance"], &["irradiance: Irradiance"], none),
                |_| Ok(vec![image("irradiance")]),
            ),
            kind("grow", vec![], ports(&["past: Texture"], &["image: Texture"], none), |_| {
                let size = Extent::Like { input: "past".into(), num: 2, den: 1 };
                Ok(vec![OutputDesc::one("image", ResourceDesc::texture_2d(Format::R32Float, size))])
            }),
            kind(
                "relay",
                vec![setting("bias", Value::F32(0.5), 0.0, 1.0, &[])],
                ports(&["view: GBuffer"], &["seen: GBuffer"], none),
                |c| {
                    let bias = given(c, "bias").as_f32().unwrap();
                    Ok(vec![OutputDesc::hand_on("seen", "view").fact(BIAS, bias)])
                },
            ),
            kind("remotion", vec![], ports(&["view: GBuffer"], &["seen: GBuffer"], none), |_| {
                let mut seen = OutputDesc::of("seen", Vec::new());
                let motion = ResourceDesc::texture_2d(Format::Rg16Float, Extent::FRAME);
                seen.members.push(("motion".into(), motion, Usage::Overwrites));
                Ok(vec![seen.handed("normal", "view", "normal").handed("depth", "view", "depth")])
            }),
            kind("untold", vec![], ports(&[], &["lights: Lights"], none), |_| {
                Ok(vec![OutputDesc::one("lights", ResourceDesc::buffer(48))])
            }),
            kind("mistold", vec![], ports(&["view: GBuffer"], &["seen: GBuffer"], none), |_| {
                let bais: Fact<f32> = Fact::optional("bais", "");
                Ok(vec![OutputDesc::hand_on("seen", "view").fact(bais, 0.5)])
            }),
            kind("mistyped", vec![], ports(&[], &["lights: Lights"], none), |_| {
                let count: Fact<f32> = Fact::required("count", "");
                Ok(vec![OutputDesc::one("lights", ResourceDesc::buffer(48)).fact(count, 1.0)])
            }),
            kind("defect", vec![], ports(&[], &["image: Texture"], none), |_| Ok(vec![image("picture")])),
            kind("sink", vec![], ports(&["image: Texture"], &[], none), |_| Ok(vec![])),
        ])
    }

    fn find(&self, name: &str) -> &Kind {
        self.0.iter().find(|kind| kind.name == name).unwrap()
    }
}

impl PassTypes for TestPassTypes {
    fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = self.0.iter().map(|kind| kind.name.to_owned()).collect();
        names.push("fullscreen".into());
        names.sort();
        names
    }

    fn interfaces(&self) -> &[Interface] {
        INTERFACES
    }

    fn takes_shader(&self, kind: &str) -> Option<bool> {
        if kind == "fullscreen" { Some(true) } else { self.0.iter().any(|k| k.name == kind).then_some(false) }
    }

    fn settings(&self, use_: Use<'_>) -> Result<Arc<[Setting]>, PassTypeError> {
        if use_.kind == "fullscreen" {
            return Ok(vec![setting("strength", Value::F32(1.0), 0.0, 1.0, &[])].into());
        }
        Ok(Arc::clone(&self.find(use_.kind).settings))
    }

    fn ports(&self, use_: Use<'_>, _settings: &Settings) -> Result<Arc<Ports>, PassTypeError> {
        if use_.kind != "fullscreen" {
            return Ok(Arc::clone(&self.find(use_.kind).ports));
        }
        if let Some(unbound) = use_.inputs.iter().find(|name| name.starts_with("unbound")) {
            return Err(PassTypeError::input(unbound, format!("the shader binds no `{unbound}`")));
        }
        let inputs: Vec<String> = use_.inputs.iter().map(|name| format!("{name}: Any")).collect();
        let inputs: Vec<&str> = inputs.iter().map(String::as_str).collect();
        let interface = use_.outputs.get("out").and_then(|out| out.interface.clone());
        Ok(ports(
            &inputs,
            &[&format!("out: {}", interface.as_deref().unwrap_or("Texture"))],
            SceneBindings::NONE,
        ))
    }

    fn outputs(&self, context: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        if context.use_.kind != "fullscreen" {
            return (self.find(context.use_.kind).outputs)(context);
        }
        let said = context.use_.outputs.get("out").cloned().unwrap_or_default();
        let size = said.size.unwrap_or(Extent::FRAME);
        let format = said.format.unwrap_or(Format::Rgba16Float);
        if context.use_.shader == Some("go-on.wgsl") {
            let out = OutputDesc::one("out", ResourceDesc::texture_2d(format, size));
            return Ok(vec![out.continuing("own")]);
        }
        // A shader that hands on the first resource of its first input: alone, or beside one of its own.
        if context.use_.shader == Some("hand.wgsl")
            && let Some((from, _)) = context.input("i0").and_then(|input| input.members.first())
        {
            let own = match said.interface.as_deref() {
                Some("GBuffer") => OutputDesc::of(
                    "out",
                    vec![("normal".into(), ResourceDesc::texture_2d(format, size), Usage::Overwrites)],
                )
                .handed("depth", "i0", from),
                _ => OutputDesc::of("out", Vec::new()).handed("", "i0", from),
            };
            return Ok(vec![own]);
        }
        Ok(vec![OutputDesc::one("out", ResourceDesc::texture_2d(format, size))])
    }
}

/// Files in memory.
#[derive(Clone, Default)]
pub(super) struct MemoryFiles(pub(super) BTreeMap<String, Arc<Source>>);

impl MemoryFiles {
    pub(super) fn new(files: &[(&str, &str)]) -> MemoryFiles {
        MemoryFiles(
            files.iter().map(|(path, text)| ((*path).to_owned(), Source::new(*path, *text))).collect(),
        )
    }
}

impl Files for MemoryFiles {
    fn read(&self, path: &str) -> Option<Arc<Source>> {
        self.0.get(path).cloned()
    }

    fn list(&self) -> Vec<String> {
        self.0.keys().cloned().collect()
    }
}

/// What the scenes of tests hold.
pub(super) fn traits() -> Traits {
    let traits = [
        ("glossy", Value::Bool(false)),
        ("textured", Value::Bool(true)),
        ("point_lights", Value::U32(2)),
        ("name", Value::Text("cornell".into())),
    ];
    Traits::new(traits.into_iter().map(|(name, value)| (name.to_owned(), value)).collect())
}

/// The type of a value written as text, for settings given from outside.
pub(super) fn value(text: &str) -> Value {
    if let Ok(n) = text.parse() {
        Value::U32(n)
    } else if let Ok(x) = text.parse() {
        Value::F32(x)
    } else {
        Value::Text(text.to_owned())
    }
}

/// All files of a folder of this crate and of its sub-graphs, by their paths within it.
pub(crate) fn files(folder: &str) -> MemoryFiles {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut files = MemoryFiles::default();
    for inner in ["", "parts"] {
        for entry in std::fs::read_dir(folder.join(inner)).unwrap().flatten() {
            let name = entry.file_name().into_string().unwrap();
            if name.ends_with(".ron") {
                let path = if inner.is_empty() { name } else { format!("{inner}/{name}") };
                let text = std::fs::read_to_string(entry.path()).unwrap();
                files.0.insert(path.clone(), Source::new(path, text));
            }
        }
    }
    files
}
