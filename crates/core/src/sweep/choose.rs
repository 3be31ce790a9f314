//! Which engine a sweep takes, and why.

use super::{Backend, Choice, Error, Observer, Options};
#[cfg(feature = "gpu")]
use crate::engine::EngineError;
#[cfg(feature = "gpu")]
use crate::engine::gpu::{Gpu, adapters, alike};
use crate::engine::{Cpu, Engine, Reference};
use crate::plan::Plan;
#[cfg(feature = "gpu")]
use crate::plan::Precision;

/// Instance-steps below which the CPU is done before a GPU is ready.
const SMALL: u64 = 200_000_000;
/// Accuracy asked for down to which f32 serves: its rounding shows at a tenth of it.
#[cfg(feature = "gpu")]
const SINGLE: f64 = 1e-3;

/// The engine asked for; sets the plan's precision where it was left to the engine.
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
        (Backend::Auto, None) if plan.instance_steps() < SMALL => {
            observer.chosen(&Choice::Short);
            Ok(Box::new(Cpu::default()))
        }
        (Backend::Auto, None) => best(options, plan, observer),
    }
}

/// GPUs that were asked for, by name or as any.
#[cfg(feature = "gpu")]
fn named(
    options: &Options,
    wanted: Option<&str>,
    plan: &mut Plan,
    observer: &dyn Observer,
) -> Result<Box<dyn Engine>, Error> {
    let gpu = gpu(options, wanted, plan)?;
    match wanted {
        None if gpu.report().software() => observer.chosen(&Choice::Software),
        None => others(&gpu, observer),
        Some("all") => left_out(&gpu, observer),
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
    observer.chosen(&Choice::NoGpu);
    Ok(Box::new(Cpu::default()))
}

#[cfg(feature = "gpu")]
fn gpu(options: &Options, wanted: Option<&str>, plan: &mut Plan) -> Result<Gpu, Error> {
    let gpu = Gpu::new(wanted).map_err(EngineError::from)?;
    if options.precision.is_none() && plan.run.accuracy >= SINGLE {
        plan.precision = Precision::F32;
    }
    Ok(gpu)
}

/// Tells of others of its kind.
#[cfg(feature = "gpu")]
fn others(gpu: &Gpu, observer: &dyn Observer) {
    if let Some(kind) = alike(&adapters()).into_iter().find(|kind| kind.contains(&gpu.report().index)) {
        observer.chosen(&Choice::OneOf(kind));
    }
}

/// Tells which real GPUs are of another kind than those that were asked for.
#[cfg(feature = "gpu")]
fn left_out(gpu: &Gpu, observer: &dyn Observer) {
    let mut others = adapters();
    others.retain(|one| !one.software() && one.title() != gpu.report().title());
    if !others.is_empty() {
        observer.chosen(&Choice::Without(others.iter().map(|one| one.title()).collect()));
    }
}

/// A real GPU if there is one, never a software driver.
#[cfg(feature = "gpu")]
fn best(options: &Options, plan: &mut Plan, observer: &dyn Observer) -> Result<Box<dyn Engine>, Error> {
    let found = adapters();
    let open = options.precision.is_none() && plan.run.accuracy >= SINGLE;
    let single = open || options.precision == Some(Precision::F32);
    if let Some(one) = found.iter().find(|one| !one.software() && (single || one.double)) {
        let gpu = gpu(options, Some(&one.index.to_string()), plan)?;
        others(&gpu, observer);
        return Ok(Box::new(gpu));
    }
    let real = found.iter().find(|one| !one.software());
    observer.chosen(&real.map_or(Choice::NoGpu, |one| Choice::NoDouble(one.name.clone())));
    Ok(Box::new(Cpu::default()))
}
