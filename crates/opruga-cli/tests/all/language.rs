//! `--language hr`: errors and warnings for people in Croatian, JSON in English.

use crate::common;
use common::*;
use serde_json::Value;

#[test]
fn what_is_wrong_with_a_mesh_is_told_in_croatian_and_as_json_in_english() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("a.msh"), "$MeshFormat\n3.0 0 8\n$EndMeshFormat\n").expect("a file");
    let call = |more: &[&str]| opruga(folder.path(), &[&["mesh", "a.msh"], more].concat());
    let croatian = call(&["--language", "hr"]);
    let told = said(&croatian);
    for part in [
        "a.msh:2:1: greška[msh.version]: inačica `3.0` ne može se pročitati",
        "  = dopušteno: 2.2 ili 4.1",
        "  = savjet: Gmsh piše drugu inačicu",
    ] {
        assert!(told.contains(part), "{part}: {told}");
    }
    let english = call(&[]);
    assert!(
        said(&english).contains("a.msh:2:1: error[msh.version]: version `3.0` cannot be read"),
        "{}",
        said(&english)
    );
    assert_eq!((code(&croatian), code(&english)), (2, 2));
    let error: Value = serde_json::from_str(&said(&call(&["--language", "hr", "--json"]))).expect("JSON");
    assert_eq!((&error["message"], &error["allowed"]), (&"version `3.0` cannot be read".into(), &"2.2 or 4.1".into()));
}

#[test]
fn what_a_world_warns_of_is_told_in_croatian() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = opruga::scenes::find("ball").expect("a scene").replace("center = [0.0, 2.0]", "center = [0.0, 0.2]");
    std::fs::write(folder.path().join("s.toml"), scene).expect("a file");
    let told = said(&opruga(folder.path(), &["check", "s.toml", "--language", "hr"]));
    let printed = printed(&opruga(folder.path(), &["check", "s.toml", "--language", "hr"]));
    let all = format!("{told}{printed}");
    assert!(all.contains("upozorenje[contact.starts_inside]: tijelo `ball` počinje u prepreci 0"), "{all}");
}

#[test]
fn what_is_odd_about_a_call_is_told_in_croatian_and_in_the_summary_in_english() {
    let folder = tempfile::tempdir().expect("a folder");
    let calls = ["run", "ball", "--seconds=0.05", "--threads=256", "--no-pictures", "--language=hr", "--out=o"];
    let told = program(folder.path(), &calls).env("OPRUGA_SIMD", "scalar").output().expect("it runs");
    for part in
        ["upozorenje[simd.other]: OPRUGA_SIMD=scalar: računa se s ", "upozorenje[threads.above_cores]: dretvi: 256, "]
    {
        assert!(cfg!(not(target_arch = "x86_64")) || said(&told).contains(part), "{part}: {}", said(&told));
    }
    let summary = std::fs::read_to_string(folder.path().join("o/summary.json")).expect("a summary");
    assert!(summary.contains("256 threads on "), "{summary}");
    let told = said(&opruga(folder.path(), &["run", "--resume", "nothing", "--language=hr"]));
    assert!(
        told.contains("  = savjet: računanje je ostavlja u mapi svojeg izlaza, na primjer out/ball/checkpoint"),
        "{told}"
    );
}
