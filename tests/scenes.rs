//! Scene files: each one in `scenes/good` loads and survives its own echo; each one in `scenes/bad` is
//! refused with the words that its leading comments expect, and with its place.

use afmsweep::scene::*;
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
