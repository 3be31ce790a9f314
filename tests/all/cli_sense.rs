//! What a scene leaves unsaid, and what makes no sense: whether the program says so, and where.
//! Truth: the text of the scene itself, and what `plan` and `run` take to be theirs of it.

use crate::program::{Desk, scene};
use afmsweep::engine::{Cpu, Engine, EngineError, Outcome, Progress, estimate};
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::{ActuatorModel, Address, Scene};
use afmsweep::store;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A calibrated lever on the base that it stands on, tapping.
const CALIBRATED: &str = r#"
[instrument.cantilever]
stiffness = "40 N/m"
frequency = "300 kHz"
quality_factor = 20
[sample]
poisson_ratio = 0.3
surface_energy = "20 mJ/m^2"
[contact]
law = "hertz"
[drive]
frequency = "resonance"
free_amplitude = "20 nm"
[approach]
gap = "15 nm"
[run]
periods = 60
measure = 4
[output]
observables = ["amplitude"]
"#;

fn parse(text: &str) -> Scene {
    Scene::parse(Path::new("test.toml"), text).unwrap()
}

/// USERS 0.4: such a lever stood on the paper's undamped quartz rod without a word.
#[test]
fn a_calibrated_lever_has_a_rod_only_where_the_scene_names_one() {
    let model = |text: &str| parse(text).base.instrument.actuator.model;
    assert_eq!(model(CALIBRATED), ActuatorModel::Rigid);
    let listed = "[instrument.cantilever]\nmodes = [{ stiffness = \"40 N/m\", frequency = \"300 kHz\" }]\n\
                  [drive]\non = \"tip\"\nforce = \"1 nN\"\n";
    assert_eq!(model(listed), ActuatorModel::Rigid);
    let swept = "[instrument.cantilever]\nfrequency = \"300 kHz\"\n[drive]\nbase_amplitude = \"1 nm\"\n[sweep]\n\
                 \"instrument.cantilever.stiffness\" = { values = [\"40 N/m\", \"42 N/m\"] }";
    assert_eq!(model(swept), ActuatorModel::Rigid);
    for rod in [
        "instrument.preset = \"ha-fung-chen-2005\"\n",
        "instrument.actuator.model = \"coupled\"\n",
        "instrument.actuator.quality_factor = 100\n",
        "sweep.\"instrument.actuator.length\" = { values = [\"3 mm\", \"4 mm\"] }\n",
    ] {
        assert_eq!(model(&format!("{rod}{CALIBRATED}")), ActuatorModel::Coupled, "{rod}");
    }
    // The lever of the preset stands on the preset's rod.
    assert_eq!(model("title = \"a\""), ActuatorModel::Coupled);
    let again = parse(&parse(CALIBRATED).resolved_toml());
    assert_eq!(again.base, parse(CALIBRATED).base);
}

#[test]
fn run_and_plan_and_the_file_tell_what_came_from_the_preset() {
    let desk = Desk::new();
    desk.write("lever.toml", CALIBRATED);
    let line = "from the preset ha-fung-chen-2005: instrument.tip.radius 30 nm, instrument.tip.youngs_modulus inf, \
                sample.youngs_modulus 100 kPa";
    let lines = |text: &str| text.lines().filter(|line| line.contains("the preset")).count();
    let plan = desk.works(&["plan", "lever.toml"]);
    assert!(plan.out.contains(line) && lines(&plan.out) == 1, "{}", plan.out);
    let run = desk.works(&["run", "lever.toml", "-o", "lever.h5"]);
    assert!(run.err.contains(line) && lines(&run.err) == 1, "{}", run.err);
    let paths = "instrument.tip.radius instrument.tip.youngs_modulus sample.youngs_modulus";
    let file = store::read(&desk.path("lever.h5")).unwrap();
    assert_eq!(file.text("from_preset"), Some(paths));
    let json = desk.json(&["plan", "lever.toml", "--json"]);
    assert_eq!(json["from_preset"].as_array().unwrap().len(), 3);

    // A rod that nobody described is told as one.
    desk.write("rod.toml", "[instrument]\npreset = \"ha-fung-chen-2005\"\n[contact]\nlaw = \"hertz\"\n");
    let rod = desk.works(&["plan", "rod.toml"]);
    assert!(
        rod.out.contains(
            "7 values of the rod, instrument.actuator.quality_factor inf, 5 values of the lever, \
         instrument.cantilever.quality_factor inf, 4 values of the tip's shape, instrument.tip.radius 30 nm"
        ),
        "{}",
        rod.out
    );

    let all = CALIBRATED.replace(
        "[sample]\n",
        "[instrument.tip]\nradius = \"10 nm\"\nyoungs_modulus = inf\n[sample]\nyoungs_modulus = \"1 GPa\"\n",
    );
    let all = all.replace("inf\n", "\"inf Pa\"\n");
    desk.write("all.toml", &all);
    assert!(!desk.works(&["plan", "all.toml"]).out.contains("the preset"));
    desk.works(&["run", "all.toml", "-o", "all.h5", "-q"]);
    assert_eq!(store::read(&desk.path("all.h5")).unwrap().text("from_preset"), Some("none"));
}

