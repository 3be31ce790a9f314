//! `init` and `explain`: a scene to begin with, and what words mean. Truth: the program's own lists.

use crate::program::Desk;
use afmsweep::kernel::Entry;
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::QUANTITIES;
use afmsweep::{Observable, Scene, Status};
use std::path::Path;

#[test]
fn every_scene_to_begin_with_can_be_planned() {
    let desk = Desk::new();
    let mut all = Vec::new();
    for kind in [
        &[][..],
        &["--lever"],
        &["--liquid"],
        &["--paper"],
        &["--bistable"],
        &["--peak-force"],
        &["--samples"],
    ] {
        let text = desk.works(&[&["init"], kind].concat()).out;
        Scene::parse(Path::new("scene.toml"), &text).unwrap_or_else(|error| panic!("{kind:?}: {error}"));
        std::fs::write(desk.path("scene.toml"), &text).unwrap();
        desk.works(&["plan", "scene.toml"]);
        all.push(text);
    }
    assert_eq!(all[0], all[1], "the lever is what nobody has to ask for");
    all.dedup();
    assert_eq!(all.len(), 6);
}

/// The calibrated lever is run to the accuracy that it asks for.
#[test]
fn the_first_scene_runs_and_is_met() {
    let desk = Desk::new();
    let text = desk.works(&["init"]).out;
    std::fs::write(desk.path("scene.toml"), text).unwrap();
    desk.works(&["run", "scene.toml", "-o", "scene.h5", "--strict"]);
}

/// The shader of a scene is that of the library, and of the law that the scene names.
#[test]
fn the_shader_that_is_shown_is_the_one_that_runs() {
    let desk = Desk::new();
    let text = desk.works(&["init"]).out;
    std::fs::write(desk.path("scene.toml"), &text).unwrap();
    let scene = Scene::parse(Path::new("scene.toml"), &text).unwrap();
    for (word, precision) in [("f32", Precision::F32), ("f64", Precision::F64)] {
        let plan = Plan::new(&scene, precision).unwrap();
        let class = plan.classes().into_iter().find(|class| class.instances.contains(&0)).unwrap();
        for entry in Entry::ALL {
            let shown =
                desk.works(&["shader", "scene.toml", "--entry", entry.name(), "--precision", word]).out;
            assert_eq!(shown.trim_end(), plan.shader(&class, entry).compose().trim_end());
            let kicks = matches!(entry, Entry::Sweep | Entry::Kicks);
            assert_eq!(shown.contains("fn law_kick"), kicks, "{}", entry.name());
        }
    }
    desk.refuses(&["shader", "scene.toml", "--instance", "9999"], &["there is no instance 9999"]);
}

/// What was used is cited, and nothing else.
#[test]
fn citations_are_those_of_the_laws_and_the_instrument_that_ran() {
    let desk = Desk::new();
    let pyramid = "[instrument.tip]\nshape = \"pyramid\"\nhalf_angle = \"35 deg\"";
    let neck = "[[contact.outside]]\nforce = \"capillary\"\nstrength = \"1 nN\"\nforms_at = \"1 nm\"\nbreaks_at = \"2 nm\"\n[instrument.tip]";
    for (kind, tip, keys) in [
        ("--lever", neck, &["derjaguin1975effect", "zitzler2002capillary"][..]),
        ("--lever", "[instrument.tip]", &["afmsweep", "derjaguin1975effect"][..]),
        ("--liquid", "[instrument.tip]", &["afmsweep", "hertz1882contact"]),
        ("--liquid", pyramid, &["hertz1882contact", "sneddon1965relation", "bilodeau1992regular"]),
        ("--paper", "[instrument.tip]", &["afmsweep", "ha2005afm"]),
    ] {
        let text = desk.works(&["init", kind]).out.replace("[instrument.tip]", tip);
        std::fs::write(desk.path("scene.toml"), text).unwrap();
        let quick = ["-q", "--no-estimate", "--no-audit", "--overwrite"];
        desk.works(&[&["run", "scene.toml", "-o", "scene.h5"][..], &quick].concat());
        let said = desk.works(&["cite", "scene.h5"]).out;
        let cited: Vec<&str> = said
            .lines()
            .filter_map(|line| line.strip_prefix('@')?.split_once('{'))
            .map(|(_, key)| key.trim_end_matches(','))
            .collect();
        assert!(keys.iter().all(|key| cited.contains(key)), "{kind:?}: {cited:?}");
        assert_eq!(cited.contains(&"sneddon1965relation"), tip == pyramid);
        assert_eq!(said.matches('{').count(), said.matches('}').count(), "{said}");
        let laws = cited
            .iter()
            .filter(|key| ["hertz1882contact", "derjaguin1975effect", "johnson1971surface"].contains(key));
        assert_eq!(laws.count(), 1, "{cited:?}");
    }
    assert!(desk.call(&["cite", "scene.toml"]).err.starts_with("error: "));
}

#[test]
fn every_key_observable_and_status_is_explained() {
    let desk = Desk::new();
    let listed = desk.works(&["explain"]).out;
    let listed: Vec<&str> = listed.lines().collect();
    let known = |word: &str| assert!(listed.contains(&word), "{word} is not in the list");
    Observable::all().for_each(|one| known(one.name()));
    Status::ALL.iter().for_each(|one| known(one.meaning()));
    for quantity in QUANTITIES.iter().filter(|one| !one.path.contains('#')) {
        let told = desk.works(&["explain", quantity.path]).out;
        let last = quantity.path.rsplit('.').next().unwrap();
        assert!(told.contains(last) && told.contains("scene file"), "{}: {told}", quantity.path);
    }
    let (whole, part) = ("instrument.cantilever.stiffness", "cantilever.stiffness");
    assert_eq!(desk.works(&["explain", whole]).out, desk.works(&["explain", part]).out);
    let told = desk.works(&["explain", "accuracy_not_met"]).out;
    assert!(told.contains("above the accuracy, by estimate or by audit"), "{told}");
}

#[test]
fn a_word_that_nothing_has_leads_on() {
    let desk = Desk::new();
    desk.refuses(&["explain", "accuracy_not"], &["accuracy_not_met"]);
    // A value of a key, without its quotation marks.
    assert_eq!(desk.works(&["explain", "hertz"]).out, desk.works(&["explain", "\"hertz\""]).out);
    desk.refuses(&["explain", "zzz"], &["afmsweep explain"]);
}
