//! Which engine a command takes, and why.

use super::Voice;
use afmsweep::engine::gpu::{Gpu, adapters};
use afmsweep::engine::{Cpu, Engine, Reference};
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::Scene;

/// Which engine runs it, and how.
#[derive(clap::Args)]
pub struct EngineArgs {
    /// Engine; auto takes a real GPU where there is one and the run is long enough for it, else the CPU
    #[arg(long, value_enum, default_value_t = Backend::Auto)]
    backend: Backend,
    /// GPU adapter, by its index or a part of its name as `afmsweep devices` lists them
    #[arg(long, value_name = "ADAPTER")]
    device: Option<String>,
    /// Arithmetic of the inner loop [default: by a trial of both; where none is worth while f64, on a GPU f32 for accuracy
    /// 1e-3 or more]
    #[arg(long, value_enum)]
    precision: Option<PrecisionArg>,
    /// Steps per drive period for every instance, in place of the plan's choice
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(16..=1_000_000))]
    steps_per_period: Option<u32>,
    /// Threads of the CPU engine [default: all cores]
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

#[derive(Clone, Copy, clap::ValueEnum)]
enum PrecisionArg {
    F32,
    F64,
}

/// Instance-steps below which the CPU is done before a GPU is ready.
const SMALL: u64 = 200_000_000;
/// Accuracy asked for down to which f32 serves: its rounding shows at a tenth of it.
const SINGLE: f64 = 1e-3;

impl EngineArgs {
    /// The engine asked for; sets the plan's precision where it was left to the engine.
    pub fn engine(&self, plan: &mut Plan, voice: Voice) -> anyhow::Result<Box<dyn Engine>> {
        if self.device.is_some() && matches!(self.backend, Backend::Cpu | Backend::Reference) {
            anyhow::bail!("--device names a GPU adapter: use it with --backend gpu");
        }
        match (self.backend, &self.device) {
            (Backend::Cpu, _) => Ok(self.cpu()),
            (Backend::Reference, _) => {
                Ok(Box::new(Reference { threads: self.threads, ..Reference::default() }))
            }
            (Backend::Gpu, wanted) | (Backend::Auto, wanted @ Some(_)) => {
                self.gpu(wanted.as_deref(), plan, voice)
            }
            (Backend::Auto, None) if plan.instance_steps() < SMALL => {
                if voice.verbose {
                    voice.say("on the CPU: so short a run is done before a GPU is ready");
                }
                Ok(self.cpu())
            }
            (Backend::Auto, None) => self.best(plan, voice),
        }
    }

    fn cpu(&self) -> Box<dyn Engine> {
        Box::new(Cpu { threads: self.threads, ..Cpu::default() })
    }

    fn gpu(&self, wanted: Option<&str>, plan: &mut Plan, voice: Voice) -> anyhow::Result<Box<dyn Engine>> {
        let gpu = Gpu::new(wanted)?;
        if self.precision.is_none() && plan.run.accuracy >= SINGLE {
            plan.precision = Precision::F32;
        }
        if wanted.is_none() && gpu.report().software() {
            voice.say("the only GPU adapter is a software driver, which computes on the processor: --backend cpu is faster");
        }
        Ok(Box::new(gpu))
    }

    /// A real GPU if there is one, never a software driver.
    fn best(&self, plan: &mut Plan, voice: Voice) -> anyhow::Result<Box<dyn Engine>> {
        let found = adapters();
        let single = matches!(self.precision, Some(PrecisionArg::F32))
            || (self.precision.is_none() && plan.run.accuracy >= SINGLE);
        let real = found.iter().find(|one| !one.software() && (single || one.double));
        match real {
            Some(one) => self.gpu(Some(&one.index.to_string()), plan, voice),
            None => {
                let why = match found.iter().find(|one| !one.software()) {
                    Some(one) => format!("{} cannot compute in f64", one.name),
                    None => "no GPU found".into(),
                };
                voice.say(format_args!("{why}: running on the CPU"));
                Ok(self.cpu())
            }
        }
    }

    /// Whether the reference engine runs, which needs no control of its errors.
    pub fn reference(&self) -> bool {
        self.backend == Backend::Reference
    }

    /// The scene's plan with these arguments put in.
    pub fn plan(&self, scene: &mut Scene) -> anyhow::Result<Plan> {
        if self.steps_per_period.is_some() {
            scene.run.steps_per_period = self.steps_per_period;
        }
        let precision = match self.precision {
            Some(PrecisionArg::F32) => Precision::F32,
            Some(PrecisionArg::F64) | None => Precision::F64,
        };
        let plan = Plan::new(scene, precision).map_err(|error| error.in_scene(scene))?;
        Ok(Plan { precision_open: self.precision.is_none(), ..plan })
    }
}
