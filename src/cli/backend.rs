//! Which engine a command takes, and why.

use super::Verbosity;
use afmsweep::sweep::{self, EngineChoice};
use afmsweep::{Precision, Scene, Sweep};
use clap::builder::{PossibleValuesParser, TypedValueParser};

/// Which engine runs it, and how.
#[derive(clap::Args)]
pub struct EngineArgs {
    /// Engine; auto takes a real GPU where there is one and the run is integrated and long enough for it, else the CPU
    #[arg(long, value_enum, default_value_t = Backend::Auto)]
    backend: Backend,
    /// GPU adapter, by its index or a part of its name as `afmsweep devices` lists them; several of one kind as 0,1, or all
    /// of the best one's kind
    #[arg(long, value_name = "ADAPTER")]
    device: Option<String>,
    /// Arithmetic of the inner loop [default: by a trial of both; where none is worth while f64, on a GPU f32 for accuracy
    /// 1e-3 or more]
    #[arg(long, value_parser = PossibleValuesParser::new(["f32", "f64"]).map(precision))]
    precision: Option<Precision>,
    /// Steps per drive period for every instance, in place of the plan's choice
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(16..=1_000_000))]
    steps_per_period: Option<u32>,
    /// Threads of the whole run [default: all cores]
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    threads: Option<usize>,
}

pub(super) fn parse_threads(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(threads @ 1..=1024) => Ok(threads),
        _ => Err("expected a whole number from 1 to 1024".into()),
    }
}

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Backend {
    Auto,
    Gpu,
    Cpu,
    /// Adaptive, contact events located: slow and exact
    Reference,
}

fn precision(word: String) -> Precision {
    if word == "f32" { Precision::F32 } else { Precision::F64 }
}

impl EngineArgs {
    /// Whether the reference engine runs, which needs no control of its errors.
    pub fn reference(&self) -> bool {
        self.backend == Backend::Reference
    }

    /// The sweep of a scene with these arguments put in.
    pub fn sweep(&self, scene: Scene) -> anyhow::Result<Sweep> {
        if self.device.is_some() && matches!(self.backend, Backend::Cpu | Backend::Reference) {
            anyhow::bail!("--device names a GPU adapter: use it with --backend gpu");
        }
        let backend = match self.backend {
            Backend::Auto => sweep::Backend::Auto,
            Backend::Gpu => sweep::Backend::Gpu,
            Backend::Cpu => sweep::Backend::Cpu,
            Backend::Reference => sweep::Backend::Reference,
        };
        Ok(Sweep::new(scene)
            .backend(backend)
            .device(self.device.clone())
            .precision(self.precision)
            .threads(self.threads)
            .steps_per_period(self.steps_per_period))
    }
}

/// Why an engine was taken that was not named.
pub(super) fn say_choice(choice: &EngineChoice, voice: Verbosity) {
    match told(choice) {
        (_, true) if !voice.verbose => {}
        (line, _) => voice.say(line),
    }
}

/// Why an engine was taken that was not named, and whether that is a detail.
pub fn told(choice: &EngineChoice) -> (String, bool) {
    match choice {
        EngineChoice::Short => ("on the CPU: so short a run is done before a GPU is ready".into(), true),
        EngineChoice::Searched => {
            ("on the CPU: of a search there is too little to step for a GPU to be ahead".into(), true)
        }
        EngineChoice::NoGpu => ("no hardware GPU found: running on the CPU".into(), false),
        EngineChoice::NoDouble(name) => {
            (format!("{name} cannot compute in f64: running on the CPU"), false)
        }
        EngineChoice::OneOf(indices) => {
            let all = indices.iter().map(ToString::to_string).collect::<Vec<_>>().join(",");
            let line = format!(
                "on one of {} GPUs of its kind: --device all, or --device {all}, runs on all of them",
                indices.len()
            );
            (line, false)
        }
        EngineChoice::Without(others) => {
            (format!("on all GPUs of one kind, without those of another: {}", others.join("; ")), false)
        }
        EngineChoice::Software => (
            "the only GPU adapter is a software driver, which computes on the processor: --backend cpu is faster".into(),
            false,
        ),
        other => (format!("{other:?}"), true),
    }
}
