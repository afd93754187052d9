//! Structs that Rust and WGSL share.

use interfaces::INTERFACES;
use interfaces::clusters::{self, Cluster, ClustersHeader, NO_TEXEL};
use interfaces::light_tree::{self, LightNode, LightTreeHeader};
use interfaces::progress::PROGRESS;
use interfaces::surface_points::{self, SurfacePoint, SurfacePointsHeader, packed_albedo};
use interfaces::virtual_lights::{self, VirtualLight};
use pass::{Content, Request};

wgsl_structs::wgsl! {
    "clusters/clusters.wgsl" {
        use interfaces::clusters::Cluster;
        use interfaces::clusters::ClustersHeader;
    }
    "light_tree/light-nodes.wgsl" {
        use interfaces::light_tree::LightNode;
        struct LightTree as Tree;
    }
    "points/surface-sample.wgsl" {
        use interfaces::points::SurfaceSample;
    }
    "progress/progress.wgsl" {
        use interfaces::progress::Progress;
    }
    "radiosity/point-radiosity.wgsl" {
        use interfaces::radiosity::PointRadiosity;
    }
    "stands/stands.wgsl" {
        use interfaces::stands::Stand;
    }
    "surface_points/surface-points.wgsl" {
        use interfaces::surface_points::SurfacePoint;
        use interfaces::surface_points::SurfacePointsHeader;
    }
    "virtual_lights/virtual-lights.wgsl" {
        use interfaces::virtual_lights::VirtualLight;
        struct VirtualLights as Lights;
    }
    fn layouts;
}

#[allow(dead_code, reason = "only the layouts are compared")]
mod forms {
    wgsl_structs::wgsl! {
        "tests/forms.wgsl" {
            struct Inner;
            struct Outer;
            struct Rows as RowsHeader;
        }
        pub(crate) fn layouts;
    }
}

/// The layouts of all structs that Rust shares with WGSL, against those of naga.
#[test]
fn rust_has_the_layouts_of_the_wgsl() {
    let library = pass_test::shaders();
    let layouts = [layouts(), forms::layouts(), scene_upload::layouts()].concat();
    let members = INTERFACES.iter().flat_map(|interface| interface.members);
    let files = members.filter_map(|member| match member.content {
        Content::Struct(structure) => Some(structure.file),
        _ => None,
    });
    let shared = ["camera", "frame", "lights", "ray-tracing", "scene", "view-sample"]
        .map(|name| format!("shaders/{name}.wgsl"));
    let others = ["crates/interfaces/points/surface-sample.wgsl", "crates/interfaces/tests/forms.wgsl"];
    let mut left: Vec<_> = layouts.iter().map(|layout| layout.name.as_str()).collect();
    for file in files.chain(others).chain(shared.iter().map(String::as_str)) {
        let shader = library.load(&Request::new(file)).unwrap_or_else(|error| panic!("{error}"));
        shader.check_layout(&layouts, "interfaces").unwrap_or_else(|error| panic!("{error}"));
        left.retain(|name| shader.interface.layout(name).is_none());
    }
    assert!(left.is_empty(), "no file has {left:?}");
}

/// Sizes of buffers by reflection of the WGSL, against sums by hand.
#[test]
fn buffers_have_the_sizes_of_the_wgsl() {
    let cx = pass_test::use_context();
    let lights = |count| virtual_lights::output(&cx, "lights", count).unwrap().members[0].1.clone();
    assert_eq!(lights(0), pass::ResourceDesc::buffer(16));
    assert_eq!(lights(1000), pass::ResourceDesc::buffer(16 + 1000 * 48));
    assert_eq!(cx.size_of(PROGRESS).unwrap(), 16);
    let refused = cx.buffer(pass::Struct::new(PROGRESS.file, "Progres"), 1).unwrap_err().message;
    assert!(
        refused.contains("there is no struct `Progres`") && refused.contains("did you mean `Progress`?"),
        "{refused}"
    );
    let refused = cx.constant("shaders/algorithms/workgroup.wgsl", "BLOCK_SISE").unwrap_err().message;
    assert!(refused.contains("S031") && refused.contains("did you mean `BLOCK_SIZE`?"), "{refused}");
}

#[test]
fn lights_come_out_of_their_buffer() {
    let light = VirtualLight {
        position: [1.0, 2.0, 3.0],
        flux: [5.0, 6.0, 7.0],
        area: 0.25,
        texel: 77,
        ..Default::default()
    };
    let bytes = virtual_lights::to_bytes(&[light]);
    assert_eq!(virtual_lights::from_bytes(&bytes), Some(vec![light]));
    let longer = [&bytes[..], &[1; 48]].concat();
    assert_eq!(virtual_lights::from_bytes(&longer), Some(vec![light]), "what lies beyond has no meaning");
    assert_eq!(virtual_lights::from_bytes(&bytes[..63]), None, "a byte is missing");
    assert_eq!(virtual_lights::from_bytes(&bytes[..15]), None, "no header");
    let many = [&u32::MAX.to_le_bytes()[..], &bytes[4..]].concat();
    assert_eq!(virtual_lights::from_bytes(&many), None);
}

