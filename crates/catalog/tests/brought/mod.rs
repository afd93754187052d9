//! A crate outside the tree that brings an interface, with its WGSL, and a pass that makes it; a shader reads it.

use catalog::{Assets, Catalog};
use frame_graph::{CompileOptions, LinkContext, Overrides, ResourceDesc, Traits};
use interfaces::NameTaken;
use pass::{Content, Fact, Interface, Member, Pass, Struct};

const PHOTONS: Struct = Struct::new("interfaces/photons/photons.wgsl", "Photons");
const COUNT: Fact<u32> = Fact::required("count", "the number of photons");

/// The interface that is brought.
static INTERFACES: [Interface; 1] = [Interface::new(
    "Photons",
    "Photons where they landed.",
    &[Member::required("", Content::Struct(PHOTONS), "them")],
)
.with_facts(&[COUNT.decl()])
.with_folder("interfaces/photons")];

/// The pass type, which its WGSL declares, and pass types like it under another name or with another interface.
struct Emit {
    name: &'static str,
    interfaces: &'static [Interface],
}

static EMIT: Emit = Emit { name: "emit-photons", interfaces: &INTERFACES };

impl Pass for Emit {
    fn kind(&self) -> &'static str {
        self.name
    }

    fn interfaces(&self) -> &'static [Interface] {
        self.interfaces
    }
}

const FILES: [(&str, &str); 4] = [
    (
        "interfaces/photons/photons.wgsl",
        "struct Photon { position: vec3<f32>, power: f32 }
struct Photons { count: u32, photons: array<Photon> }
",
    ),
    (
        "passes/emit-photons/emit-photons.wgsl",
        "// Emits photons of the power 1.

#output photons: Photons(count: 100) // The photons.

#import \"photons.wgsl\"
var<storage, read_write> photons: Photons;
@compute @workgroup_size(64)
fn emit(@builtin(global_invocation_id) id: vec3<u32>) { photons.photons[id.x].power = 1.0; }
",
    ),
    (
        "density.wgsl",
        "#import \"photons.wgsl\"
var<storage, read> photons: Photons;
var<storage, read_write> density: array<f32, 4>;
struct Settings { photons_count: u32 }
var<uniform> settings: Settings;
@compute @workgroup_size(1)
fn measure() { density[0] = f32(settings.photons_count) * photons.photons[0].power; }
",
    ),
    (
        "pipelines/photons.ron",
        "Pipeline(
    passes: {
        \"emit\": Pass(kind: \"emit-photons\"),
        \"density\": Pass(kind: \"compute\", shader: \"density.wgsl\", in: { \"photons\": \"emit\" }),
    },
    outputs: { \"density\": \"density\" },
)
",
    ),
];

#[test]
fn a_crate_outside_the_tree_brings_an_interface() {
    let catalog = Catalog::with_passes(Assets::new(None).with_files(FILES), [&EMIT as &dyn Pass]).unwrap();
    let resolved = frame_graph::resolve("photons", catalog.pipelines(), &Overrides::default()).unwrap();
    let context = LinkContext { frame: (8, 8), traits: Traits::default() };
    let graph = frame_graph::link(&resolved, &catalog, &context).unwrap_or_else(|error| panic!("{error}"));
    let plan = frame_graph::compile(&graph, &CompileOptions::default()).unwrap();
    // 16 bytes for the count, 16 for each photon: the layout of the WGSL.
    let photons = plan.resources.iter().find(|resource| resource.name.as_str() == "emit.photons").unwrap();
    assert_eq!(photons.desc, ResourceDesc::buffer(16 + 100 * 16));
    for (index, pass) in plan.passes.iter().enumerate() {
        let kind = catalog.pass(&pass.kind).unwrap();
        let id = frame_graph::plan::PassId(index as u32);
        let steps =
            pass::link_steps(&plan, id, kind, &context.traits, catalog.shaders(), catalog.interfaces());
        assert_eq!(steps.unwrap_or_else(|error| panic!("{error}")).len(), 1, "{}", pass.name);
    }
}

/// Makes a catalog with `EMIT` and another pass type.
fn beside(other: &'static Emit) -> Result<(), NameTaken> {
    Catalog::with_passes(Assets::new(None), [&EMIT as &dyn Pass, other]).map(|_| ())
}

#[test]
fn two_interfaces_do_not_share_a_name() {
    static OTHER: [Interface; 1] = [Interface::new("GBuffer", "Something else.", &[])];
    static TAKER: Emit = Emit { name: "taker", interfaces: &OTHER };
    let taken = beside(&TAKER);
    assert_eq!(taken, Err(NameTaken::Interface { name: "GBuffer", pass: "taker" }));
    static ANOTHER: Emit = Emit { name: "another", interfaces: &INTERFACES };
    let same = beside(&ANOTHER);
    assert_eq!(same, Ok(()), "the same interface from two passes");
}

#[test]
fn two_pass_types_do_not_share_a_name() {
    let taken = beside(&Emit { name: "emit-photons", interfaces: &[] });
    assert_eq!(taken, Err(NameTaken::PassType { name: "emit-photons" }));
    let taken = beside(&Emit { name: "gbuffer", interfaces: &[] });
    assert_eq!(taken, Err(NameTaken::PassType { name: "gbuffer" }), "one of the tree");
}
