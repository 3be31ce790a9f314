//! The choice of a sweep's engine.

use super::{Backend, EngineChoice, Error, Observer, Options};
#[cfg(feature = "gpu")]
use crate::engine::EngineError;
#[cfg(feature = "gpu")]
use crate::engine::gpu::{Gpu, adapters, alike};
use crate::engine::{Cpu, Engine, Reference};
use crate::plan::Plan;
#[cfg(feature = "gpu")]
use crate::plan::Precision;
use crate::scene::Steady;

/// With fewer instance-steps the CPU is done before a GPU is ready.
const GPU_MIN_INSTANCE_STEPS: u64 = 200_000_000;
/// Least accuracy for f32: rounding is visible at a tenth of it.
#[cfg(feature = "gpu")]
const F32_MIN_ACCURACY: f64 = 1e-3;

/// The requested engine. Sets the plan's precision if that is left to the engine.
pub(super) fn engine(
    options: &Options,
    plan: &mut Plan,
    observer: &dyn Observer,
) -> Result<Box<dyn Engine>, Error> {
    match (options.backend, &options.device) {
        (Backend::Cpu, _) => Ok(Box::new(Cpu::default())),
        (Backend::Reference, _) => Ok(Box::new(Reference::default())),
        (Backend::Gpu, wanted) | (Backend::Auto, wanted @ Some(_)) => {
            named(options, wanted.as_deref(), plan, observer)
        }
        (Backend::Auto, None) if plan.instance_steps() < GPU_MIN_INSTANCE_STEPS => {
            observer.chosen(&EngineChoice::Short);
            Ok(Box::new(Cpu::default()))
        }
        // 100,000 searched DMT cases took 3.8 s on an H200, 0.2 s on 16 threads (results/bench/nvidia-h200).
        (Backend::Auto, None) if plan.run.steady == Steady::Search => {
            observer.chosen(&EngineChoice::Searched);
            Ok(Box::new(Cpu::default()))
        }
        (Backend::Auto, None) => best(options, plan, observer),
    }
}

/// The requested GPUs, by name or any.
#[cfg(feature = "gpu")]
fn named(
    options: &Options,
    wanted: Option<&str>,
    plan: &mut Plan,
    observer: &dyn Observer,
) -> Result<Box<dyn Engine>, Error> {
    let gpu = gpu(options, wanted, plan)?;
    match wanted {
        None if gpu.report().software() => observer.chosen(&EngineChoice::Software),
        None => others(&gpu, observer),
        Some("all") => unused_kinds(&gpu, observer),
        Some(_) => {}
    }
    Ok(Box::new(gpu))
}

#[cfg(not(feature = "gpu"))]
fn named(_: &Options, _: Option<&str>, _: &mut Plan, _: &dyn Observer) -> Result<Box<dyn Engine>, Error> {
    Err(Error::NoGpuEngine)
}

#[cfg(not(feature = "gpu"))]
fn best(_: &Options, _: &mut Plan, observer: &dyn Observer) -> Result<Box<dyn Engine>, Error> {
    observer.chosen(&EngineChoice::NoGpu);
    Ok(Box::new(Cpu::default()))
}

#[cfg(feature = "gpu")]
fn gpu(options: &Options, wanted: Option<&str>, plan: &mut Plan) -> Result<Gpu, Error> {
    let gpu = Gpu::new(wanted).map_err(EngineError::from)?;
    if options.precision.is_none() && plan.run.accuracy >= F32_MIN_ACCURACY {
        plan.precision = Precision::F32;
    }
    Ok(gpu)
}

/// Reports the other GPUs of its kind.
#[cfg(feature = "gpu")]
fn others(gpu: &Gpu, observer: &dyn Observer) {
    if let Some(kind) = alike(&adapters()).into_iter().find(|kind| kind.contains(&gpu.report().index)) {
        observer.chosen(&EngineChoice::OneOf(kind));
    }
}

/// Reports real GPUs of another kind than the requested ones.
#[cfg(feature = "gpu")]
fn unused_kinds(gpu: &Gpu, observer: &dyn Observer) {
    let mut others = adapters();
    others.retain(|one| !one.software() && one.title() != gpu.report().title());
    if !others.is_empty() {
        observer.chosen(&EngineChoice::Without(others.iter().map(|one| one.title()).collect()));
    }
}

/// A real GPU if there is one, never a software driver.
#[cfg(feature = "gpu")]
fn best(options: &Options, plan: &mut Plan, observer: &dyn Observer) -> Result<Box<dyn Engine>, Error> {
    let found = adapters();
    let open = options.precision.is_none() && plan.run.accuracy >= F32_MIN_ACCURACY;
    let single = open || options.precision == Some(Precision::F32);
    if let Some(one) = found.iter().find(|one| !one.software() && (single || one.double)) {
        let gpu = gpu(options, Some(&one.index.to_string()), plan)?;
        others(&gpu, observer);
        return Ok(Box::new(gpu));
    }
    let real = found.iter().find(|one| !one.software());
    observer.chosen(&real.map_or(EngineChoice::NoGpu, |one| EngineChoice::NoDouble(one.name.clone())));
    Ok(Box::new(Cpu::default()))
}
