//! A searched run as a user calls it, and what it leaves in the file.
//! Truth: what waiting ends in, from two starts.

use crate::program;
use crate::program::{Desk, variable};
use afmsweep::Status;
use afmsweep::store::{NO_STATE, Results, read};

/// The tapping point of tests/hard/branch_repulsive.toml with other lines under [run].
fn point(desk: &Desk, name: &str, run: &str) -> std::path::PathBuf {
    let text = std::fs::read_to_string("tests/hard/branch_repulsive.toml").unwrap();
    let (text, _) = text.split_once("[run]").unwrap();
    let output = "[output]\nobservables = [\"amplitude\", \"phase\", \"force_max\", \"force_mean\"]\n\
                  waveforms = { instances = [0], samples_per_period = 256, periods = 2 }";
    desk.write(name, &format!("{text}\n[run]\nmeasure = 10\n{run}\n{output}\n"))
}

fn amplitude(results: &Results) -> f64 {
    variable(results, "amplitude")[0]
}

#[test]
fn a_searched_file_has_both_branches_of_a_point() {
    let desk = Desk::new();
    let searched = desk
        .run(&point(&desk, "search.toml", "steady = \"search\"\nbranches = \"both\"\nperiods = 3000"), &[]);
    let high = desk.run(&point(&desk, "free.toml", "periods = 2000"), &[]);
    let low = desk.run(&point(&desk, "rest.toml", "start = \"rest\"\nperiods = 2000"), &[]);
    let scale = 5e-9;
    assert!((amplitude(&searched) - amplitude(&high)).abs() < 1e-3 * scale, "{:e}", amplitude(&searched));
    let branch = searched.flags.iter().find(|flags| flags.name == "branch").unwrap();
    assert_eq!(branch.meanings, ["none", "attractive", "repulsive"]);
    assert!(variable(&searched, "multiplier")[0] < 1.0);
    assert!(variable(&searched, "periods_stepped")[0] < 1000.0);
    let other = searched.other_branch.as_ref().expect("a second state");
    let of = |name: &str| other.variables.iter().find(|one| one.name == name).unwrap().data[0];
    let code = other.flags.iter().find(|flags| flags.name == "branch").unwrap().data[0];
    assert_eq!(other.status, [0]);
    assert!(other.steps_per_period[0] >= 16);
    assert!(of("error_estimate") < 1e-3, "{:e}", of("error_estimate"));
    assert!(
        (of("amplitude") - amplitude(&low)).abs() < 2e-3 * scale,
        "{:e} {:e}",
        of("amplitude"),
        amplitude(&low)
    );
    assert!((amplitude(&high) - amplitude(&low)).abs() > 0.01 * scale);
    // One is pulled, the other pushed.
    assert_eq!(u8::from(of("force_mean") < 0.0) + 2 * u8::from(of("force_mean") > 0.0), code);
    assert_ne!(branch.data[0], code);
    // The waveform is the state's own: its fundamental is the amplitude.
    let waveforms = searched.waveforms.as_ref().unwrap();
    let row = &waveforms.tip_travel[0];
    let angle = |n: usize| std::f64::consts::TAU * n as f64 / 256.0;
    let sum = |wave: fn(f64) -> f64| row.iter().enumerate().map(|(n, z)| z * wave(angle(n))).sum::<f64>();
    let fundamental = 2.0 / row.len() as f64 * sum(f64::sin).hypot(sum(f64::cos));
    assert!((fundamental - amplitude(&searched)).abs() < 1e-3 * scale, "{fundamental:e}");
}

/// Every variable of the group stands over the dimensions of the first states; where there is no second state, it is
/// told so, not left out.
#[test]
fn second_states_stand_over_the_dimensions_of_the_first() {
    let desk = Desk::new();
    let text = std::fs::read_to_string(program::scene("bistable.toml")).unwrap();
    let (text, _) = text.split_once("waveforms").unwrap();
    let text = text.replace("\"dissipation\"]", "\"harmonic_amplitude\"]");
    let results = desk.run(&desk.write("bistable.toml", &text), &[]);
    let other = results.other_branch.as_ref().expect("second states");
    let count = results.status.len();
    assert_eq!(count, 33);
    let has = |i: usize| other.status[i] != NO_STATE;
    assert!((0..count).any(has) && !(0..count).all(has));
    for main in results
        .variables
        .iter()
        .filter(|one| !["periods_stepped", "tabor_parameter"].contains(&one.name.as_str()))
    {
        let one = other.variables.iter().find(|one| one.name == main.name);
        let one = one.unwrap_or_else(|| panic!("no second {}", main.name));
        assert_eq!(
            (one.data.len(), &one.units, one.harmonics),
            (main.data.len(), &main.units, main.harmonics)
        );
        let width = main.harmonics.unwrap_or(1);
        (0..count).for_each(|i| assert_eq!(!one.data[i * width].is_nan(), has(i), "{} {i}", main.name));
    }
    let branch = other.flags.iter().find(|flags| flags.name == "branch").unwrap();
    for i in 0..count {
        assert_eq!(branch.data[i] != 0, has(i), "{i}");
        assert_eq!(other.steps_per_period[i] != 0, has(i), "{i}");
    }
}

