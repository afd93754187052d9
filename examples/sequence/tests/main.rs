//! The program as a process; the tests of the whole program run it as a row of a study.

use std::process::Command;

#[test]
fn a_camera_that_is_not_there_is_named() {
    let done = Command::new(env!("CARGO_BIN_EXE_sequence"))
        .args(["scene-0000.glb", "nowhere-0000.json", "out-0000.exr"])
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&done.stderr);
    assert!(!done.status.success() && errors.contains("nowhere-0000.json"), "{errors}");
}
