//! Scene files: each one in `scenes/good` loads and survives its own echo; each one in `scenes/bad` is
//! refused with the words that its leading comments expect, and with its place.

use afmsweep::scene::*;
use afmsweep::units::Dimension;
use std::path::{Path, PathBuf};

fn files(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes").join(folder);
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    files.sort();
    files
}

fn parse(text: &str) -> Scene {
    Scene::parse(Path::new("test.toml"), text).unwrap()
}

fn refusal(text: &str) -> String {
    Scene::parse(Path::new("test.toml"), text).unwrap_err().render(false)
}

/// Message text without the line breaks and frame of rendering, so that fragments need not know them.
fn flat(message: &str) -> String {
    message.split_whitespace().filter(|word| *word != "|").collect::<Vec<_>>().join(" ")
}

#[test]
fn bad_scenes_are_refused_with_the_expected_words_and_place() {
    let files = files("bad");
    assert!(files.len() >= 34, "only {} bad scenes", files.len());
    let mut failures = Vec::new();
    for path in files {
        let text = std::fs::read_to_string(&path).unwrap();
        let expected: Vec<&str> = text.lines().map_while(|line| line.strip_prefix("# expect: ")).collect();
        assert!(!expected.is_empty(), "{} expects nothing", path.display());
        let error = match Scene::load(&path) {
            Ok(_) => {
                failures.push(format!("{} was accepted", path.display()));
                continue;
            }
            Err(error) => error,
        };
        let rendered = error.render(false);
        for part in ["= expected: ", "= help: "] {
            if !rendered.contains(part) {
                failures.push(format!("{}: no {part:?} in\n{rendered}", path.display()));
            }
        }
        for message in [flat(&rendered), error.to_string()] {
            for fragment in &expected {
                // The one-line form leaves out what is said at other places than the faulty one.
                if !message.contains(fragment)
                    && (message != error.to_string() || !fragment.ends_with("here"))
                {
                    failures.push(format!("{}: no {fragment:?} in {message}\n{rendered}", path.display()));
                }
            }
            let (line, column) = error.line_column().unwrap();
            assert!(
                line > expected.len() && column > 0,
                "place {line}:{column} in the comments of {}",
                path.display()
            );
            let place = format!("{}:{line}:{column}", path.display());
            assert!(message.contains(&place), "no {place} in {message}");
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n\n"));
}

#[test]
fn good_scenes_survive_their_echo_to_the_bit() {
    let files = files("good");
    assert!(files.len() >= 7, "only {} good scenes", files.len());
    for path in files {
        let scene = Scene::load(&path).unwrap();
        let echo = scene.resolved_toml();
        let again = Scene::parse(&path, &echo).unwrap();
        // Debug text shows every bit of a double, so -0 and 0 differ here, and NaN would be seen.
        let all = |scene: &Scene| {
            format!("{:?}", (&scene.title, &scene.base, &scene.sweep, &scene.run, &scene.output))
        };
        assert_eq!(all(&again), all(&scene), "{}\n{echo}", path.display());
        assert!(!all(&scene).contains("NaN"), "{}", path.display());
        assert_eq!(again.resolved_toml(), echo, "{}", path.display());
        for index in 0..scene.len() {
            assert_eq!(again.instance(index), scene.instance(index));
        }
    }
}

/// Every way in which a file can fail to be a text, with the words and the place that the message must have.
#[test]
fn files_that_are_no_texts_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let load = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        Scene::load(&path).unwrap_err()
    };
    let latin = load("latin.toml", b"title = \"a\"\n[instrument.tip]\nradius = \"0.01 \xB5m\"\n");
    assert_eq!(latin.line_column(), Some((3, 16)));
    for fragment in [
        "latin.toml:3:16",
        "not UTF-8",
        "byte 0xB5 at offset 44 (line 3, column 16)",
        "save the file as UTF-8",
    ] {
        assert!(latin.render(false).contains(fragment) && latin.to_string().contains(fragment), "{latin:?}");
    }
    let wide = load("wide.toml", b"\xFF\xFEt\0i\0");
    assert!(
        wide.to_string().contains("looks like UTF-16") && wide.to_string().contains("wide.toml:1:1"),
        "{wide:?}"
    );
    for (name, bytes) in [
        ("empty.toml", &b""[..]),
        ("comments.toml", b"# nothing\n\n  # at all"),
        ("bom.toml", b"\xEF\xBB\xBF\r\n"),
    ] {
        let error = load(name, bytes);
        assert!(
            error.to_string().contains("the scene file is empty") && error.to_string().contains(name),
            "{error:?}"
        );
    }
    let missing = Scene::load(&folder.path().join("missing.toml")).unwrap_err();
    assert!(missing.render(false).contains("missing.toml"), "{missing:?}");
    assert!(
        missing.to_string().contains("cannot read the scene") && missing.line_column().is_none(),
        "{missing:?}"
    );
    let directory = Scene::load(folder.path()).unwrap_err();
    assert!(directory.to_string().contains("Is a directory"), "{directory:?}");
}

