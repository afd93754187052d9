//! Shows the cells of clusters on the surfaces in view.

pub mod cpu_reference;

use pass::{
    Compute, Extent, Format, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext,
    Recording, ResourceDesc, SceneBindings, Setting, Settings, UseContext, input, output, setting,
};

/// The pass type `show-clusters`.
pub const PASS: &dyn Pass = &ShowClusters;

/// A picture of clusters.
#[derive(Debug)]
pub struct ShowClusters;

const SHADER: &str = "passes/show-clusters/show-clusters.wgsl";

impl Pass for ShowClusters {
    fn info(&self) -> Info {
        Info {
            kind: "show-clusters",
            about: "Shows the cells of clusters of a reflective shadow map on the surfaces in view.",
            paper: "",
            shaders: &[SHADER],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        setting::of_shader(cx.shaders, SHADER)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![
                input("map", "ClusterMap", "The cluster of each texel."),
                input("clusters", "Clusters", "The clusters, averaged: where their centres are."),
                input("rsm", "ReflectiveShadowMap", "What was clustered; its positions are the shadow maps."),
                input("view", "GBuffer", "The surfaces to show them on."),
            ],
            outputs: vec![output("display", "Display", "The cells in colors.")],
            scene_bindings: SceneBindings::CAMERA.and(SceneBindings::LIGHTS),
        })
    }

    fn outputs(&self, _: &UseContext<'_>, _: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let display = ResourceDesc::texture_2d(Format::Rgba8Unorm, Extent::like("view"));
        Ok(vec![OutputDesc::one("display", display)])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        Ok(Recording::one(Compute::per_texel(cx.shader(SHADER, &[]), "show", cx.size("display"))))
    }
}
