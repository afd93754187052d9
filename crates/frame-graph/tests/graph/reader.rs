//! The reader: it takes what the `ron` crate takes, with the same values, and breaks on nothing.

use super::kinds::{MemoryFiles, TestPassTypes, traits};
use super::whole::{BASE, SHADOWS};
use frame_graph::{CompileOptions, LinkContext, Overrides, Source, Value, compile, link, parse, resolve};
use proptest::prelude::*;

/// A value of a setting as text, in any of the ways in which RON writes it.
fn literal() -> impl Strategy<Value = String> {
    prop_oneof![
        any::<i64>().prop_map(|n| n.to_string()),
        any::<u32>().prop_map(|n| format!("{n:#x}")),
        any::<u16>().prop_map(|n| format!("{n:#b}")),
        any::<u16>().prop_map(|n| format!("0o{n:o}")),
        any::<u32>().prop_map(|n| format!("+{n}")),
        any::<i32>().prop_map(|n| format!("{n}i32")),
        any::<u8>().prop_map(|n| format!("{n}u8")),
        (1..1000u32, 0..1000u32).prop_map(|(a, b)| format!("{a}_{b:03}")),
        any::<f32>().prop_filter("finite", |x| x.is_finite()).prop_map(|x| format!("{x:?}")),
        any::<f32>().prop_filter("finite", |x| x.is_finite()).prop_map(|x| format!("{x:e}")),
        (0..100u32).prop_map(|n| format!(".{n}")),
        (0..100u32).prop_map(|n| format!("{n}.")),
        (0..100u32).prop_map(|n| format!("{n}.5f32")),
        any::<bool>().prop_map(|b| b.to_string()),
        any::<String>().prop_map(|text| format!("{:?}", text.replace('$', "S"))),
        "[a-z \"#\\\\]{0,12}".prop_map(|text| format!("r###\"{}\"###", text.replace('#', " "))),
        "[a-z]{0,5}".prop_map(|text| format!("\"{text}\\x41\\u{{1F600}}\\'\\0\"")),
        prop::collection::vec(0..100i32, 2..=4).prop_map(|v| {
            let v: Vec<String> = v.iter().map(i32::to_string).collect();
            format!("({})", v.join(", "))
        }),
        prop::collection::vec(0..100i32, 2..=4).prop_map(|v| format!("{v:?}")),
    ]
}

fn blank() -> impl Strategy<Value = String> {
    let piece = prop_oneof![
        Just(" ".to_owned()),
        Just("\n".to_owned()),
        Just("\t\r\n".to_owned()),
        "[a-z \"'(]{0,8}".prop_map(|text| format!("// {text}\n")),
        "[a-z \"'(]{0,8}".prop_map(|text| format!("/* {text} /* inner */ */")),
    ];
    prop::collection::vec(piece, 0..3).prop_map(|pieces| pieces.concat())
}

