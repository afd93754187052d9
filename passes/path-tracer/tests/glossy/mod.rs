//! Microfacet reflection: the sampled directional albedo against quadrature.

use pass_test::Harness;
use pass_test::rooms::{camera_at, matte, quad, room};
use pass_test::statistics::spread;
use std::f64::consts::PI;

/// GGX with the height-correlated Smith term, F₀ = 1: reflectance · cosine, in the surface's frame (shaders/ggx.wgsl).
pub(crate) fn reflected(alpha: f64, view: [f64; 3], light: [f64; 3]) -> f64 {
    let sum = [0, 1, 2].map(|i| view[i] + light[i]);
    let length = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
    let z = sum[2] / length;
    let a2 = alpha * alpha;
    let distribution = a2 / (PI * (z * z * (a2 - 1.0) + 1.0).powi(2));
    let smith = |n: f64, other: f64| other * (a2 + (1.0 - a2) * n * n).sqrt();
    0.5 * distribution / (smith(view[2], light[2]) + smith(light[2], view[2])) * light[2]
}

/// ∫ f cosθ dω over the hemisphere, with steps that are fine where the lobe is narrow.
fn directional_albedo(alpha: f64, cosine: f64) -> f64 {
    let view = [(1.0 - cosine * cosine).sqrt(), 0.0, cosine];
    let (rings, spokes) = (1000, 1000);
    let mut sum = 0.0;
    for i in 0..rings {
        // Uniform in the cosine: each step has the same solid angle.
        let z = (f64::from(i) + 0.5) / f64::from(rings);
        let r = (1.0 - z * z).sqrt();
        for j in 0..spokes {
            let angle = 2.0 * PI * (f64::from(j) + 0.5) / f64::from(spokes);
            sum += reflected(alpha, view, [r * angle.cos(), r * angle.sin(), z]);
        }
    }
    sum * 2.0 * PI / f64::from(rings * spokes)
}

/// A metal that reflects all light, in a room that glows uniformly: what is not reflected is what single scattering loses.
#[test]
fn a_metal_reflects_its_directional_albedo() {
    for roughness in [0.4_f32, 0.7, 1.0] {
        for cosine in [0.9_f64, 0.5, 0.2] {
            // A small plate, and around it walls that emit 1 and reflect nothing.
            let side = [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]];
            let mut quads = vec![quad([-0.2, 0.0, -0.2], [0.4, 0.0, 0.0], [0.0, 0.0, 0.4], 0)];
            for axis in 0..3 {
                let (a, b) = (side[(axis + 1) % 3], side[(axis + 2) % 3]);
                let mut far = [-1.0; 3];
                far[axis] = 1.0;
                quads.extend([quad([-1.0; 3], a, b, 1), quad(far, a, b, 1)]);
            }
            let mut metal = matte([1.0; 3], [0.0; 3]);
            metal.metallic = 1.0;
            metal.roughness = roughness;
            let scene = room(&quads, vec![metal, matte([0.0; 3], [1.0; 3])]);
            let from = [(1.0 - cosine * cosine).sqrt() as f32 * 0.8, cosine as f32 * 0.8, 0.0];
            let harness =
                Harness::new(path_tracer::PASS).with_scene(scene).camera(camera_at(from, [0.0; 3], 1e-3));
            let Some(outputs) =
                harness.frame(16, 16).set("bounces", 0u32).set("samples_per_frame", 64u32).run()
            else {
                return;
            };
            let direct: Vec<[f32; 4]> = outputs.read("direct");
            let (mean, deviation) = spread(direct.iter().map(|pixel| pixel[0]));
            let expected = directional_albedo(f64::from(roughness * roughness), cosine);
            let name = format!("roughness {roughness}, cosine {cosine}");
            assert!(expected <= 1.0001, "{name}: {expected}");
            // The quadrature's own error is below a thousandth.
            assert!(
                (mean - expected).abs() < 4.0 * deviation + 1e-3,
                "{name}: {mean} ± {deviation}, not {expected}"
            );
            assert!(deviation < 0.01, "{name}: ± {deviation}");
        }
    }
}