#[cfg(unix)]
#[test]
fn an_unreadable_file_is_refused() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("secret.toml");
    std::fs::write(&path, "title = \"a\"").unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o000)).unwrap();
    // The superuser reads it all the same; then there is nothing to refuse.
    if std::fs::File::open(&path).is_err() {
        let error = Scene::load(&path).unwrap_err();
        assert!(error.to_string().contains("cannot read the scene"), "{error:?}");
        assert!(error.to_string().contains("permissions"), "{error:?}");
    }
}

#[test]
fn places_count_characters_whatever_stands_before_them() {
    // A byte order mark, Windows line ends, wide characters and a tab.
    for (text, line, column) in [
        ("\u{FEFF}titel = \"a\"", 1, 1),
        ("title = \"a\"\r\n[instrument.tip]\r\nradius = 10\r\n", 3, 10),
        ("instrument.tip = { poisson_ratio = 0.3, \"µ\" = 1, radius = 10 }", 1, 41),
        ("[instrument]\n\ttip = { radius = 10 }", 2, 19),
    ] {
        let error = Scene::parse(Path::new("test.toml"), text).unwrap_err();
        assert_eq!(error.line_column(), Some((line, column)), "{error:?}");
        assert!(error.render(false).contains(&format!("test.toml:{line}:{column}")), "{error:?}");
    }
    let marked = parse("\u{FEFF}title = \"µ\"\r\n");
    assert_eq!(marked.title, "µ");
}

#[test]
fn colour_comes_only_when_asked_for() {
    let error = Scene::parse(Path::new("test.toml"), "titel = 1").unwrap_err();
    assert!(error.render(true).contains('\u{1b}'));
    assert!(!error.render(false).contains('\u{1b}') && !error.to_string().contains('\u{1b}'));
    // Control characters of the file must not reach the terminal.
    let hostile = refusal("\"a\\u001b[31m\" = 1");
    assert!(!hostile.contains('\u{1b}'), "{hostile:?}");
}

#[test]
fn what_is_left_out_is_the_preset() {
    let scene = parse("title = \"a\"");
    assert_eq!(scene.base, Params::default());
    assert_eq!((scene.len(), scene.instance(0)), (1, Params::default()));
    assert_eq!((scene.run.periods, scene.run.measure, scene.run.accuracy), (300, 50, 1e-3));
    assert_eq!(scene.output.observables.len(), 7);
    assert_eq!(Scene::parse(Path::new("folder/tapping.toml"), "[run]").unwrap().title, "tapping");
    assert_eq!(parse("[run]\nperiods = 20").run.measure, 20);
    let waveforms =
        parse("[run]\nperiods = 3\n[output]\nwaveforms = { instances = [0] }").output.waveforms.unwrap();
    assert_eq!((waveforms.samples_per_period, waveforms.periods), (256, 3));
}

