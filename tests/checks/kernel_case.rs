//! Cases of the kernel, made without a plan: a lever, a free motion and a law whose force acts.

use afmsweep::contact::Law;
use afmsweep::kernel::{FlowMode, Lever};
use std::f64::consts::TAU;

/// Modes of a lever, slow and fast, one of them beyond its critical damping; frequencies in units of the drive's.
pub fn modes(count: usize) -> Vec<FlowMode> {
    let share = |k: usize| 1.0 / (1.0 + k as f64);
    let all: f64 = (0..count).map(share).sum();
    let mode = |k: usize| FlowMode {
        omega: 1.0 + 1.9 * k as f64,
        damping: if k % 6 == 5 { 1.2 } else { 0.5 / (10.0 + 5.0 * k as f64) },
        share: share(k) / all,
        fast_angle: 1.2,
    };
    (0..count).map(mode).collect()
}

/// A memory is a mode beside one of the lever's.
pub fn fewest(law: Law) -> usize {
    1 + usize::from(law.has_memory())
}

/// What an instance is, in the order of the kernel.
pub fn constants(law: Law, count: usize, filled: usize, steps: usize, i: usize) -> Vec<f64> {
    let step = TAU / steps as f64;
    // Of the modulus half relaxes; the memory is one of so many modes.
    let recovery = step / (0.3 + 0.1 * i as f64);
    let [left, mean] = [(-recovery).exp(), -(-recovery).exp_m1() / recovery];
    let bent = 0.5 * (1.0 + left) - mean;
    let lever = match law.has_memory() {
        true => Lever::new(&modes(count - 1), step, filled).remembering(recovery),
        false => Lever::new(&modes(count), step, filled),
    };
    // Of the mass: a force of 1 is that of the lever's spring at 1.
    let force = step * step;
    let of = |field: &&str| match *field {
        "stiffness" => force * 20.0 * 1.6f64.powi(i as i32 % 4),
        // Of all powers some.
        name if name.starts_with("force_") => force * 6.0 / (1.0 + f64::from(name.len() as u32)),
        "adhesion" => force * 0.4,
        "unit_force" => force * 0.8,
        "inverse_decay" => 3.3,
        "retardation" => 0.2 + 0.1 * i as f64,
        // Both forms of a viscous contact.
        "ad_hoc" => f64::from(i as u32 % 2),
        "relaxing" => 0.5,
        "left" => left,
        "mean_left" => mean,
        "gain" => 2.0 * (1.0 - left),
        "mean_gain" => 2.0 * (1.0 - mean),
        "rise_gain" => 2.0 * bent,
        "mean_rise_gain" => -2.0 * bent / recovery,
        // Each second one an exponential, and half of them pull.
        name if name.starts_with("table") => f64::from(u8::from(name.ends_with(['0', '2']))),
        "forms" => -0.1,
        "breaks" => -0.6,
        "scale_0" | "scale_3" => -0.3 * force,
        "scale_1" | "scale_2" => 0.2 * force,
        name if name == "inverse_unit" || name.starts_with("inverse_length_") => 2.5,
        name => panic!("give {name} a value for which the force acts"),
    };
    let law = law.fields().iter().map(of);
    let free = [19.0, 6.0, TAU / steps as f64, 19.2 - 0.37 * i as f64];
    lever.motion.iter().copied().chain(free).chain(law).chain(lever.energy.iter().copied()).collect()
}