#[test]
fn trees_come_out_of_their_buffer() {
    let leaf = LightNode { light: 3, flux: 2.0, low: [1.0, 2.0, 3.0], ..Default::default() };
    let header = LightTreeHeader { count: 1, root: 1, ..Default::default() };
    let bytes = light_tree::to_bytes(&header, &[LightNode::default(), leaf]);
    let wanted = (LightTreeHeader { leaves: 1, ..header }, vec![LightNode::default(), leaf]);
    assert_eq!(light_tree::from_bytes(&bytes), Some(wanted));
    assert_eq!(light_tree::from_bytes(&bytes[..bytes.len() - 1]), None);
    let many = [&bytes[..4], &u32::MAX.to_le_bytes(), &bytes[8..]].concat();
    assert_eq!(light_tree::from_bytes(&many), None);
    assert_eq!([0, 1, 5, 64].map(light_tree::leaves), [1, 1, 8, 64]);
}

/// Modules that stand in for those of producers are there and answer by themselves.
#[test]
fn stand_ins_are_there() {
    let library = pass_test::shaders();
    for module in INTERFACES.iter().filter_map(|interface| interface.stand_in) {
        library.load(&Request::new(module)).unwrap_or_else(|error| panic!("{error}"));
    }
}

#[test]
fn clusters_come_out_of_their_buffer() {
    let cx = pass_test::use_context();
    let bytes = |count| clusters::output(&cx, "clusters", count).unwrap().members[0].1.clone();
    assert_eq!(bytes(0), pass::ResourceDesc::buffer(size_of::<ClustersHeader>() as u64));
    assert_eq!(bytes(3), pass::ResourceDesc::buffer(80 + 3 * 112));
    let header =
        ClustersHeader { merged: 4, greatest_area: 2.5, map_flux: [1.0, 2.0, 3.0], ..Default::default() };
    let cluster =
        Cluster { position: [1.0, 2.0, 3.0], texel: NO_TEXEL, uv: [0.5, 7.0], ..Default::default() };
    let bytes = clusters::to_bytes(&header, &[cluster, Cluster::default()]);
    let wanted = (ClustersHeader { count: 2, ..header }, vec![cluster, Cluster::default()]);
    assert_eq!(clusters::from_bytes(&bytes), Some(wanted));
    assert_eq!(clusters::from_bytes(&bytes[..bytes.len() - 1]), None);
}

#[test]
fn surface_points_come_out_of_their_buffer() {
    let cx = pass_test::use_context();
    let bytes = |count| surface_points::output(&cx, "points", count).unwrap().members[0].1.clone();
    assert_eq!(bytes(0), pass::ResourceDesc::buffer(16));
    assert_eq!(bytes(3), pass::ResourceDesc::buffer(16 + 3 * 48));
    let point = SurfacePoint {
        position: [1.0, 2.0, 3.0],
        triangle: 5,
        barycentrics: [0.5, 0.25],
        ..Default::default()
    };
    let bytes = surface_points::to_bytes(7, &[point, SurfacePoint::NONE]);
    let header = SurfacePointsHeader { count: 2, iteration: 7, ..SurfacePointsHeader::default() };
    assert_eq!(surface_points::from_bytes(&bytes), Some((header, vec![point, SurfacePoint::NONE])));
    assert_eq!(surface_points::from_bytes(&bytes[..bytes.len() - 1]), None);
    assert_eq!((point.is_none(), SurfacePoint::NONE.is_none()), (false, true));
}

#[test]
fn packed_reflectances_are_close() {
    for albedo in [[0.0, 1.0, 0.5], [0.25, 0.01, 0.8], [1e-4, 2.0, -1.0]] {
        let packed = SurfacePoint { albedo: packed_albedo(albedo), ..Default::default() };
        for (found, expected) in std::iter::zip(packed.albedo(), albedo) {
            let expected = f64::clamp(expected, 0.0, 1.0);
            assert!((found - expected).abs() <= 0.001 * expected.sqrt() + 1e-6, "{found} for {expected}");
        }
    }
    let white = SurfacePoint { albedo: packed_albedo([1.0; 3]), ..Default::default() };
    assert_eq!(white.albedo(), [1.0; 3]);
}

#[test]
fn every_figure_is_a_number_of_its_struct() {
    let library = pass_test::shaders();
    for interface in INTERFACES.iter().filter(|interface| !interface.figures.is_empty()) {
        let Some(Content::Struct(structure)) = interface.members.first().map(|member| member.content) else {
            panic!("{} has figures and no struct that holds them", interface.name);
        };
        let shader = library.load(&Request::new(structure.file)).unwrap_or_else(|error| panic!("{error}"));
        for figure in interface.figures {
            let member = shader.interface.member(structure.name, figure.name);
            let scalar = member.is_some_and(|member| ["u32", "f32"].contains(&member.ty.as_str()));
            assert!(scalar, "{}: {} is no number of {}", interface.name, figure.name, structure.name);
        }
    }
}
