//! What a results file of very many instances is beside its numbers: no text grows with them.

use afmsweep::Scene;
use afmsweep::engine::ResultColumns;
use afmsweep::plan::{Plan, Precision};
use afmsweep::record::{self, Facts};
use afmsweep::store::{Attribute, Results};
use std::path::Path;

/// Results of a design or a table of so many points, none of which was run.
fn results(scene: &Scene) -> Results {
    let plan = Plan::new(scene, Precision::F64).expect("the scene can be planned");
    let facts = Facts {
        device: String::new(),
        wall_time: 0.0,
        steps_taken: 0,
        rate: 0.0,
        neighbour_started: 0.0,
        plan: plan.summary(None).json().to_string(),
        command_line: String::new(),
        arithmetic: afmsweep::control::Arithmetic::of(&plan, "none ran"),
    };
    record::results(scene, &plan, &ResultColumns::not_run(plan.len()), &facts).expect("it lies in memory")
}

/// Characters of all its texts.
fn texts(results: &Results) -> usize {
    let attributes = results.attributes.iter().map(|(_, value)| match value {
        Attribute::Text(text) => text.len(),
        Attribute::Number(_) => 0,
    });
    attributes.sum::<usize>() + results.provenance.iter().map(|(_, text)| text.len()).sum::<usize>()
}

const LEVER: &str = r#"
[instrument.cantilever]
modes = [{ stiffness = "40 N/m", frequency = "300 kHz", quality_factor = 30 }]
[contact]
law = "hertz"
[drive]
on = "tip"
frequency = "300 kHz"
force = "20 nN"
[approach]
gap = "13 nm"
"#;

/// The bytes of the file are held to 1.2 times those of its numbers; truth of that is their count.
#[test]
fn points_of_a_design_are_numbers_and_never_texts() {
    let folder = tempfile::tempdir().expect("there is room");
    let design = |count: usize| {
        let text = format!(
            "{LEVER}[uncertain]\n\"sample.youngs_modulus\" = {{ distribution = \"uniform\", from = \"1 GPa\", to = \"5 GPa\" }}\n\
             \"instrument.tip.radius\" = {{ distribution = \"uniform\", from = \"5 nm\", to = \"20 nm\" }}\n\
             [design]\nkind = \"latin-hypercube\"\nsamples = {count}\n"
        );
        Scene::parse(Path::new("design.toml"), &text).expect("the scene is whole")
    };
    let table = |count: usize| {
        let rows: Vec<String> = (0..count).map(|n| format!("{},{}", 1.0 + n as f64 * 1e-5, 10.0)).collect();
        let rows = format!("sample.youngs_modulus [GPa],instrument.tip.radius [nm]\n{}\n", rows.join("\n"));
        std::fs::write(folder.path().join("rows.csv"), rows).expect("there is room");
        let text = format!("{LEVER}[samples]\nfile = \"rows.csv\"\n");
        Scene::parse(&folder.path().join("table.toml"), &text).expect("the scene is whole")
    };
    for scene in [&design as &dyn Fn(usize) -> Scene, &table] {
        let few = texts(&results(&scene(100)));
        let many = results(&scene(20_000));
        assert!(texts(&many) < few + 200, "{few} {}", texts(&many));
        let path = folder.path().join("a.h5");
        many.write(&path, true).expect("there is room");
        let size = std::fs::metadata(&path).expect("it is there").len();
        let columns = many.axes.len() + many.variables.len() + 1;
        let bytes = 20_000 * (8 * columns + 4 + 1 + many.flags.len());
        assert!((size as f64) < 1.2 * bytes as f64, "{size} {bytes}");
    }
}
