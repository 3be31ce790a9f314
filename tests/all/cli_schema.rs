//! `schema`, `completions` and `man`: what editors, shells and readers of manuals get.
//! Truth: the program's own lists, and the kept schema, which Python's jsonschema holds against all scenes
//! (`tests/python/check_schema.py`).

use crate::program::{Desk, scenes};
use afmsweep::Observable;
use afmsweep::scene::QUANTITIES;
use serde_json::Value;
use std::path::Path;

fn schema() -> Value {
    Desk::new().json(&["schema"])
}

/// After a change: `target/debug/afmsweep schema > scenes/scene.schema.json`.
#[test]
fn the_kept_schema_is_the_programs_own_and_every_scene_names_it() {
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/scene.schema.json");
    assert_eq!(std::fs::read_to_string(kept).unwrap(), Desk::new().works(&["schema"]).out);
    for path in scenes() {
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.starts_with("#:schema ./scene.schema.json\n"), "{}", path.display());
    }
}

#[test]
fn every_quantity_every_key_and_every_observable_is_in_the_schema_with_its_meaning() {
    let schema = schema();
    let means = |value: &Value, name: &str| {
        let text = value["description"].as_str().unwrap_or_default();
        assert!(text.len() > 10, "{name}: {value}");
    };
    for quantity in QUANTITIES {
        let name = quantity.path.replace('#', "N");
        let definition = &schema["definitions"][&name];
        means(definition, quantity.path);
        let (section, key) = quantity.path.rsplit_once('.').unwrap();
        if quantity.path.contains('#') {
            continue;
        }
        let home = section.split('.').fold(&schema, |place, word| &place["properties"][word]);
        let text = home["properties"][key].to_string();
        assert!(text.contains(&format!("#/definitions/{name}")), "{}: {text}", quantity.path);
        for varied in ["sweep", "samples"] {
            assert!(schema["properties"][varied]["properties"][quantity.path].is_object(), "{varied} {name}");
        }
    }
    // What reading says that the sections have.
    for section in ["run", "output"] {
        let said = Desk::new();
        said.write("odd.toml", &format!("[{section}]\nzzz = 1\n"));
        let text = said.refuses(&["plan", "odd.toml"], &["unknown key"]).err;
        let keys = schema["properties"][section]["properties"].as_object().unwrap();
        assert!(keys.keys().all(|key| text.contains(key.as_str())), "{section}: {text}");
        keys.iter().for_each(|(key, value)| means(value, key));
    }
    let observables = &schema["properties"]["output"]["properties"]["observables"]["items"]["enum"];
    let names: Vec<&str> = Observable::all().map(Observable::name).collect();
    assert_eq!(*observables, serde_json::json!(names));
}

#[test]
fn completions_and_the_manual_name_every_command() {
    let desk = Desk::new();
    let help = desk.works(&["--help"]).out;
    let (_, rest) = help.split_once("Commands:\n").unwrap();
    let (commands, _) = rest.split_once("\n\n").unwrap();
    let commands: Vec<&str> = commands.lines().filter_map(|line| line.split_whitespace().next()).collect();
    assert!(commands.len() >= 15, "{commands:?}");
    let manual = desk.works(&["man"]).out;
    for shell in ["bash", "zsh", "fish"] {
        let script = desk.works(&["completions", shell]).out;
        commands.iter().for_each(|command| assert!(script.contains(command), "{shell}: {command}"));
    }
    for command in commands.iter().filter(|command| **command != "help") {
        let heading = format!(".SH \"AFMSWEEP {}\"", command.to_uppercase());
        assert!(manual.contains(&heading), "{heading}");
        // Every command shows how it is called, with an example.
        let help = desk.works(&[command, "--help"]).out;
        assert!(help.contains("Example"), "{command} --help has no example: {help}");
    }
}
