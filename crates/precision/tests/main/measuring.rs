//! Measuring: what is lost is seen, what cannot be kept is told from it, and both are reported.

use precision::{Interpreted, Kernel, Measured, Options, Probe, ROUNDING, measure, run};
use shader_library::{Library, MemoryFiles};
use std::sync::Arc;

fn load(text: &str) -> Result<Probe, String> {
    let files = MemoryFiles::new([("shaders/precision/own.wgsl", text)]);
    Probe::load(&Library::new(Arc::new(files)), "shaders/precision/own.wgsl")
        .map_err(|error| error.to_string())
}

/// A probe of an expression of `given.x`, which is the magnitude, and `given.y`, a random number.
fn probe(declared: &str, expression: &str) -> Probe {
    let text = format!(
        "// What is <lost>.\n// And where.\n\nstruct Given {{ x: f32, y: f32 }}\n\
         fn given(magnitude: f32, u: vec4<f32>) -> Given {{ return Given(magnitude, 0.5 + 0.5 * u.x); }}\n\
         /// Measures.\n/// [magnitude: 1e-4 to 1, x [rad]]\n{declared}\
         fn probe(given: Given) -> vec4<f32> {{ let x = given.x; let y = given.y; return vec4({expression}); }}\n"
    );
    load(&text).unwrap_or_else(|error| panic!("{error}"))
}

fn measured(declared: &str, expression: &str) -> Measured {
    let options = Options { magnitudes: 9, samples: 64, seed: 3 };
    measure(&probe(declared, expression), &Interpreted, &options).unwrap()
}

#[test]
fn cancellation_is_seen_and_its_remedy_holds() {
    let lost = measured("", "1.0 - cos(x), 0.0, 0.0, 0.0");
    assert!(!lost.holds());
    let worst = lost.worst().unwrap();
    // 1 - cos(1e-4) is a twelfth of the rounding of a number near 1.
    assert_eq!((worst.magnitude, worst.errors.most), (f64::from(1e-4f32), 1.0));
    assert!(worst.unavoidable.most < 4.0 * ROUNDING, "{worst:?}");
    let kept = measured("", "2.0 * sin(0.5 * x) * sin(0.5 * x), 0.0, 0.0, 0.0");
    assert!(kept.holds() && kept.worst().unwrap().errors.most < 4.0 * ROUNDING);
}

#[test]
fn what_inputs_do_not_tell_is_unavoidable() {
    // y and y + x as inputs: their difference is off by their rounding, whatever formula takes it.
    let text = "struct Given { a: f32, b: f32 }
        fn given(magnitude: f32, u: vec4<f32>) -> Given { return Given(1.0 + u.x, 1.0 + u.x + magnitude); }
        /// [magnitude: 1e-4 to 1, difference]
        fn probe(given: Given) -> vec4<f32> { return vec4(given.b - given.a, 0.0, 0.0, 0.0); }";
    let probe = load(text).unwrap();
    let measured = measure(&probe, &Interpreted, &Options { magnitudes: 5, samples: 64, seed: 3 }).unwrap();
    assert!(measured.holds());
    // Half a unit in the last place of two numbers between 1 and 2.
    let first = measured.points[0];
    assert!((0.9..1.1).contains(&(first.unavoidable.most / (2.0 * ROUNDING / 1e-4))), "{first:?}");
    // The difference of two numbers that near is exact.
    assert_eq!(first.errors.most, 0.0);
}

#[test]
fn what_is_not_finite_counts_as_error() {
    let overflown = measured("", "(1e38 + x) * 1e38 * 0.0 + 1.0, 0.0, 0.0, 0.0");
    assert!(!overflown.holds());
    assert!(overflown.points.iter().all(|point| point.lost == 1.0 && point.errors.median == f64::INFINITY));
    // What vanishes has lost all of it.
    let vanished = measured("", "x * 1e-30 * 1e-30, 0.0, 0.0, 0.0");
    assert_eq!(vanished.worst().unwrap().errors.median, 1.0);
}