#[test]
fn a_grid_runs_its_last_axis_fastest_and_a_list_goes_row_by_row() {
    let scene = parse(
        "[sweep]\n\"instrument.tip.radius\" = { values = [\"20 nm\", \"10 nm\"] }\n\
         \"sample.youngs_modulus\" = { from = \"100 MPa\", to = \"10 GPa\", points = 3, scale = \"log\" }",
    );
    let cases: Vec<(f64, f64)> = (0..scene.len())
        .map(|i| scene.instance(i))
        .map(|case| (case.instrument.tip.radius, case.sample.youngs_modulus))
        .collect();
    let expected = [(2e-8, 1e8), (2e-8, 1e9), (2e-8, 1e10), (1e-8, 1e8), (1e-8, 1e9), (1e-8, 1e10)];
    assert_eq!(cases, expected);
    let axis = &scene.sweep.axes[1];
    assert_eq!((axis.name.as_str(), axis.units.as_str(), axis.log), ("sample_youngs_modulus", "Pa", true));

    let list =
        parse("[samples]\n\"approach.gap\" = [\"3 nm\", \"1 nm\"]\n\"drive.voltage\" = [\"1 V\", \"1 V\"]");
    assert_eq!((list.sweep.layout, list.len()), (Layout::List, 2));
    assert_eq!(list.instance(1).approach.gap, 1e-9);
    assert_eq!(list.instance(1).drive.level, DriveLevel::Voltage(1.0));
}

#[test]
fn an_axis_switches_alternatives_as_the_file_would() {
    let scene =
        Scene::load(&files("good").into_iter().find(|path| path.ends_with("switched_by_axis.toml")).unwrap())
            .unwrap();
    let last = scene.instance(scene.len() - 1);
    assert_eq!(last.drive.level, DriveLevel::FreeAmplitude(1e-8));
    assert_eq!(last.sample.adhesion, Adhesion::Hamaker(1e-19));
    assert_eq!(last.instrument.tip.mass, TipMass::Given(8e-16));
    assert_eq!(last.instrument.cantilever.quality_factor, QualityFactor::All(f64::INFINITY));
    let calibrated = parse(
        "[instrument.cantilever]\nfrequency = \"300 kHz\"\n[drive]\nbase_amplitude = \"1 nm\"\n[sweep]\n\
         \"instrument.cantilever.stiffness\" = { values = [\"40 N/m\", \"42 N/m\"] }",
    );
    let lever = calibrated.instance(1).instrument.cantilever.lever;
    assert_eq!(lever, LeverSpec::Calibrated { stiffness: 42.0, frequency: 3e5 });
}

/// A lever by its calibration or its modes has a rod only where the scene names one.
const ROD: &str = "[instrument]\npreset = \"ha-fung-chen-2005\"\n";

/// A list pairs the two moduli of a sample that relaxes; a grid has each with each.
#[test]
fn moduli_that_relax_are_compared_case_by_case() {
    let text = |sweep: &str, at_once: &str| {
        format!(
            "[sample]\nrelaxation_time = \"1 us\"\n[contact]\nlaw = \"hertz\"\n{sweep}\n\
             \"sample.youngs_modulus\" = [\"1 GPa\", \"9 GPa\"]\n\"sample.instantaneous_modulus\" = {at_once}\n"
        )
    };
    assert_eq!(parse(&text("[samples]", "[\"2 GPa\", \"10 GPa\"]")).len(), 2);
    let refused =
        Scene::parse(Path::new("list.toml"), &text("[samples]", "[\"2 GPa\", \"8 GPa\"]")).unwrap_err();
    let said = refused.to_string();
    assert!(said.contains("instantaneous_modulus 8.0000e9 Pa below youngs_modulus 9.0000e9 Pa"), "{said}");
    let grid = text("[sweep]", "{ values = [\"2 GPa\", \"10 GPa\"] }");
    let grid = grid.replace("[\"1 GPa\", \"9 GPa\"]", "{ values = [\"1 GPa\", \"9 GPa\"] }");
    let said = Scene::parse(Path::new("grid.toml"), &grid).unwrap_err().to_string();
    assert!(said.contains("2.0000e9 Pa below youngs_modulus 9.0000e9 Pa"), "{said}");
}