/// What the `ron` crate makes of a value of a setting.
fn expected(value: &ron::Value) -> Option<Value> {
    let number = |value: &ron::Value| match value {
        ron::Value::Number(n) => Some(n.into_f64()),
        _ => None,
    };
    Some(match value {
        ron::Value::Bool(b) => Value::Bool(*b),
        ron::Value::String(text) => Value::Text(text.clone()),
        ron::Value::Number(ron::value::Number::F32(x)) => Value::F32(x.get()),
        ron::Value::Number(ron::value::Number::F64(x)) => Value::F32(x.get() as f32),
        ron::Value::Number(n) => {
            let x = n.into_f64();
            if x >= 0.0 && x <= f64::from(u32::MAX) {
                Value::U32(x as u32)
            } else if x < 0.0 && x >= f64::from(i32::MIN) {
                Value::I32(x as i32)
            } else {
                Value::F32(x as f32)
            }
        }
        ron::Value::Seq(items) => {
            Value::Vector(items.iter().map(|i| number(i).map(|x| x as f32)).collect::<Option<_>>()?)
        }
        _ => return None,
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 512, ..ProptestConfig::default() })]

    #[test]
    fn it_reads_what_the_ron_crate_reads(
        values in prop::collection::vec(literal(), 1..8),
        blanks in prop::collection::vec(blank(), 12),
        trailing in any::<bool>(),
    ) {
        let b = |i: usize| &blanks[i % blanks.len()];
        let comma = if trailing { "," } else { "" };
        let set: Vec<String> =
            values.iter().enumerate().map(|(i, v)| format!("{}\"s{i}\"{}:{}{v}{}", b(i), b(i + 1), b(i + 2), b(i + 3))).collect();
        let text = format!(
            "#![enable(implicit_some)]{}Pipeline{}(passes:{}{{\"a\": Pass(kind: \"noise\", set: {{{}{comma}}}{comma}){comma}}}{comma}{}){}",
            b(4), b(5), b(6), set.join(","), b(7), b(8)
        );
        let Ok(tree) = ron::from_str::<ron::Value>(&text) else {
            return Err(TestCaseError::fail(format!("the ron crate does not read {text}: {:?}", ron::from_str::<ron::Value>(&text))));
        };
        let found = parse(Source::new("a.ron", text.as_str())).map_err(|e| TestCaseError::fail(e.to_string()))?;
        let given = found.settings("a");
        let ron::Value::Map(top) = &tree else { panic!("a map") };
        let get = |map: &ron::Map, key: &str| map.iter().find(|(k, _)| **k == ron::Value::String(key.into())).map(|(_, v)| v.clone());
        let Some(ron::Value::Map(passes)) = get(top, "passes") else { panic!("passes") };
        let Some(ron::Value::Map(pass)) = get(&passes, "a") else { panic!("a pass") };
        let Some(ron::Value::Map(set)) = get(&pass, "set") else { panic!("settings") };
        for (i, value) in values.iter().enumerate() {
            let name = format!("s{i}");
            let expected = expected(&get(&set, &name).expect("a value"));
            let found = given.iter().find(|(n, _)| *n == name).map(|(_, v)| (*v).clone());
            prop_assert_eq!(found, expected, "{}", value);
        }
    }

    #[test]
    fn broken_text_gives_an_error_and_never_a_panic(
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..4u8, "[(){}\\[\\],:\"'$./#a-z0-9 é]{0,3}"), 1..6),
        in_part in any::<bool>(),
    ) {
        let mut texts = [BASE.to_owned(), SHADOWS.to_owned()];
        let text = &mut texts[usize::from(in_part)];
        for (at, how, new) in edits {
            let mut at = at.index(text.len() + 1);
            while !text.is_char_boundary(at) {
                at -= 1;
            }
            let next = text[at..].chars().next().map_or(at, |c| at + c.len_utf8());
            match how {
                0 => text.insert_str(at, &new),
                1 => text.replace_range(at..next, ""),
                2 => text.replace_range(at..next, &new),
                _ => text.truncate(if at == 0 { next } else { at }),
            }
        }
        let files = MemoryFiles::new(&[("base.ron", &texts[0]), ("parts/shadows.ron", &texts[1])]);
        let context = LinkContext { frame: (640, 480), traits: traits() };
        let run = || compile(&link(&resolve("base.ron", &files, &Overrides::default())?, &TestPassTypes::new(), &context)?, &CompileOptions::default());
        match run() {
            Ok(plan) => prop_assert!(!plan.outputs.is_empty()),
            Err(errors) => {
                prop_assert!(!errors.0.is_empty());
                let shown = errors.to_string();
                // Of more than a hundred errors, the rest is counted.
                for error in errors.0.iter().take(100) {
                    prop_assert!(!error.labels.is_empty(), "{}", error.message);
                    prop_assert!(shown.contains(error.code));
                    for label in &error.labels {
                        let text = &label.span.source.text;
                        let (start, end) = (label.span.start as usize, label.span.end as usize);
                        prop_assert!(start <= end && end <= text.len());
                        prop_assert!(text.is_char_boundary(start) && text.is_char_boundary(end), "{}", &shown);
                    }
                    prop_assert!(shown.contains(&error.labels[0].span.to_string()), "{}\n{}", error.labels[0].span, &shown);
                }
            }
        }
    }

    #[test]
    fn any_text_at_all_is_read_without_a_panic(text in any::<String>(), noise in "[(){}\\[\\],:\"'r#b/*\\\\.0-9a-z+-]{0,60}") {
        let _ = parse(Source::new("a.ron", text));
        let _ = parse(Source::new("a.ron", noise));
    }
}