/// USERS 0.3: the front page's own scene was one of them.
#[test]
fn an_undamped_rod_is_told_of_wherever_steady_motion_is_asked_for() {
    let desk = Desk::new();
    const WORDS: &str = "an undamped rod never settles";
    let tapping = "[instrument.cantilever]\nquality_factor = 30\n[contact]\nlaw = \"hertz\"\n[drive]\nfrequency = \
                   \"resonance\"\nfree_amplitude = \"20 nm\"\n[approach]\ngap = \"19 nm\"\n[run]\nperiods = 20\nmeasure = 4\n";
    desk.write("undamped.toml", tapping);
    assert!(desk.works(&["plan", "undamped.toml"]).out.contains(WORDS));
    assert!(desk.works(&["run", "undamped.toml", "--no-audit"]).err.contains(WORDS));
    for calm in [
        "instrument.actuator.quality_factor = 100\n",
        "instrument.actuator.model = \"rigid\"\n",
        "instrument.actuator.model = \"prescribed\"\n",
    ] {
        assert!(parse(&format!("{calm}{tapping}")).warnings().is_empty(), "{calm}");
    }
    // A start from rest is not meant to settle.
    assert!(parse("[run]\nstart = \"rest\"").warnings().is_empty());
    assert!(Scene::load(scene("quickstart.toml").as_ref()).unwrap().warnings().is_empty());
}

/// TRUST D11: sizes of no instrument were taken without a word.
#[test]
fn sizes_beyond_what_is_usual_are_told_with_their_place() {
    for (section, entry, place, words) in [
        ("instrument.tip", "radius = \"10 mm\"", "2:1", "100 pm to 1 mm"),
        ("sample", "poisson_ratio = -0.999999999999", "2:1", "at most 0.5"),
        ("approach", "gap = \"-10 mm\"", "2:1", "at most 1 mm"),
        ("sweep", "\"sample.youngs_modulus\" = { values = [\"1 GPa\", \"1e13 Pa\"] }", "2:1", "to 2 TPa"),
    ] {
        let scene = parse(&format!("[{section}]\n{entry}\n[instrument.actuator]\nmodel = \"prescribed\"\n"));
        let warnings = scene.warnings();
        assert_eq!(warnings.len(), 1, "{entry}: {warnings:?}");
        let line = &warnings[0];
        assert!(line.starts_with(&format!("test.toml:{place}: ")) && line.contains(words), "{entry}: {line}");
    }
    let desk = Desk::new();
    desk.write("deep.toml", &CALIBRATED.replace("\"15 nm\"", "\"-10 mm\""));
    let said = desk.works(&["plan", "deep.toml"]);
    assert!(said.out.contains("warning: deep.toml:15:1: approach.gap = -10 mm is beyond"), "{}", said.out);
}

/// Seconds passed before the first line. Truth: the number of levers in the scene.
#[test]
fn a_plan_of_many_levers_is_told_before_it_begins() {
    let desk = Desk::new();
    let levers = |count: usize| {
        format!(
            "[instrument]\npreset = \"ha-fung-chen-2005\"\n[instrument.actuator]\nmodel = \"rigid\"\n\
             [instrument.cantilever]\nquality_factor = 100\n[contact]\nlaw = \"none\"\n[drive]\non = \"tip\"\n\
             frequency = \"resonance\"\nfree_amplitude = \"20 nm\"\n[sweep]\n\
             \"instrument.cantilever.length\" = {{ from = \"240 um\", to = \"241 um\", points = {count} }}\n"
        )
    };
    desk.write("many.toml", &levers(10_000));
    desk.write("few.toml", &levers(20));
    let line = "planning 10000 instances with 10000 rods or levers ...\n";
    assert!(desk.works(&["plan", "many.toml"]).err.starts_with(line));
    assert!(!desk.works(&["plan", "many.toml", "-q"]).err.contains("planning"));
    assert!(!desk.works(&["plan", "few.toml"]).err.contains("planning"));
}