/// A list has no neighbours: the run says where its second states come from.
#[test]
fn a_list_is_searched_from_rest_and_along_the_gap_and_says_so() {
    let desk = Desk::new();
    let text = std::fs::read_to_string(program::scene("bistable.toml")).unwrap();
    let (text, _) = text.split_once("waveforms").unwrap();
    let sweep = "\"approach.gap\" = { from = \"1 nm\", to = \"9 nm\", points = 33 }";
    assert!(text.contains(sweep), "{text}");
    let text = text.replace("[sweep]", "[samples]").replace(sweep, "\"approach.gap\" = [\"5 nm\", \"6 nm\"]");
    let scene = desk.write("list.toml", &text);
    let words = desk.works(&["run", scene.to_str().unwrap(), "--no-audit", "-o", "list.h5"]).err;
    assert!(words.contains("(group other_branch): 2 from rest, 0 along the gap"), "{words}");
    let other = read(&desk.path("list.h5")).unwrap().other_branch.expect("the group");
    assert_eq!(other.status.len(), 2);
}

#[test]
fn a_search_says_what_it_found() {
    let desk = Desk::new();
    let scene = point(&desk, "said.toml", "steady = \"search\"\nbranches = \"both\"\nperiods = 3000");
    let words = desk.works(&["run", scene.to_str().unwrap(), "--no-audit", "-o", "said.h5"]).err;
    assert!(words.contains("search: periodic states of 1 of 1 instance"), "{words}");
    assert!(words.contains("branches: 1 instance with a second periodic state"), "{words}");
    let _ = read(&desk.path("said.h5")).unwrap();
}

/// What `plan` tells of a scene that searches: the cost of waiting, said to be that (no run is behind it).
#[test]
fn a_plan_says_that_states_are_searched_for() {
    let desk = Desk::new();
    let said = |name: &str, run: &str| {
        let scene = point(&desk, name, run);
        let path = scene.to_str().unwrap();
        (desk.works(&["plan", path]).out, desk.json(&["plan", path, "--json"]))
    };
    let (text, json) = said("both.toml", "steady = \"search\"\nbranches = \"both\"\nperiods = 3000");
    assert!(text.contains("periodic states are searched for: steps and time are told as if every instance"));
    assert!(text.contains("waits all 3000; a second state of each"), "{text}");
    assert_eq!((&json["steady"], &json["branches"]), (&"search".into(), &"both".into()));
    let steps = json["classes"][0]["steps_per_period"].as_u64().unwrap();
    assert_eq!(json["instance_steps"].as_u64(), Some(3000 * steps), "{json}");
    assert!(json["estimate_is_for"].as_str().unwrap().contains("waited for all periods"), "{json}");
    let (text, json) = said("one.toml", "steady = \"search\"\nperiods = 3000");
    assert!(text.contains("searched for") && !text.contains("second state"), "{text}");
    assert_eq!(json["branches"], "one");
    let (text, json) = said("waits.toml", "periods = 3000");
    assert!(!text.contains("searched"), "{text}");
    assert_eq!(json["steady"], "wait");
}

/// A lever that rings long is searched for from starts that lead to unstable states first: the run counts what gave up, by
/// reason, in its messages and its object.
#[test]
fn a_run_says_how_many_searches_gave_up_and_why() {
    let desk = Desk::new();
    let scene = |name: &str| {
        let text = std::fs::read_to_string(format!("tests/hard/{name}")).unwrap();
        desk.write(name, &text).to_str().unwrap().to_owned()
    };
    let run = |name: &str| {
        let run = desk.works(&["run", &scene(name), "--overwrite", "-o", "a.h5", "--no-audit", "--json"]);
        (serde_json::from_str::<serde_json::Value>(&run.out).unwrap(), run.err)
    };
    let (json, said) = run("q_1e5_search.toml");
    let unstable = json["search"]["gave_up"]["unstable"].as_u64().unwrap();
    assert_eq!(json["search"]["found"], 1);
    assert!(unstable > 0, "{json}");
    assert!(said.contains(&format!("gave up, several for some instances: {unstable} unstable")), "{said}");
    assert!(run("q_1e5.toml").0["search"].is_null());
}