/// A frequency without its kilo is a lever of milligrams, though each number alone is usual.
#[test]
fn a_lever_of_an_odd_mass_is_told() {
    let of = |frequency: &str| {
        let lever = format!("stiffness = \"2.8 N/m\"\nfrequency = \"{frequency}\"\nquality_factor = 180");
        parse(&format!("[instrument.cantilever]\n{lever}\n[drive]\nbase_amplitude = \"1 nm\"\n")).warnings()
    };
    let said = of("75 Hz");
    assert!(said.iter().any(|line| line.contains("effective mass of 12.6")), "{said:?}");
    assert!(!of("75 kHz").iter().any(|line| line.contains("effective mass")));
}

#[test]
fn every_quantity_can_be_written_swept_and_echoed() {
    for quantity in QUANTITIES {
        // Each needs the company that makes it meaningful; the value is off its default and inside its domain.
        let path = quantity.path.replace('#', "0");
        let share = ["poisson_ratio", ".setpoint"].iter().any(|end| quantity.path.ends_with(end));
        let value = match quantity.dimension {
            _ if share => 0.25,
            Dimension::Length | Dimension::Force | Dimension::Mass => 7.5e-9,
            Dimension::Energy => 7.5e-20,
            _ => 7.5,
        };
        let value = if path.ends_with("actuator.h33") { 5e8 } else { value };
        let value = if path.ends_with("actuator.youngs_modulus") { 3e10 } else { value };
        let value = if path.ends_with("actuator.beta33") { 9e7 } else { value };
        let value = if path.ends_with("instantaneous_modulus") { 3e9 } else { value };
        let text = Address::find(&path).unwrap().written(value);
        let (mut company, mut drive) = (String::new(), "");
        if path.contains(".modes.") || path.starts_with("instrument.cantilever.quality_factor.") {
            let list = match path.contains(".modes.") {
                true => "modes = [{ stiffness = \"2 N/m\", frequency = \"70 kHz\" }]",
                false => "quality_factor = [100]",
            };
            company = format!("{ROD}[instrument.cantilever]\n{list}\n");
        }
        match path.as_str() {
            "instrument.cantilever.stiffness" => {
                company = format!("{ROD}[instrument.cantilever]\nfrequency = \"70 kHz\"\n")
            }
            "instrument.cantilever.frequency" => {
                company = format!("{ROD}[instrument.cantilever]\nstiffness = \"2 N/m\"\n")
            }
            "instrument.tip.half_angle" => {
                company = "[instrument.tip]\nshape = \"cone\"\n[contact]\nlaw = \"hertz\"\n".into()
            }
            outside if outside.starts_with("contact.outside.") => company = outside_with(outside),
            "sample.thickness" => company = "[contact]\nlaw = \"hertz\"\n".into(),
            "sample.hamaker" => company = "[contact]\nlaw = \"dmt\"\n".into(),
            "sample.viscosity" | "sample.retardation_time" | "sample.loss_tangent" => {
                company = "[contact]\nlaw = \"dmt\"\n".into()
            }
            "sample.instantaneous_modulus" => {
                company = "[contact]\nlaw = \"hertz\"\n[sample]\nrelaxation_time = \"1 us\"\n".into()
            }
            "sample.relaxation_time" => {
                company = "[contact]\nlaw = \"hertz\"\n[sample]\ninstantaneous_modulus = \"1 MPa\"\n".into()
            }
            "approach.deepest" => company = "[approach]\nsetpoint = 0.8\n".into(),
            "drive.force" => drive = "on = \"tip\"\n",
            "drive.base_amplitude" => company = "[instrument.actuator]\nmodel = \"rigid\"\n".into(),
            _ => {}
        }
        let swept = parse(&format!("{company}[drive]\n{drive}[sweep]\n\"{path}\" = {{ values = [{text}] }}"));
        let address = Address::find(&path).unwrap();
        assert_eq!(address.get(&swept.instance(0)), Some(value), "{path}");
        assert_ne!(swept.instance(0), Params::default(), "{path}");
        let again = parse(&swept.resolved_toml());
        assert_eq!(
            (again.base.clone(), again.instance(0)),
            (swept.base.clone(), swept.instance(0)),
            "{path}"
        );
        if !quantity.path.contains('#') {
            // Dotted keys at the top must come before any section.
            let written = parse(&format!("{path} = {text}\n{}", company_as_keys(&company, drive)));
            assert_eq!(address.get(&written.base), Some(value), "{path}");
            assert_eq!(parse(&written.resolved_toml()).base, written.base, "{path}");
        }
    }
}