#[test]
fn errors_are_of_each_component_or_of_the_vector() {
    let expression = "1.0, (1.0 + 1e-6 * y) - 1.0, 0.0, 0.0";
    assert!(!measured("", expression).holds());
    assert!(measured("/// [compared: vector]\n", expression).holds());
}

#[test]
fn a_bound_is_what_is_declared() {
    let expression = "(x + y) - y, 0.0, 0.0, 0.0";
    assert!(!measured("/// [bound: 100]\n", expression).holds());
    let wide = measured("/// [bound: 20000]\n", expression);
    assert!(wide.holds());
    let point = &wide.points[0];
    assert_eq!(wide.demanded(point), 20000.0 * point.unavoidable.most);
}

#[test]
fn samples_do_not_depend_on_what_computes() {
    let options = Options { magnitudes: 3, samples: 8, seed: 1 };
    let probe = probe("/// [samples: 5]\n", "x * y, 0.0, 0.0, 0.0");
    assert_eq!(probe.most_samples, 5);
    let [a, b] = [0, 1].map(|_| measure(&probe, &Interpreted, &options).unwrap().points[1].errors);
    assert_eq!(a, b);
    let other = measure(&probe, &Interpreted, &Options { seed: 2, ..options }).unwrap().points[1].errors;
    assert_ne!(a, other);
}

#[test]
fn what_is_no_probe_is_told() {
    let given = "struct Given { x: f32 }\nfn given(m: f32, u: vec4<f32>) -> Given { return Given(m); }\n";
    let function = "fn probe(given: Given) -> vec4<f32> { return vec4(given.x); }";
    let range = "/// [magnitude: 1 to 2, x]\n";
    let cases = [
        (given.to_owned(), "there is no `fn probe(given: Given)`"),
        (format!("{given}{function}"), "own.wgsl:3: the comment of `fn probe` has no `[magnitude"),
        (format!("{given}/// [magnitude: 2 to 1, x]\n{function}"), "own.wgsl:3: expected `LEAST to GREATEST"),
        (format!("{given}/// [magnitude: 0 to 1, x]\n{function}"), "expected `LEAST to GREATEST"),
        (
            format!("{given}{range}/// [bound: 0.5]\n{function}"),
            "own.wgsl:4: expected a number of at least 1",
        ),
        (format!("{given}{range}/// [samples: 0]\n{function}"), "expected a whole number"),
        (format!("{given}{range}/// [compared: lines]\n{function}"), "`lines` is neither"),
        (format!("{given}{range}/// [option: GLOSSY]\n{function}"), "expected the name of an option"),
        (format!("{given}{range}/// [color: red]\n{function}"), "`color` is none of"),
        (format!("{range}fn probe(x: f32) -> f32 {{ return x; }}"), "there is no `struct Given`"),
        (format!("{range}{}", function.replace("Given", "vec4<f32>")), "there is no `struct Given`"),
        (format!("struct Given {{ x: f32 }}\n{range}{function}"), "there is no `fn given`"),
        (
            format!("{}{range}{function}", given.replace("u: vec4<f32>", "u: f32")),
            "`fn given` is (f32, f32) -> Given, expected (f32, vec4<f32>) -> Given",
        ),
        ("fn probe(given: Given".to_owned(), "error["),
    ];
    for (text, expected) in cases {
        let error = load(&text).err().unwrap_or_else(|| panic!("{text}"));
        assert!(error.contains(expected), "{text}\n{error}");
    }
}

