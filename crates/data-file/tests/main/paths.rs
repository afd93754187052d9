//! Which files a file may name.

use data_file::paths::{beside, is_from_own_folder, may_name};
use std::path::{Path, PathBuf};

#[test]
fn a_file_names_files_of_its_folder_of_the_working_folder_and_of_the_roots() {
    let roots = [PathBuf::from("/trees/lightloom")];
    let may = |by: &str, path: &str| may_name(Path::new(by), Path::new(path), &roots);
    let here = std::env::current_dir().expect("a working folder");
    let inside = here.join("deep/../x.wgsl");
    let good = [
        ("/files/u/a.ron", "/files/u/b.ron"),
        ("/files/u/a.ron", "/files/u/parts/b.ron"),
        ("/files/u/a.ron", "/files/u/parts/../b.ron"),
        ("/files/u/a.ron", "/trees/lightloom/shaders/b.wgsl"),
        ("/files/u/a.ron", "parts/b.ron"),
        ("/files/u/a.ron", "ism"),
        ("/files/u/a.ron", inside.to_str().expect("UTF-8")),
        ("pipelines/a.ron", "./b.ron"),
        ("a.ron", "c/../b.ron"),
    ];
    for (by, path) in good {
        assert!(may(by, path), "{path} in {by}");
    }
    let bad = [
        ("/files/u/a.ron", "/etc/passwd"),
        ("/files/u/a.ron", "/files/user/b.ron"),
        ("/files/u/a.ron", "/files/u/../b.ron"),
        ("/files/u/a.ron", "/files/u/parts/../../b.ron"),
        ("/files/u/a.ron", "/trees/lightloom/../other/b.ron"),
        ("/files/u/a.ron", "/trees/lightloom-2/b.ron"),
        ("/files/u/a.ron", "../../../../../../../../../../etc/passwd"),
        ("pipelines/a.ron", "../b.ron"),
        ("a.ron", "c/../../b.ron"),
    ];
    for (by, path) in bad {
        assert!(!may(by, path), "{path} in {by}");
    }
    assert!(!may_name(Path::new("/files/u/a.ron"), Path::new("/trees/lightloom/b.ron"), &[]));
    assert!(
        may_name(Path::new("/files/u/a.ron"), Path::new("x"), &[PathBuf::new()]),
        "no folder is this one"
    );
}

#[cfg(unix)]
#[test]
fn links_lead_where_the_user_made_them_lead() {
    let folder = std::env::temp_dir().join(format!("lightloom-paths-{}", std::process::id()));
    let at = |name: &str| folder.join(name);
    std::fs::create_dir_all(at("real/inner")).expect("folders");
    std::fs::write(at("real/inner/b.ron"), "").expect("a file");
    std::os::unix::fs::symlink(at("real"), at("other")).expect("a link");
    let may = |by: &str, path: &str| may_name(&at(by), &at(path), &[]);
    assert!(may("real/a.ron", "other/inner/b.ron"), "it is the same folder by another name");
    assert!(!may("real/inner/a.ron", "other/a.ron"), "the folder around it is not");
    std::os::unix::fs::symlink("/etc", at("real/etc")).expect("a link");
    assert!(!may("real/a.ron", "real/etc/passwd"), "what a link leads to is not in the folder of the link");
    assert!(!may_name(&at("x/a.ron"), &at("real/etc/passwd"), &[at("real")]), "nor in the root");
    std::fs::remove_dir_all(folder).expect("removed");
}

#[test]
fn a_name_is_from_the_folder_of_the_file_that_names_it() {
    let cases = [
        ("pipelines/a.ron", "parts/b.ron", Some("pipelines/parts/b.ron")),
        ("pipelines/a.ron", "./b.ron", Some("pipelines/b.ron")),
        ("pipelines/a.ron", "../shaders/b.wgsl", Some("shaders/b.wgsl")),
        ("a.ron", "b.ron", Some("b.ron")),
        ("/files/u/a.ron", "../b.ron", Some("/files/b.ron")),
        ("/a.ron", "b.ron", Some("/b.ron")),
        ("/files/u/a.ron", "/b.ron", None),
    ];
    for (by, path, expected) in cases {
        assert_eq!(beside(by, path).as_deref(), expected, "{path} in {by}");
    }
    let above = beside("../other/a.ron", "b.wgsl").expect("it is relative");
    assert!(Path::new(&above).is_absolute() && above.ends_with("/other/b.wgsl"), "{above}");
    assert!(is_from_own_folder("./a") && is_from_own_folder("a/../b") && !is_from_own_folder("a/b.ron"));
}
