//! The program, run as a user runs it, and what its closing lines say.

use serde_json::Value;
use std::io::Read;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// A folder for scenes and results that goes with it.
pub struct Folder(tempfile::TempDir);

/// One run of the program.
#[derive(Clone, Debug)]
pub struct Run {
    pub instances: usize,
    /// As the program says: from its first look at the scene to the file, and of it stepping; s.
    pub wall: f64,
    pub stepping: f64,
    /// The whole process, s.
    pub outside: f64,
    /// Instance-steps per second.
    pub rate: f64,
    /// Largest memory held, where the system tells it.
    pub memory_mb: Option<f64>,
    pub largest_estimate: Option<f64>,
    /// Instances not called ok.
    pub doubtful: usize,
    /// What `--json` tells.
    pub told: Value,
}

impl Run {
    /// A number that `--json` tells, by its keys.
    pub fn number(&self, keys: &[&str]) -> Option<f64> {
        keys.iter().fold(&self.told, |value, key| &value[*key]).as_f64()
    }
}

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder for temporary files"))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Runs a scene.
    pub fn run(&self, scene: &str, options: &[&str]) -> Run {
        let path = self.path("scene.toml");
        std::fs::write(&path, scene).expect("a scene can be written");
        let start = Instant::now();
        let mut child = Command::new(env!("CARGO_BIN_EXE_afmsweep"))
            .arg("run")
            .arg(&path)
            .args(["--overwrite", "-o"])
            .arg(self.path("results.h5"))
            .args(options)
            .arg("--json")
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program can be started");
        let errors = read(child.stderr.take().expect("it is piped"));
        let object = read(child.stdout.take().expect("it is piped"));
        let mut memory: Option<f64> = None;
        let status = loop {
            if let Some(status) = child.try_wait().expect("a child can be waited for") {
                break status;
            }
            memory = peak(child.id()).or(memory);
            // Looking takes time of a core that the program wants.
            std::thread::sleep((start.elapsed() / 100).max(Duration::from_micros(500)));
        };
        let outside = start.elapsed().as_secs_f64();
        let text = errors.join().expect("the reader ends").expect("the program writes text");
        assert!(status.success(), "{text}");
        let object = object.join().expect("the reader ends").expect("the program writes text");
        let object = serde_json::from_str(&object).expect("the program writes one object");
        told(&text, object, (outside, memory))
    }
}

/// Reads to the end beside what else goes on.
fn read(mut from: impl Read + Send + 'static) -> JoinHandle<std::io::Result<String>> {
    std::thread::spawn(move || {
        let mut text = String::new();
        from.read_to_string(&mut text).map(|_| text)
    })
}

/// Largest resident memory of a process so far, MB.
fn peak(process: u32) -> Option<f64> {
    let text = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = text.lines().find(|line| line.starts_with("VmHWM"))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? / 1024.0)
}

fn told(text: &str, told: Value, (outside, memory_mb): (f64, Option<f64>)) -> Run {
    let before = |word: &str, line: &str| -> Option<f64> {
        let words: Vec<&str> = line.split(|c: char| c.is_whitespace() || c == '(' || c == ',').collect();
        let place = words.iter().position(|one| *one == word)?;
        words[..place].iter().rev().find_map(|one| one.parse().ok())
    };
    let wrote = text.lines().find(|line| line.starts_with("wrote ")).unwrap_or_else(|| panic!("{text}"));
    let first = text.lines().find(|line| line.contains(" instance")).unwrap_or_else(|| panic!("{text}"));
    let estimated = text.lines().find(|line| line.starts_with("estimated error"));
    let (_, closing) = wrote.rsplit_once(" in ").unwrap_or_else(|| panic!("{wrote}"));
    let number = |value: Option<f64>| value.unwrap_or_else(|| panic!("{wrote}"));
    Run {
        instances: number(before("instances", first).or(before("instance", first))) as usize,
        wall: number(before("s", closing)),
        stepping: number(told["stepping_time_s"].as_f64()),
        rate: number(told["instance_steps_per_second"].as_f64()),
        outside,
        memory_mb,
        told,
        largest_estimate: estimated.and_then(|line| before("of", line)),
        doubtful: text
            .lines()
            .filter(|line| line.contains(" marked "))
            .filter_map(|line| line.split_whitespace().next()?.parse::<usize>().ok())
            .sum(),
    }
}
