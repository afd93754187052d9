//! The example, seen through its window.

use metrics::Image;
use renderer::Gpu;
use std::path::Path;
use std::process::{Child, Command, ExitStatus};
use std::time::{Duration, Instant};
use window_test::Display;

/// Shaders are compiled and frames rendered on the CPU, and other tests may run.
const SOON: Duration = Duration::from_secs(300);

/// A program that ends with the test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Running {
    fn ended(&mut self) -> ExitStatus {
        let start = Instant::now();
        loop {
            if let Some(status) = self.0.try_wait().unwrap() {
                return status;
            }
            assert!(start.elapsed() < SOON, "it does not end");
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

/// Returns the share of the picture between two parts of its width that satisfies this.
fn share(image: &Image, from: f64, to: f64, is: impl Fn([f32; 4]) -> bool) -> f64 {
    let width = image.width() as f64;
    let columns = (width * from) as usize..(width * to) as usize;
    let rows = image.pixels().chunks(image.width()).map(|row| &row[columns.clone()]);
    let count = rows.flatten().filter(|pixel| is(**pixel)).count();
    count as f64 / (columns.len() * image.height()) as f64
}

/// Whether the red wall is seen on the left, the green one on the right, and the triangle in its corner.
fn shows_all(image: &Image) -> bool {
    let red = share(image, 0.0, 0.4, |[r, g, b, _]| r > 0.02 && r > 2.0 * g && r > 2.0 * b);
    let green = share(image, 0.6, 1.0, |[r, g, b, _]| g > 1.2 * r && g > 1.2 * b);
    // Encoded in sRGB it is (1, 0.8, 0.1).
    let yellow = |[r, g, b, _]: [f32; 4]| r == 1.0 && (0.55..0.65).contains(&g) && b < 0.05;
    let triangle = [share(image, 0.75, 1.0, yellow), share(image, 0.0, 0.75, yellow)];
    red > 0.1 && green > 0.1 && triangle[0] > 0.02 && triangle[1] == 0.0
}

#[test]
fn the_box_and_what_the_program_draws_over_it_are_seen() {
    if Gpu::adapters().is_empty() {
        eprintln!("skipped: no graphics adapter");
        return;
    }
    let Some(display) = Display::start() else { return };
    let mut command = Command::new(env!("CARGO_BIN_EXE_embed"));
    let mut program = Running(command.envs([display.env()]).env_remove("WAYLAND_DISPLAY").spawn().unwrap());
    let mut window = display.wait_for_window("Lightloom, embedded", SOON).unwrap();
    // The right part of the second lies outside the first, so that it is seen only if the renderer follows.
    for (width, height) in [(320, 320), (480, 240)] {
        window.resize(width, height);
        let seen = window.wait_until(SOON, shows_all).unwrap();
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("embed-{width}x{height}.png"));
        seen.write(path, metrics::Display::AS_IS, None).unwrap();
    }
    window.key("Escape");
    assert!(program.ended().success());
}