/// Of a search there is too little to step for a GPU: with `auto` it goes to the CPU and says so to who asks.
#[test]
fn auto_leaves_a_long_search_to_the_cpu() {
    let desk = Desk::new();
    let lines = "steady = \"search\"\nperiods = 2000\nsteps_per_period = 128\n[sweep]\n\
                 \"sample.youngs_modulus\" = { from = \"1 GPa\", to = \"2 GPa\", points = 900 }";
    let text = std::fs::read_to_string(point(&desk, "long.toml", lines)).unwrap();
    // Waveforms are of no matter here.
    let text = text.lines().filter(|line| !line.contains("waveforms")).collect::<Vec<_>>().join("\n");
    desk.write("long.toml", &text);
    let said = desk.works(&["run", "long.toml", "-v", "--backend", "auto", "--no-audit", "--no-estimate"]);
    assert!(said.err.contains("on the CPU: of a search there is too little to step"), "{}", said.err);
}

/// A set-point that another branch holds than the one asked for, or on which the tip hovers, is told with its number.
#[test]
fn the_branch_that_holds_a_set_point_is_told() {
    let desk = Desk::new();
    let scene = |amplitude: &str, branch: &str| {
        format!(
            "[instrument.cantilever]\nstiffness = \"2.8 N/m\"\nfrequency = \"75 kHz\"\nquality_factor = 180\n\
             [instrument.tip]\nradius = \"10 nm\"\n[sample]\nyoungs_modulus = \"2.7 GPa\"\npoisson_ratio = 0.34\n\
             surface_energy = \"60 mJ/m^2\"\n[contact]\nlaw = \"dmt\"\n[drive]\non = \"tip\"\nfrequency = \"resonance\"\n\
             free_amplitude = \"{amplitude}\"\n[approach]\n{branch}\n[sweep]\n\
             \"approach.setpoint\" = {{ values = [0.7, 0.8] }}\n[run]\nsteady = \"search\"\n"
        )
    };
    let said = |amplitude: &str, branch: &str| {
        let scene = desk.write("held.toml", &scene(amplitude, branch));
        let run = ["run", scene.to_str().unwrap(), "--no-audit", "--overwrite", "-o", "held.h5"];
        desk.works(&run).err
    };
    let hovers = said("25 nm", "");
    assert!(
        hovers.contains("2 of 2 instances hold the set-point on the attractive branch, where"),
        "{hovers}"
    );
    let missed = said("2 nm", "setpoint_branch = \"repulsive\"");
    assert!(
        missed.contains("2 of 2 instances hold the set-point on the attractive branch: on the"),
        "{missed}"
    );
    let kept = said("25 nm", "setpoint_branch = \"repulsive\"");
    assert!(!kept.contains("hold the set-point"), "{kept}");
}

/// Set-points that no gap holds have no state: they are not counted among the states found, and their multipliers are no numbers.
#[test]
fn set_points_without_a_gap_are_counted_once() {
    let desk = Desk::new();
    desk.write(
        "set.toml",
        r#"
        [instrument]
        cantilever = { stiffness = "26 N/m", frequency = "300 kHz", quality_factor = 200 }
        tip = { radius = "10 nm", youngs_modulus = "130 GPa", poisson_ratio = 0.28 }
        [sample]
        youngs_modulus = "2.0 GPa"
        poisson_ratio = 0.34
        surface_energy = "100 mJ/m^2"
        [contact]
        law = "dmt"
        [drive]
        on = "tip"
        frequency = "resonance"
        free_amplitude = "20 nm"
        [sweep]
        "approach.force_setpoint" = { values = ["0.1 nN", "0.5 nN", "1 nN", "2 nN", "3 nN", "5 nN", "6 nN", "7 nN", "8 nN"] }
        "#,
    );
    let said = desk.works(&["run", "set.toml", "--no-audit"]);
    let results = read(&desk.path("results/set.h5")).unwrap();
    let lost: Vec<bool> = results.status.iter().map(|code| *code == Status::NoSetpoint as u8).collect();
    let count = lost.iter().filter(|one| **one).count();
    assert!(count > 0, "{:?}", results.status);
    let unknown: Vec<bool> =
        variable(&results, "multiplier").iter().map(|multiplier| multiplier.is_nan()).collect();
    assert_eq!(lost, unknown);
    let found = format!("periodic states of {} of 9 instances", 9 - count);
    let rest = format!("; 0 waited for; {count} without a gap that holds the set-point");
    assert!(said.err.contains(&found) && said.err.contains(&rest), "{}", said.err);
}
