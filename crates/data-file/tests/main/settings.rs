//! Which values a setting takes.

use data_file::{Setting, Value, ValueType};

#[test]
fn the_ends_of_a_range_are_in_it() {
    for (min, max) in [(0.01, 0.1), (1e-12, 1e12), (0.3, 0.7)] {
        let setting = Setting {
            name: "white".to_owned(),
            ty: ValueType::F32,
            default: Value::F32(0.5),
            min: Some(min),
            max: Some(max),
            one_of: Vec::new(),
            unit: String::new(),
            doc: String::new(),
            declared: String::new(),
        };
        for end in [min, max] {
            assert!(setting.check(Value::F32(end as f32)).is_ok(), "{end}");
        }
        for beyond in [(min as f32).next_down(), (max as f32).next_up()] {
            assert!(setting.check(Value::F32(beyond)).is_err(), "{beyond}");
        }
    }
}
