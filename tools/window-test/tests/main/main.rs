//! The driver against a small program that records what its window is sent.

mod program;

use metrics::Image;
use program::{BLUE, GREEN, Program, RED};
use std::time::{Duration, Instant};
use window_test::{Button, Display, Error, Window};

const SOON: Duration = Duration::from_secs(20);

/// A display, a program on it and its window; `None` without Xvfb.
fn shown(size: [u16; 2]) -> Option<(Display, Program, Window)> {
    let display = Display::start_sized([640, 480])?;
    let program = Program::show(display.env().1, "A recorder", size);
    let mut window = display.wait_for_window("record", SOON).unwrap();
    window.set_pace(Duration::from_millis(1));
    Some((display, program, window))
}

fn rgb(image: &Image, x: usize, y: usize) -> [f32; 3] {
    let [r, g, b, _] = image.pixels()[y * image.width() + x];
    [r, g, b]
}

#[test]
fn a_text_arrives_as_it_was_typed() {
    let Some((_display, program, window)) = shown([64, 64]) else { return };
    window.type_text("Hello, W0rld! {a_b} \"c\" ~\n").unwrap();
    program.wait_for("key Return");
    assert_eq!(program.typed(), "Hello, W0rld! {a_b} \"c\" ~");
}

#[test]
fn a_chord_holds_its_modifiers_around_the_key() {
    let Some((_display, program, window)) = shown([64, 64]) else { return };
    window.key("Ctrl+shift+p").unwrap();
    window.key("escape").unwrap();
    program.wait_for("released Escape");
    let expected = [
        "key Control_L",
        "key Shift_L ctrl",
        "key P ctrl shift",
        "released P ctrl shift",
        "released Shift_L ctrl shift",
        "released Control_L ctrl",
        "key Escape",
        "released Escape",
    ];
    assert_eq!(program.recorded(), expected);
}

#[test]
fn a_key_that_is_held_repeats() {
    let Some((_display, program, window)) = shown([64, 64]) else { return };
    let start = Instant::now();
    window.hold("w", Duration::from_millis(1200)).unwrap();
    assert!(start.elapsed() >= Duration::from_millis(1200), "{:?}", start.elapsed());
    program.wait_for("released w");
    let presses = program.recorded().iter().filter(|event| *event == "key w").count();
    assert!(presses > 3, "{presses} times");
}

#[test]
fn the_mouse_goes_and_presses_where_it_is_told() {
    let Some((_display, program, window)) = shown([200, 100]) else { return };
    window.click(20, 30).unwrap();
    window.double_click(21, 31).unwrap();
    window.drag((100, 50), (40, 90), 3, Button::Right).unwrap();
    window.click_with(5, 6, Button::Middle).unwrap();
    window.scroll(7, 8, 2).unwrap();
    window.scroll(7, 8, -1).unwrap();
    program.wait_for("button 5 released at 7, 8");
    let pressed_and_released = |button: u8, x: i16, y: i16| {
        ["", "released "].map(|what| format!("button {button} {what}at {x}, {y}"))
    };
    let mut expected = vec!["moved to 20, 30".to_owned()];
    expected.extend(pressed_and_released(1, 20, 30));
    expected.push("moved to 21, 31".into());
    expected.extend([(); 2].into_iter().flat_map(|()| pressed_and_released(1, 21, 31)));
    expected.extend(["moved to 100, 50", "button 3 at 100, 50"].map(Into::into));
    expected.extend(["moved to 80, 63", "moved to 60, 76", "moved to 40, 90"].map(Into::into));
    expected.extend(["button 3 released at 40, 90", "moved to 5, 6"].map(Into::into));
    expected.extend(pressed_and_released(2, 5, 6));
    expected.push("moved to 7, 8".into());
    expected.extend([4, 4, 5].into_iter().flat_map(|button| pressed_and_released(button, 7, 8)));
    assert_eq!(program.recorded(), expected);
}

#[test]
fn a_screenshot_is_what_the_window_shows() {
    let Some((_display, _program, window)) = shown([60, 40]) else { return };
    let red = window.wait_until(SOON, |image| rgb(image, 59, 39) == RED).unwrap();
    assert_eq!((red.width(), red.height()), (60, 40));
    // The program draws a blue corner, and turns green where a button is pressed.
    assert_eq!([rgb(&red, 0, 0), rgb(&red, 9, 9), rgb(&red, 10, 10)], [BLUE, BLUE, RED]);
    window.click(50, 30).unwrap();
    let green = window.wait_until(SOON, |image| rgb(image, 59, 39) == GREEN).unwrap();
    assert!(green.pixels().iter().all(|pixel| pixel[3] == 1.0));
    assert_eq!(rgb(&green, 0, 0), BLUE);

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("green.png");
    green.write(&path, metrics::Display::AS_IS, None).unwrap();
    assert_eq!(Image::read(&path).unwrap(), green);
}

#[test]
fn a_window_takes_another_size_and_closes() {
    let Some((_display, program, window)) = shown([60, 40]) else { return };
    window.resize(320, 200).unwrap();
    assert_eq!(window.size().unwrap(), [320, 200]);
    assert_eq!(window.wait_until(SOON, |image| rgb(image, 319, 199) == RED).unwrap().width(), 320);
    window.resize(641, 200).unwrap();
    let error = window.screenshot().unwrap_err();
    assert!(error.to_string().contains("([641, 200] pixels at [0, 0]) reaches outside"), "{error}");

    window.close().unwrap();
    program.wait_for("closed");
    program.end();
    let error = window.screenshot().unwrap_err();
    assert!(matches!(error, Error::Refused(_)), "{error}");
}

#[test]
fn what_is_not_there_is_said() {
    let Some((display, _program, window)) = shown([64, 64]) else { return };
    let error = display.wait_for_window("Another", Duration::ZERO).unwrap_err();
    assert!(error.to_string().ends_with("there are: A recorder"), "{error}");
    let error = window.type_text("a→b").unwrap_err();
    assert!(error.to_string().starts_with("the keyboard has no key `→`"), "{error}");

    let Err(Error::NotSeen { screenshot, .. }) = window.wait_until(Duration::ZERO, |_| false) else {
        panic!("expected a screenshot")
    };
    assert_eq!(Image::read(&screenshot).unwrap().width(), 64);
    std::fs::remove_file(screenshot).unwrap();
}

#[test]
fn displays_are_apart_and_end() {
    let (Some(a), Some(b)) = (Display::start(), Display::start()) else { return };
    assert_ne!(a.env().1, b.env().1);
    let _program = Program::show(a.env().1, "On a", [64, 64]);
    a.wait_for_window("On a", SOON).unwrap();
    assert!(
        matches!(b.wait_for_window("On a", Duration::ZERO), Err(Error::NoWindow { titles, .. }) if titles.is_empty())
    );

    let name = b.env().1.to_owned();
    assert!(x11rb::connect(Some(&name)).is_ok());
    drop(b);
    assert!(x11rb::connect(Some(&name)).is_err());
}
