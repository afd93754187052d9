//! The interpreter, construct by construct, against what WGSL says of each.

use precision::{Interpreter, Scalar, Value};
use shader_library::{Library, MemoryFiles, Request, Shader};
use std::sync::Arc;

pub(crate) fn shader(text: &str) -> Arc<Shader> {
    let files = MemoryFiles::new([("test.wgsl", text)]);
    Library::new(Arc::new(files)).load(&Request::new("test.wgsl")).unwrap_or_else(|error| panic!("{error}"))
}

/// What `fn f(x: f32) -> f32` with this body gives in `f32` and in `f64`.
fn both(body: &str, x: f64) -> (f64, f64) {
    let shader = shader(&format!("fn f(x: f32) -> f32 {{ {body} }}"));
    let single = Interpreter::<f32>::new(&shader, &[]).unwrap().call("f", vec![Value::float(x)]);
    let double = Interpreter::<f64>::new(&shader, &[]).unwrap().call("f", vec![Value::float(x)]);
    (single.unwrap().to_f64s()[0], double.unwrap().to_f64s()[0])
}

/// The same where both agree, as they do on whole numbers.
fn one(body: &str, x: f64) -> f64 {
    let (single, double) = both(body, x);
    assert_eq!(single, double, "{body}");
    single
}

#[test]
fn operations_are_rounded_to_the_type() {
    let (single, double) = both("return x / 3.0;", 1.0);
    assert_eq!((single, double), (f64::from(1.0f32 / 3.0), 1.0 / 3.0));
    // 1e-9 is lost beside 1 in one of them.
    let (single, double) = both("return (1.0 + x) - 1.0;", 1e-9);
    assert_eq!(single, 0.0);
    assert!((double - f64::from(1e-9f32)).abs() < 1e-15);
    // Constants are those of f32 in both.
    assert_eq!(both("return 0.1;", 0.0), (f64::from(0.1f32), f64::from(0.1f32)));
}

#[test]
fn statements_run_in_their_order() {
    assert_eq!(one("var s = 0.0; for (var i = 0u; i < 5u; i++) { s += f32(i); } return s;", 0.0), 10.0);
    let skipped = "var s = 0.0; for (var i = 0; i < 9; i++) { if i == 2 { continue; } if i > 4 { break; } s += f32(i); } return s;";
    assert_eq!(one(skipped, 0.0), 8.0);
    assert_eq!(
        one("var s = 1.0; loop { s *= 2.0; continuing { s += 1.0; break if s > x; } } return s;", 20.0),
        31.0
    );
    assert_eq!(one("var s = 8.0; while s > x { s /= 2.0; } return s;", 3.0), 2.0);
    let switched = "var s = 0.0; switch u32(x) { case 1u, 2u: { s = 1.0; } case 3u: { s = 2.0; break; } default: { s = 3.0; } } return s;";
    assert_eq!([1.0, 2.0, 3.0, 9.0].map(|x| one(switched, x)), [1.0, 1.0, 2.0, 3.0]);
    // A return from within a loop within a switch.
    assert_eq!(one("switch i32(x) { case -1: { loop { return 7.0; } } default: {} } return 1.0;", -1.0), 7.0);
    assert_eq!(one("if x < 0.0 { return 1.0; } else if x == 0.0 { return 2.0; } return 3.0;", 0.0), 2.0);
    // Of && the second is not computed where the first is false.
    assert_eq!(
        one(
            "var a = array<f32, 2>(1.0, 2.0); let i = i32(x); if i < 2 && a[i] > 0.0 { return 1.0; } return 0.0;",
            5.0
        ),
        0.0
    );
}

#[test]
fn values_have_parts() {
    assert_eq!(one("let v = vec4(x, vec2(2.0, 3.0), 4.0); return dot(v.wz, v.yx) + v[2];", 1.0), 14.0);
    // Columns: the second is (3, 4).
    assert_eq!(
        one("let m = mat2x2(1.0, 2.0, 3.0, 4.0); let v = m * vec2(x, 10.0); return v.x * 100.0 + v.y;", 1.0),
        3142.0
    );
    assert_eq!(
        one("let m = mat2x2(1.0, 2.0, 3.0, 4.0); let v = vec2(x, 10.0) * m; return v.x * 100.0 + v.y;", 1.0),
        2143.0
    );
    assert_eq!(
        one(
            "let m = mat2x2(1.0, 2.0, 3.0, 4.0) * mat2x2(0.0, 1.0, 1.0, 0.0); return m[0].x + 10.0 * m[1].y;",
            0.0
        ),
        23.0
    );
    assert_eq!(one("let m = transpose(mat2x3(x, 2.0, 3.0, 4.0, 5.0, 6.0)); return m[2].y;", 0.0), 6.0);
    assert_eq!(
        one("var m = mat2x2<f32>(); m[1] = vec2(x, 2.0); m[0].y = 5.0; return m[1].x + m[0].y;", 3.0),
        8.0
    );
    assert_eq!(
        one("var a: array<vec2<f32>, 3>; a[u32(x)].y += 2.0; a[1][1] *= 3.0; return a[1].y;", 1.0),
        6.0
    );
    assert_eq!(
        one(
            "return select(1.0, 2.0, x > 0.0) + dot(select(vec2(1.0), vec2(5.0), vec2(true, false)), vec2(1.0, 10.0));",
            1.0
        ),
        17.0
    );
    assert_eq!(
        one("return f32(all(vec2(x) == vec2(1.0, 2.0))) + 2.0 * f32(any(vec2(x) == vec2(1.0, 2.0)));", 1.0),
        2.0
    );
}