/// A probe is a case of a study: errors by magnitude in its folder, and its bound as a claim where the error is worst.
#[test]
fn probes_are_cases_of_a_study() {
    let probes = [
        ("lost", probe("", "1.0 - cos(x), 0.0, 0.0, 0.0")),
        ("kept", probe("", "x + y, 0.0, 0.0, 0.0")),
        ("overflows", probe("", "x * 1e38 * 1e38, 0.0, 0.0, 0.0")),
    ];
    let probes = probes.map(|(name, mut probe)| {
        probe.name = name.to_owned();
        probe
    });
    let folder = tempfile::tempdir().unwrap();
    let options = Options { magnitudes: 9, samples: 64, seed: 3 };
    let (ran, all) = run(&probes, &Interpreted, &options, folder.path(), &mut |_| {}).unwrap();
    assert_eq!((ran.run, ran.failed, all.len()), (3 * 9 * 2, 0, 3));
    let results = &ran.results;
    let (first, worst) = (&results.cells[0], all[0].worst().unwrap());
    assert_eq!((first.scene.as_str(), first.pipeline.as_str()), ("lost", "f32"));
    assert_eq!(first.measures["error"], Some(worst.errors.most), "the worst is the first");
    // JSON has no infinity.
    let overflown = results.cells.iter().find(|cell| cell.scene == "overflows").unwrap();
    assert_eq!((overflown.measures["error"], overflown.measures["lost"]), (None, Some(1.0)));
    let findings = results.findings();
    let verdicts: Vec<_> = findings.iter().map(|finding| finding.verdict).collect();
    let holds = |holds| Some(if holds { study::Verdict::Holds } else { study::Verdict::Fails });
    assert_eq!(verdicts, all.iter().map(|measured| holds(measured.holds())).collect::<Vec<_>>());
    assert_eq!(verdicts, [holds(false), holds(true), holds(false)]);
    let pages = study::report_with(results, folder.path(), &[precision::table(&all)]).unwrap();
    let page = std::fs::read_to_string(&pages[0]).unwrap();
    for expected in [
        "What is &lt;lost&gt;. And where. Magnitude: x [rad].",
        "class=\"number exceeds\"",
        "default-src 'none'",
        "Probe",
    ] {
        assert!(page.contains(expected), "{expected}");
    }
    // Errors, their medians and lost samples by magnitude.
    assert_eq!(page.matches("<svg").count(), 3 * 3);
    assert!(!page.contains("<lost>") && !page.contains("Nothing to draw"), "{page}");
    let cells = std::fs::read_to_string(folder.path().join("cells.csv")).unwrap();
    assert!(cells.contains("kept,f32,") && !cells.contains("NaN") && !cells.contains("inf"));
}

#[test]
fn inputs_lie_in_a_buffer_as_wgsl_lays_them_out() {
    let probe = load(
        "struct Settings { scale: f32 }
         var<uniform> settings: Settings;
         struct Given { x: f32, v: vec3<f32>, m: mat2x3<f32>, n: array<u32, 2>, settings: Settings }
         fn given(magnitude: f32, u: vec4<f32>) -> Given {
             return Given(1.0, vec3(2.0, 3.0, 4.0), mat2x3(5.0, 6.0, 7.0, 8.0, 9.0, 10.0), array(1u, 2u), Settings(11.0));
         }
         /// [magnitude: 1 to 2, x]
         fn probe(given: Given) -> vec4<f32> { return vec4(given.x * settings.scale); }",
    );
    let probe = probe.unwrap_or_else(|error| panic!("{error}"));
    let kernel = Kernel::new(&probe).unwrap();
    let given = probe.given(1.0, [0.0; 4]).unwrap();
    // The uniform has its value on the CPU, too.
    assert_eq!(probe.interpret(&given).unwrap(), [11.0; 4]);
    let bytes = kernel.bytes(&[given.clone(), given]).unwrap();
    let words: Vec<u32> = bytes.chunks(4).map(|word| u32::from_le_bytes(word.try_into().unwrap())).collect();
    // Vectors of three lie at multiples of 16 bytes.
    let f = f32::to_bits;
    let one = [
        [f(1.0), 0, 0, 0],
        [f(2.0), f(3.0), f(4.0), 0],
        [f(5.0), f(6.0), f(7.0), 0],
        [f(8.0), f(9.0), f(10.0), 0],
        [1, 2, f(11.0), 0],
    ];
    assert_eq!(words, [one, one].as_flattened().as_flattened());
}
