//! `lightloom precision`: probes by the interpreter and on the GPU, files of one's own, and what is no probe.

use crate::program::{Done, Folder, command_of_tree};

fn precision(folder: &Folder, arguments: &[&str]) -> Done {
    let mut command = command_of_tree(folder);
    command.args(["precision", "--json", "-o", "out", "--magnitudes", "5", "--samples", "64"]);
    Done::of(command.args(arguments))
}

const LOST: &str = "// A difference that is lost.
struct Given { x: f32 }
fn given(magnitude: f32, u: vec4<f32>) -> Given { return Given(magnitude * (0.5 + 0.5 * u.x)); }
/// [magnitude: 1e-6 to 1e-2, x]
fn probe(given: Given) -> vec4<f32> { return vec4(1.0 - sqrt(1.0 - given.x), 0.0, 0.0, 0.0); }
";

#[test]
fn probes_by_name_are_measured_and_reported() {
    let folder = Folder::new(&[]);
    let record = precision(&folder, &["spot-caps", "triangles", "--interpret"]).success().json();
    assert_eq!(record["adapter"], "interpreter");
    let cells = record["records"].as_array().unwrap();
    for probe in ["spot-caps", "triangles"] {
        let of = |subject: &str| {
            cells.iter().filter(|cell| cell["scene"] == probe && cell["pipeline"] == subject).count()
        };
        assert_eq!([of("f32"), of("unavoidable")], [5, 5], "{probe}");
    }
    assert_eq!((&record["study"], &record["claims"]["hold"]), (&"precision".into(), &2.into()));
    assert!(folder.read("out/report.html").contains("<h3>Probes</h3>"));
    assert!(folder.read("out/cells.csv").contains("triangles,unavoidable,"));
}

#[test]
fn a_loss_of_precision_fails() {
    let folder = Folder::new(&[("own.wgsl", LOST)]);
    let done = precision(&folder, &["own.wgsl", "--interpret"]);
    let done = done.failure(1, &["1 of 1 probes exceed their bound"]);
    assert_eq!(done.json()["findings"][0]["verdict"], "fails");
}

#[test]
fn names_are_listed_and_misspelt_ones_reported() {
    let folder = Folder::new(&[]);
    let listed = precision(&folder, &["--list"]).json();
    assert!(listed.as_array().unwrap().iter().any(|probe| probe["name"] == "spot-caps"));
    precision(&folder, &["spot-cap"]).failure(1, &["did you mean `spot-caps`"]);
    precision(&folder, &["absent.wgsl"]).says(&["absent.wgsl"]);
}

/// Additions and square roots are exact to half a unit everywhere: on the GPU and by the interpreter, the same is lost.
#[test]
fn the_gpu_computes_what_the_interpreter_does() {
    let Some(folder) = Folder::with_gpu(&[("own.wgsl", LOST)]) else { return };
    let [on_gpu, interpreted] = [&["own.wgsl"][..], &["own.wgsl", "--interpret"]].map(|arguments| {
        let record = precision(&folder, arguments).json();
        let computed = record["records"].as_array().unwrap().iter().filter(|cell| cell["pipeline"] == "f32");
        let errors = computed.map(|cell| cell["measures"]["error"].as_f64().unwrap()).collect::<Vec<_>>();
        assert_eq!(errors.len(), 5);
        (record["adapter"].clone(), errors)
    });
    assert_ne!(on_gpu.0, interpreted.0);
    for (a, b) in on_gpu.1.iter().zip(&interpreted.1) {
        // Square roots may be off by two units in the last place on a GPU. [WGSL §15.7.4]
        assert!(*a <= 8.0 * b + 1e-7 && *b <= 8.0 * a + 1e-7, "{a} on the GPU, {b} by the interpreter");
    }
}