/// What is common in a microscope, taken 1e9 times: `stiffness = "26 N/nm"` ran with a warning alone.
#[test]
fn a_slip_of_nine_powers_is_refused() {
    let common = [
        ("actuator.youngs_modulus", 2e10),
        ("actuator.density", 2650.0),
        ("actuator.h33", 5e8),
        ("actuator.beta33", 8e7),
        ("actuator.length", 4e-3),
        ("actuator.width", 4e-5),
        ("actuator.thickness", 7e-6),
        ("cantilever.youngs_modulus", 1.69e11),
        ("cantilever.density", 2330.0),
        ("cantilever.length", 1.25e-4),
        ("cantilever.width", 3e-5),
        ("cantilever.thickness", 4e-6),
        ("cantilever.stiffness", 0.01),
        ("cantilever.stiffness", 26.0),
        ("cantilever.frequency", 3e5),
        ("tip.half_length", 1e-6),
        ("tip.width", 1e-6),
        ("tip.height", 1e-5),
        ("tip.density", 2330.0),
        ("tip.mass", 1e-14),
        ("tip.radius", 1e-9),
        ("tip.radius", 1e-5),
        ("tip.youngs_modulus", 1.3e11),
        ("sample.youngs_modulus", 2.7e9),
        ("sample.surface_energy", 1e-3),
        ("sample.hamaker", 6.4e-20),
        ("contact.decay_length", 3e-10),
        ("drive.voltage", 10.0),
        ("drive.frequency", 2e3),
        ("drive.force", 1e-9),
        ("drive.free_amplitude", 1e-9),
        ("drive.base_amplitude", 1e-9),
        ("approach.gap", 3e-10),
        ("approach.force_setpoint", 1e-10),
    ];
    for (path, value) in common {
        let path = match path.split_once('.') {
            Some(("actuator" | "cantilever" | "tip", _)) => format!("instrument.{path}"),
            _ => path.to_owned(),
        };
        let address = Address::find(&path).unwrap_or_else(|| panic!("no quantity {path}"));
        let refused = |value: f64| {
            let (section, key) = path.rsplit_once('.').expect("a path has a dot");
            let text = format!("[{section}]\n{key} = {}\n", address.written(value));
            Scene::parse("slip.toml".as_ref(), &text)
                .is_err_and(|error| error.to_string().contains("impossible size"))
        };
        assert!(!refused(value), "{path} = {value:e} is common");
        assert!(refused(value * 1e9), "{path} = {:e} is taken", value * 1e9);
    }
    let slip = CALIBRATED.replace("N/m\"", "N/nm\"");
    let desk = Desk::new();
    desk.write("slip.toml", &slip);
    desk.refuses(
        &["plan", "slip.toml"],
        &["slip.toml:", "stiffness` has an impossible size", "from 10 uN/m to", "is usual"],
    );
}

/// TRUST D11: 65,536 steps of a 300 kHz lever in a second, then values that are no numbers.
#[test]
fn a_drive_too_slow_for_its_lever_is_told() {
    let desk = Desk::new();
    let slow = CALIBRATED.replace("\"resonance\"", "\"1 Hz\"").replace("periods = 60", "periods = 4");
    desk.write("slow.toml", &slow);
    let said = desk.works(&["plan", "slow.toml"]);
    assert!(said.out.contains("warning: a drive of 1 Hz is too slow for a lever of 300 kHz"), "{}", said.out);
    assert!(parse(CALIBRATED).warnings().is_empty());
    // As slow as peak-force tapping is: none of it.
    let plan = Plan::new(&parse(&CALIBRATED.replace("\"resonance\"", "\"2 kHz\"")), Precision::F64).unwrap();
    assert!(plan.doubts().is_empty(), "{:?}", plan.doubts());
}

/// TRUST D12: errors of the plan had neither place nor help, and numbers of 301 digits.
#[test]
fn errors_of_the_plan_stand_at_their_place() {
    let desk = Desk::new();
    let undamped = CALIBRATED.replace("quality_factor = 20\n", "");
    desk.write("undamped.toml", &undamped);
    for command in ["plan", "run"] {
        let said = desk.refuses(
            &[command, "undamped.toml"],
            &[
                "the peak at ",
                "--> undamped.toml:11:1",
                "expected: a damped lever",
                "help: give quality_factor",
            ],
        );
        assert!(!said.err.contains("e5 Hz"), "{}", said.err);
    }
    let swept = format!(
        "{}[sweep]\n\"instrument.cantilever.quality_factor\" = {{ values = [20, inf] }}\n",
        CALIBRATED.replace("quality_factor = 20\n", "")
    );
    desk.write("swept.toml", &swept);
    let said =
        desk.refuses(&["plan", "swept.toml"], &["instance 1 (instrument.cantilever.quality_factor = inf)"]);
    assert!(!said.err.contains("inf 1"), "{}", said.err);
    desk.write("huge.toml", &CALIBRATED.replace("\"resonance\"", "\"1e300 Hz\""));
    let said = desk.refuses(&["plan", "huge.toml"], &["huge.toml:12:13", "impossible size", "\"1e300 Hz\""]);
    assert!(said.err.len() < 600, "{}", said.err);
    let modes = CALIBRATED.replace(
        "[instrument.cantilever]",
        "[instrument.actuator]\nlength = \"900 m\"\n[instrument.cantilever]",
    );
    desk.write("modes.toml", &modes);
    desk.refuses(
        &["modes", "modes.toml"],
        &["modes.toml:3:1", "expected: a rod and a lever", "help: shorten the rod"],
    );
}