/// A force outside contact with this quantity, and what else it needs.
pub fn outside_with(path: &str) -> String {
    let key = path.rsplit('.').next().unwrap();
    let force = match key {
        "bias" | "contact_potential" | "cut_off" => "electrostatic, bias=1 V, cut_off=1 nm",
        "cone_half_angle" => "electrostatic, bias=1 V, cut_off=1 nm, cone_height=9 um",
        "cone_height" => "electrostatic, bias=1 V, cut_off=1 nm, cone_half_angle=9 degree",
        "forms_at" | "breaks_at" => "capillary, strength=1 nN, breaks_at=1 mm, decay_length=1 nm",
        "pressure" | "strength" => "hydration, decay_length=1 nm",
        "decay_length" | "period" | "phase" => "hydration, strength=1 nN, decay_length=1 nm, period=1 nm",
        _ => "double-layer, tip_charge=1 mC/m^2, sample_charge=1 mC/m^2, screening_length=1 nm",
    };
    let (word, rest) = force.split_once(", ").unwrap();
    let entries = rest.split(", ").map(|entry| entry.split_once('=').unwrap());
    let lines = entries.filter(|(one, _)| *one != key).map(|(one, value)| format!("{one} = \"{value}\"\n"));
    format!(
        "[contact]\nlaw = \"dmt\"\n[[contact.outside]]\nforce = \"{word}\"\n{}",
        lines.collect::<String>()
    )
}

/// Sections of one entry each, as dotted keys.
fn company_as_keys(company: &str, drive: &str) -> String {
    let mut lines = company.lines();
    let mut keys = String::new();
    while let (Some(section), Some(entry)) = (lines.next(), lines.next()) {
        keys += &format!("{}.{entry}\n", section.trim_matches(['[', ']']));
    }
    if !drive.is_empty() {
        keys += &format!("drive.{drive}");
    }
    keys
}

#[test]
fn no_damaged_scene_makes_the_reader_panic() {
    let scene = std::fs::read_to_string(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes/good/modes_swept.toml"),
    )
    .unwrap();
    let tokens =
        ["\"", "[", "{", "}", "=", "\u{0}", "µ", "-", "1e999", "inf", "\n", "#", "nm", ".", "\u{202e}"];
    let mut refused = 0;
    for at in (0..scene.len()).filter(|at| scene.is_char_boundary(*at)) {
        for token in tokens {
            let damaged = format!("{}{token}{}", &scene[..at], &scene[at..]);
            if let Err(error) = Scene::parse(Path::new("test.toml"), &damaged) {
                refused += 1;
                assert!(error.to_string().starts_with("test.toml"), "{error:?}");
                assert!(!error.render(false).is_empty());
            }
        }
        if let Err(error) = Scene::parse(Path::new("test.toml"), &scene[..at]) {
            assert!(!error.render(true).is_empty());
        }
    }
    assert!(refused > 1000, "only {refused} damaged scenes were refused");
}
