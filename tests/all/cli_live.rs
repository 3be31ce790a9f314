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
    std::fs::write(desk.path("engine.wasm.zst"), [0x28, 0xb5, 0x2f, 0xfd, 3]).unwrap();
    for path in scenes() {
        let name = path.to_str().unwrap();
        desk.works(&["live", name, "--engine", "engine.wasm.zst", "-o", "page.html", "-q"]);
        let page = std::fs::read_to_string(desk.path("page.html")).unwrap();
        assert!(page.contains("KLUv/QM="), "{name}: the engine is not in it");
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
        let radius = &start["base"]["instrument"]["tip"]["radius"];
        assert_eq!(!radius.is_null(), first.base.instrument.tip.shape.has_radius(), "{name}");
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

/// A stiff lever on a soft sample, free of what varies.
const LEVER: &str = "[instrument.cantilever]\nstiffness = \"26 N/m\"\nfrequency = \"300 kHz\"\nquality_factor = 100\n\
    [drive]\non = \"tip\"\nfrequency = \"resonance\"\nfree_amplitude = \"20 nm\"\n\
    [contact]\nlaw = \"hertz\"\n[run]\nsteady = \"search\"\naccuracy = 1e-2\n";

/// Of each kind of sweep. Truth: the scene; the page's numbers are compared with the results in crates/report.
#[test]
fn lists_and_grids_of_three_axes_have_a_page_to_explore_them() {
    let desk = Desk::new();
    std::fs::write(desk.path("engine.wasm.zst"), [0x28, 0xb5, 0x2f, 0xfd, 3]).unwrap();
    let gap = "\"approach.gap\" = { values = [\"16 nm\", \"18 nm\"] }\n";
    let modulus = "\"sample.youngs_modulus\" = { values = [\"1 GPa\", \"2 GPa\", \"3 GPa\"] }\n";
    let radius = "\"instrument.tip.radius\" = { values = [\"10 nm\", \"20 nm\"] }\n";
    let rows = "[samples]\n\"sample.youngs_modulus\" = [\"1 GPa\", \"2 GPa\", \"3 GPa\", \"4 GPa\"]\n";
    let curve = "[curve]\nquantity = \"approach.gap\"\nfrom = \"21 nm\"\nto = \"16 nm\"\npoints = 3\ndirection = \"both\"\n";
    for (name, sweep, count, axes) in [
        ("grid", format!("[sweep]\n{gap}{modulus}{radius}"), 12, 3),
        ("curve", format!("[sweep]\n{modulus}{curve}"), 18, 3),
        ("list", format!("[approach]\ngap = \"16 nm\"\n{rows}"), 4, 1),
        ("map", format!("[sweep]\n{gap}{modulus}"), 6, 2),
    ] {
        let path = desk.write(&format!("{name}.toml"), &format!("{LEVER}{sweep}"));
        desk.run(&path, &[]);
        let file = format!("results/{name}.h5");
        let told = |arguments: &[&str]| -> Value {
            let all = [&["report", file.as_str(), "--json", "-q"], arguments].concat();
            serde_json::from_str(&desk.works(&all).out).unwrap()
        };
        let page = |place: &str| std::fs::read_to_string(desk.path(&format!("results/{name}/{place}")));
        let wanted = name != "map";
        assert_eq!(told(&[])["explore"], if wanted { "explore.html".into() } else { Value::Null }, "{name}");
        assert_eq!(page("index.html").unwrap().contains("href=\"explore.html\""), wanted, "{name}");
        if !wanted {
            assert!(page("explore.html").is_err());
            continue;
        }
        let plain = start(&page("explore.html").unwrap());
        assert_eq!((plain["count"].as_u64(), &plain["live"]), (Some(count), &Value::Null), "{name}");
        assert_eq!(plain["axes"].as_array().unwrap().len(), axes, "{name}");
        // What lies outside a reader's limits has no status of the file.
        told(&["--below", "force_max=1fN"]);
        let limited = start(&page("explore.html").unwrap());
        assert_eq!(limited["words"]["254"]["word"], "outside the limits asked for", "{name}");
        told(&["--engine", "engine.wasm.zst"]);
        let with_engine = page("explore.html").unwrap();
        assert!(with_engine.contains("KLUv/QM="), "{name}: the engine is not in it");
        let base = start(&with_engine)["live"]["base"].clone();
        assert_eq!(base["contact"]["law"], "hertz", "{name}");
        assert!(base.get("sweep").is_none() && base.get("curve").is_none(), "{name}: {base}");
    }
    desk.refuses(
        &["report", "results/grid.h5", "--engine", "grid.toml"],
        &["grid.toml is no engine for pages"],
    );
}