/// TRUST D14: `force` answered for the preset's sample, which no instance has.
#[test]
fn forces_are_those_of_an_instance() {
    let desk = Desk::new();
    let text =
        format!("{CALIBRATED}[sweep]\n\"sample.youngs_modulus\" = {{ values = [\"1 GPa\", \"10 GPa\"] }}\n");
    desk.write("two.toml", &text);
    // K = 4/3 E/(1 - nu^2) for a rigid tip; R = 30 nm.
    for (arguments, modulus) in [(vec![], 1e9), (vec!["--instance", "1"], 10e9)] {
        let call = [vec!["force", "two.toml", "--json", "--indentation", "2 nm"], arguments].concat();
        let answer = desk.json(&call);
        let force = answer["curves"][0]["force_n"][0].as_f64().unwrap();
        let expected = 4.0 / 3.0 * modulus / (1.0 - 0.09) * 30e-9f64.sqrt() * 2e-9f64.powf(1.5);
        assert!((force / expected - 1.0).abs() < 1e-12, "{force} {expected}");
    }
    let said = desk.works(&["force", "two.toml", "--instance", "1"]);
    assert!(said.out.contains("instance 1 (sample.youngs_modulus = \"10 GPa\")"), "{}", said.out);
    desk.refuses(&["force", "two.toml", "--instance", "2"], &["there is no instance 2", "--instance 0 to 1"]);
}

/// An engine that notes how many instances the largest plan had that it was given.
struct Noting(Cpu, AtomicUsize);

impl Engine for Noting {
    fn device(&self) -> String {
        self.0.device()
    }

    fn run(&self, plan: &Plan, progress: &Progress) -> Result<Outcome, EngineError> {
        self.1.fetch_max(plan.len(), Ordering::Relaxed);
        self.0.run(plan, progress)
    }
}

/// TRUST D4: the trial carried all instances along, so that the estimate grew with the square of their number.
#[test]
fn the_trial_of_an_estimate_has_few_instances_however_many_there_are() {
    let text = format!(
        "{CALIBRATED}[sweep]\n\"sample.youngs_modulus\" = {{ from = \"1 GPa\", to = \"1.1 GPa\", points = 20000 }}\n"
    );
    let plan = Plan::new(&parse(&text), Precision::F64).unwrap();
    let engine = Noting(Cpu::default(), AtomicUsize::new(0));
    assert!(estimate(&plan, &engine).unwrap() > 0.0);
    let tried = engine.1.load(Ordering::Relaxed);
    assert!(
        (1..=64 * plan.classes().len()).contains(&tried),
        "{tried} instances, {} classes",
        plan.classes().len()
    );
}

/// USERS 0.9.
#[test]
fn small_words_are_right() {
    let desk = Desk::new();
    let help = desk.works(&["report", "--help"]).out;
    assert!(help.contains("[default: the file's name without .h5]") && !help.contains("(default"), "{help}");
    assert_eq!(afmsweep::report::shown(f64::NAN, "m", 4), "no value");
    let ragged = "[samples]\n\"approach.gap\" = [\"1 nm\", \"2 nm\"]\n\"drive.voltage\" = [\"1 V\"]\n";
    let error = Scene::parse(Path::new("test.toml"), ragged).unwrap_err().to_string();
    assert!(error.contains("found 1 value;"), "{error}");
}

/// Truth: the same scene from its file.
#[test]
fn a_scene_comes_from_standard_input() {
    use std::io::Write;
    use std::process::Stdio;
    let desk = Desk::new();
    let scene = desk.write("own.toml", CALIBRATED);
    desk.works(&["run", "own.toml", "--no-audit", "-o", "file.h5"]);
    let mut child = desk
        .command(&["run", "-", "--no-audit"])
        .stdin(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    let text = std::fs::read_to_string(&scene).expect("it was written");
    child.stdin.take().expect("it reads").write_all(text.as_bytes()).expect("it reads all");
    let said = child.wait_with_output().expect("it ends");
    assert!(said.status.success(), "{}", String::from_utf8_lossy(&said.stderr));
    let read = |name: &str| store::read(&desk.path(name)).expect("it is whole");
    assert_eq!(read("results/stdin.h5").variables, read("file.h5").variables);
    // Nobody's own sample is a warning.
    let stderr = String::from_utf8_lossy(&said.stderr).into_owned();
    assert!(stderr.contains("warning: from the preset"), "{stderr}");
}
