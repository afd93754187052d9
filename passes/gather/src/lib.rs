#![doc = include_str!("../README.md")]

use gpu_algorithms::{split, split_count};
use interfaces::{irradiance, virtual_lights, visibility};
use pass::{
    Compute, OutputContext, OutputDesc, Pass, PassTypeError, RecordContext, Recording, ResourceDesc, Threads,
    UseContext, reflected,
};

/// The pass type `gather`.
pub const PASS: &dyn Pass = &Gather;

struct Gather;

const SHADER: &str = "passes/gather/gather.wgsl";

/// The constant of the shader that is the pixels of a thread along each side.
const SPAN: &str = "SPAN";

impl Pass for Gather {
    fn kind(&self) -> &'static str {
        "gather"
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let mut outputs = reflected::outputs(use_cx, &self.main_shader(&cx.use_)?, cx)?;
        let irradiance = &outputs[0].facts;
        let (x, y) = (irradiance::INTERLEAVE_X.of(irradiance), irradiance::INTERLEAVE_Y.of(irradiance));
        let lights = cx.fact("lights", virtual_lights::COUNT)?;
        let lights_of_subset = lights.div_ceil(x.unwrap_or(1) * y.unwrap_or(1));
        let lookup = cx.fact("visibility", visibility::LOOP_ITERATIONS).unwrap_or(0);
        if split_count(lights_of_subset, iterations(use_cx.constant(SHADER, SPAN)?, lookup)) > 1 {
            let (width, height) = cx.input("view").and_then(|view| view.size()).unwrap_or(cx.frame);
            let bytes = u64::from(width) * u64::from(height) * 16;
            outputs.push(OutputDesc::scratch("sums", ResourceDesc::buffer(bytes)));
        }
        Ok(outputs)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let size = cx.size("view");
        let interleave = |fact| cx.fact("irradiance", fact);
        let (n, m) = (interleave(irradiance::INTERLEAVE_X)?, interleave(irradiance::INTERLEAVE_Y)?);
        let use_cx = cx.use_context();
        let constant = |name| use_cx.constant(SHADER, name);
        let (span, side) = (constant(SPAN)?, constant("GROUP_SIDE")?);
        let groups = |pixels: u32, sub_images: u32| pixels.div_ceil(sub_images).div_ceil(span * side);
        let grid = [groups(size.0, n) * side, groups(size.1, m) * n * m * side, 1];
        let shader = cx.file("gather.wgsl").define("PARTS", cx.port("sums").is_some());
        let gather = Compute::new(shader, "gather", Threads::Grid(grid))
            .value("interleave_x", n)
            .value("interleave_y", m);
        let lights_of_subset = cx.fact("lights", virtual_lights::COUNT)?.div_ceil(n * m);
        let lookup = cx.fact("visibility", visibility::LOOP_ITERATIONS).unwrap_or(0);
        Ok(Recording::of(split(gather, lights_of_subset, iterations(span, lookup))))
    }
}

/// Loop iterations of a thread for a light, if a visibility lookup takes `lookup`: one for the light, and those of each of
/// its pixels.
fn iterations(span: u32, lookup: u32) -> u32 {
    1 + span * span * (1 + lookup)
}
