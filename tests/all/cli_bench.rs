//! `afmsweep bench` as a user calls it: that it measures and keeps what it says, not how fast this machine is.

use crate::program::Desk;

const SMALL: &str = r#"
[instrument.cantilever]
modes = [{ stiffness = "40 N/m", frequency = "300 kHz", quality_factor = 20 }]
[instrument.actuator]
model = "rigid"
[contact]
law = "dmt"
[drive]
on = "tip"
frequency = "300 kHz"
free_amplitude = "20 nm"
[approach]
gap = "14 nm"
[sweep]
"sample.youngs_modulus" = { from = "1 GPa", to = "2 GPa", points = 3 }
[run]
periods = 60
measure = 10
"#;

const FILES: [&str; 4] = ["README.md", "index.html", "speed.svg", "bench.csv"];

#[test]
fn a_bench_leaves_its_page_its_picture_and_its_numbers() {
    let desk = Desk::new();
    let path = desk.write("small.toml", SMALL);
    let arguments =
        ["bench", path.to_str().unwrap(), "--backend", "cpu", "--sizes", "8,64", "--seconds", "0.01"];
    let more = ["--compared", "2", "-o", "out", "--json", "-q"];
    let json = desk.json(&[&arguments[..], &more[..]].concat());
    let series = json["series"].as_array().unwrap();
    assert_eq!(series.len(), 2);
    for one in series {
        assert_eq!(one["backend"], "cpu");
        let error = one["error"]["largest"].as_f64().unwrap();
        assert!(0.0 < error && error < 1e-3, "{error}");
        assert_eq!(one["error"]["tried"], 2);
        let points = one["points"].as_array().unwrap();
        assert_eq!(
            points.iter().map(|point| point["instances"].as_u64().unwrap()).collect::<Vec<_>>(),
            [8, 64]
        );
        assert!(points.iter().all(|point| point["instance_steps_per_second"].as_f64().unwrap() > 0.0));
    }
    for name in FILES {
        assert!(desk.path("out").join(name).is_file(), "{name}");
    }
    let page = std::fs::read_to_string(desk.path("out/README.md")).unwrap();
    for word in ["cpu f32", "cpu f64", "64 instances", "median error", "afmsweep bench small.toml"] {
        assert!(page.contains(word), "{word}: {page}");
    }
    assert_eq!(std::fs::read_to_string(desk.path("out/bench.csv")).unwrap().lines().count(), 5);
    // Its own folder is written again; another's is left alone.
    desk.works(&[&arguments[..], &more[..4], &["-q"]].concat());
    desk.write("notes.txt", "mine");
    let said = desk.call(&[&arguments[..], &["-o", "."]].concat());
    assert_eq!(said.code, Some(1), "{}", said.err);
    assert!(said.err.contains("-o names another"), "{}", said.err);
}

#[test]
fn misuse_is_told_before_anything_is_measured() {
    let desk = Desk::new();
    let free = SMALL.replace("law = \"dmt\"", "law = \"none\"");
    let path = desk.write("free.toml", &free);
    desk.refuses(&["bench", path.to_str().unwrap(), "--backend", "cpu", "-q"], &["nothing to step"]);
    let single = SMALL.split("[sweep]").next().unwrap().to_owned() + "[run]\nperiods = 60\nmeasure = 10\n";
    let path = desk.write("single.toml", &single);
    let said = desk.call(&["bench", path.to_str().unwrap(), "--backend", "cpu", "--compared", "1", "-q"]);
    assert_eq!(said.code, Some(1));
    assert!(said.err.contains("no axis under [sweep]"), "{}", said.err);
    for wrong in [["--seconds", "0"], ["--sizes", "0"], ["--backend", "fpga"]] {
        assert_eq!(desk.call(&[&["bench"], &wrong[..]].concat()).code, Some(2), "{wrong:?}");
    }
}
