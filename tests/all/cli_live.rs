//! `afmsweep live` as a user calls it. Truth: the scenes themselves; the page is tried in a browser by `make live-check`.

use crate::program::{Desk, scenes};
use afmsweep::Scene;
use afmsweep::scene::SweptAxes;
use serde_json::Value;
use std::path::Path;

/// What the page begins with.
fn start(page: &str) -> Value {
    let text = page.split("id=\"start\">").nth(1).unwrap().split("</script>").next().unwrap();
    serde_json::from_str(text).unwrap()
}

/// Of every example: instrument, sample, contact, drive and approach are those of its first instance, to the bit.
#[test]
fn pages_begin_with_the_first_instance_of_each_example() {
    let desk = Desk::new();
    // Packed or not, the program only puts it in.
    std::fs::write(desk.path("engine.wasm.gz"), [0x1f, 0x8b, 1, 2, 3]).unwrap();
    for path in scenes() {
        let name = path.to_str().unwrap();
        desk.works(&["live", name, "--engine", "engine.wasm.gz", "-o", "page.html", "-q"]);
        let page = std::fs::read_to_string(desk.path("page.html")).unwrap();
        assert!(page.contains("H4sBAgM="), "{name}: the engine is not in it");
        let start = start(&page);
        let base = toml::to_string(&start["base"]).unwrap();
        let read =
            Scene::parse(Path::new("page.toml"), &base).unwrap_or_else(|error| panic!("{name}: {error}"));
        let scene = Scene::load(&path).unwrap();
        let mut first = scene.clone();
        (first.base, first.sweep) = (scene.instance(0), SweptAxes::default());
        assert_eq!(start["title"], scene.title.as_str(), "{name}");
        assert!(read.base == first.base, "{name}:\n{base}");
        assert_eq!(read.run.accuracy, scene.run.accuracy, "{name}");
    }
}

#[test]
fn what_is_missing_is_told() {
    let desk = Desk::new();
    std::fs::write(desk.path("engine.txt"), "no engine").unwrap();
    for (arguments, words) in [
        (&["live"][..], "run `make live`"),
        (&["live", "--engine", "engine.txt"], "engine.txt is no engine for pages"),
        (&["live", "--engine", "nowhere.gz"], "cannot read nowhere.gz"),
        (&["live", "nowhere.toml", "--engine", "engine.txt"], "nowhere.toml"),
    ] {
        let answer = desk.call(arguments);
        assert_eq!(answer.code, Some(1), "{arguments:?}");
        assert!(answer.err.contains(words), "{arguments:?}: {}", answer.err);
        assert!(!desk.path("live.html").exists());
    }
}