#[test]
fn whole_numbers_wrap_and_divide_as_wgsl_says() {
    assert_eq!(one("let a = u32(x) - 4u; return f32(a >> 28u);", 3.0), 15.0);
    assert_eq!(one("let zero = i32(x); return f32(7 / zero) + f32(7 % zero) + f32(-7 % 4);", 0.0), 4.0);
    assert_eq!(one("return f32((u32(x) & 6u) | (1u << 3u)) + f32(~0 ^ 1);", 3.0), 8.0);
    assert_eq!(
        one(
            "return f32(countOneBits(u32(x)) + firstLeadingBit(u32(x)) * 10u + countLeadingZeros(u32(x)) * 100u);",
            5.0
        ),
        2922.0
    );
    assert_eq!(
        one("return f32(reverseBits(u32(x)) >> 24u) + f32(min(-3, 2)) + f32(max(3u, 2u));", 1.0),
        128.0
    );
    // Out of the range of the type: its end.
    assert_eq!(one("return f32(u32(x)) + f32(i32(1e10 * -x) >> 16u);", -1.0), 32767.0);
    assert_eq!(one("return f32(i32(x)) + f32(u32(-2.0 * x)) + f32(bool(x));", -1.5), 3.0);
}

#[test]
fn bits_of_a_float_are_those_of_f32() {
    let (single, double) = both("return bitcast<f32>(bitcast<u32>(x / 3.0) & 0xffff0000u);", 1.0);
    assert_eq!(single, double);
    assert_eq!(single, f64::from(f32::from_bits((1.0f32 / 3.0).to_bits() & 0xffff_0000)));
    let low = one("return f32(bitcast<u32>(x / 3.0) & 0xffffu);", 1.0);
    assert_eq!(low, f64::from((1.0f32 / 3.0).to_bits() & 0xffff));
    assert_eq!(one("return f32(bitcast<i32>(-x) < 0);", 1.0), 1.0);
    assert_eq!(one("return dot(unpack2x16snorm(pack2x16snorm(vec2(x, -1.0))), vec2(1.0, 10.0));", 1.0), -9.0);
}

#[test]
fn built_in_functions_are_those_of_f64() {
    assert_eq!(one("return fract(x) + ldexp(x, 3);", -1.75), -13.75);
    type Exact = fn(f64) -> f64;
    let functions: [(&str, Exact); 18] = [
        ("sqrt(x)", f64::sqrt),
        ("inverseSqrt(x)", |x| 1.0 / x.sqrt()),
        ("exp(x)", f64::exp),
        ("exp2(x)", f64::exp2),
        ("log(x)", f64::ln),
        ("log2(x)", f64::log2),
        ("sin(x)", f64::sin),
        ("cos(x)", f64::cos),
        ("tan(x)", f64::tan),
        ("asin(x)", f64::asin),
        ("acos(x)", f64::acos),
        ("atan(x)", f64::atan),
        ("atan2(x, 2.0)", |x| x.atan2(2.0)),
        ("pow(x, 2.5)", |x| x.powf(2.5)),
        ("mix(1.0, 3.0, x)", |x| 1.0 + 2.0 * x),
        ("smoothstep(0.0, 2.0, x)", |x| x * x / 4.0 * (3.0 - x)),
        ("fma(x, x, 1.0)", |x| x.mul_add(x, 1.0)),
        ("length(vec3(x, 2.0, 0.0))", |x| (x * x + 4.0).sqrt()),
    ];
    for (call, exact) in functions {
        let x = f64::from(0.7f32);
        let (single, double) = both(&format!("return {call};"), x);
        assert!((double - exact(x)).abs() < 1e-15, "{call}: {double} and {}", exact(x));
        assert!(
            (single - double).abs() <= 2e-7 * double.abs() && single != double,
            "{call}: {single} and {double}"
        );
    }
    assert_eq!(
        one("return floor(x) + 10.0 * ceil(x) + 100.0 * trunc(x) + 1000.0 * round(x);", -1.5),
        -2112.0
    );
    assert_eq!(
        one(
            "return sign(x) + 10.0 * step(x, -2.0) + 100.0 * clamp(x, -1.0, 1.0) + 1000.0 * saturate(x);",
            -2.0
        ),
        -91.0
    );
    assert_eq!(
        one(
            "let v = cross(vec3(x, 0.0, 0.0), vec3(0.0, 2.0, 1.0)); return v.x + 10.0 * v.y + 100.0 * v.z;",
            1.0
        ),
        190.0
    );
    assert_eq!(
        one(
            "let v = reflect(vec2(x, -1.0), vec2(0.0, 1.0)); return v.x + 10.0 * v.y + distance(v, vec2(1.0));",
            1.0
        ),
        11.0
    );
    assert_eq!(one("return normalize(vec2(x, 4.0)).y * 10.0 + abs(min(x, -1.0)) + max(x, 9.0);", 3.0), 18.0);
}

#[test]
fn functions_take_pointers_and_private_variables_keep_their_values() {
    let shader = shader(
        "struct Counter { n: u32, last: vec2<f32> }
         const START = array<vec2<f32>, 2>(vec2(1.0), vec2(2.0, 3.0));
         var<private> counter = Counter(5u, START[1]);
         fn count(it: ptr<function, Counter>, by: u32) { (*it).n += by; (*it).last.y = 7.0; }
         fn touch(x: ptr<private, u32>) -> u32 { *x += 1u; return *x; }
         fn f(x: f32) -> vec4<f32> {
             var own = counter;
             count(&own, 2u);
             counter.last = own.last;
             return vec4(f32(own.n), f32(touch(&counter.n)), counter.last);
         }",
    );
    let mut interpreter = Interpreter::<f64>::new(&shader, &[]).unwrap();
    assert_eq!(interpreter.call("f", vec![Value::float(0.0)]).unwrap().to_f64s(), [7.0, 6.0, 2.0, 7.0]);
    assert_eq!(interpreter.call("f", vec![Value::float(0.0)]).unwrap().to_f64s(), [8.0, 7.0, 2.0, 7.0]);
}

#[test]
fn uniforms_have_the_values_that_are_given() {
    let shader = shader(
        "struct Settings { scale: f32, count: u32 }
         var<uniform> settings: Settings;
         fn f(x: f32) -> f32 { return settings.scale * x * f32(settings.count); }",
    );
    let settings = Value::Composite(vec![Value::float(0.5), Value::Scalar(Scalar::U32(3))]);
    let mut interpreter = Interpreter::<f32>::new(&shader, &[("settings", settings)]).unwrap();
    assert_eq!(interpreter.call("f", vec![Value::float(4.0)]).unwrap().to_f64s(), [6.0]);
}

/// Why `fn f(x: f32) -> f32` with this body, after these declarations, is not computed.
fn fault(declarations: &str, body: &str) -> String {
    let shader = shader(&format!("{declarations}\nfn f(x: f32) -> f32 {{\n    {body}\n}}\n"));
    let mut interpreter = Interpreter::<f32>::new(&shader, &[]).unwrap();
    interpreter.call("f", vec![Value::float(4.0)]).unwrap_err().to_string()
}

#[test]
fn what_is_not_known_is_named_with_its_place() {
    let cases = [
        (
            "var t: texture_2d<f32>;",
            "return textureLoad(t, vec2(0), 0).x;",
            "test.wgsl:3:12: `textureLoad` is",
        ),
        ("var<uniform> a: f32;", "return x + a;", "test.wgsl:3:16: the variable `a` has no value"),
        ("var<workgroup> a: f32;", "workgroupBarrier(); return x;", "test.wgsl:3:5: a barrier is"),
        (
            "",
            "var a: array<f32, 4>;\n    return a[u32(x)];",
            "test.wgsl:4:12: an index is beyond the last: [4]",
        ),
        ("", "let a = vec2(x);\n    return a[i32(x)];", "a vector has nothing at the index 4"),
        ("", "return frexp(x).fract;", "the function Frexp is not known"),
        ("var<private> a: array<array<f32, 2048>, 2048>;", "return a[1][1];", "more than"),
    ];
    for (declarations, body, expected) in &cases[..6] {
        let message = fault(declarations, body);
        assert!(message.contains(expected), "{body}: {message}");
    }
    let (declarations, body, expected) = cases[6];
    let shader = shader(&format!("{declarations}\nfn f(x: f32) -> f32 {{ {body} }}"));
    let message = Interpreter::<f32>::new(&shader, &[]).err().unwrap().to_string();
    assert!(message.contains(expected) && message.starts_with("test.wgsl:1:1"), "{message}");
}

#[test]
fn what_does_not_end_is_ended() {
    for body in ["loop { } return x;", "var s = x; loop { s += 1.0; if s < 0.0 { break; } } return s;"] {
        let message = fault("", body);
        assert!(message.contains("does not end"), "{message}");
    }
}

#[test]
fn wrong_calls_are_told() {
    let shader = shader("fn f(x: f32) -> f32 { return x; }\nfn nothing() { }");
    let mut interpreter = Interpreter::<f32>::new(&shader, &[]).unwrap();
    let mut told = |name: &str| interpreter.call(name, Vec::new()).unwrap_err().to_string();
    assert_eq!(told("g"), "there is no function `g`");
    assert_eq!(told("f"), "`f` takes 1 arguments and was given 0");
    assert_eq!(told("nothing"), "`nothing` returns nothing");
}
