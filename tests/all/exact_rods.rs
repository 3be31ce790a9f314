//! Rods and levers that all differ, each against the characteristic equation of its own.

use crate::continuum::{Continuum, close, hertz};
use afmsweep::design::Mix;
use afmsweep::instrument::{DEFAULT_TOLERANCE, Instrument, InstrumentError};
use afmsweep::scene::{DriveLevel, DriveOn, InstrumentParams, LeverSpec, TipMass};

const VOLTS: f64 = 15.0;

/// A rod and a lever of random dimensions and materials, a factor of three about those of Table 1, with tips from nothing to a
/// third of the lever.
fn any_geometry(number: u64) -> InstrumentParams {
    let place = std::cell::Cell::new(0);
    let share = || {
        place.set(place.get() + 1);
        Mix::new(23).of(number).of(place.get()).share()
    };
    let about = |value: &mut f64| *value *= 3f64.powf(2.0 * share() - 1.0);
    let mut p = InstrumentParams::default();
    let a = &mut p.actuator;
    [&mut a.length, &mut a.width, &mut a.thickness, &mut a.density].into_iter().for_each(about);
    // From half of the softening that makes it unstable to none.
    a.h33 *= share() * 1.3;
    if let LeverSpec::Dimensions { youngs_modulus, density, length, width, thickness } =
        &mut p.cantilever.lever
    {
        [&mut *youngs_modulus, &mut *density, &mut *length, &mut *width, &mut *thickness]
            .into_iter()
            .for_each(about);
        let mass = *density * *length * *width * *thickness;
        p.tip.mass = TipMass::Given(mass * share().powi(3) / 3.0);
        p.tip.half_length = 0.1 * share() * *length;
    }
    p
}

/// What modes are made of is of all rods and levers; each is held against the characteristic equation of its own.
#[test]
fn continuum_frequencies_of_rods_and_levers_that_all_differ() {
    let mut worst: f64 = 0.0;
    let mut looked_at = 0;
    for number in 0..400 {
        let p = any_geometry(number);
        let i = match Instrument::reduce(&p, DriveOn::Actuator, DEFAULT_TOLERANCE) {
            Err(InstrumentError::RodTooSlow { .. }) => continue,
            other => other.unwrap_or_else(|error| panic!("{number}: {error}")),
        };
        looked_at += 1;
        for (k, exact) in Continuum::new(&p).frequencies(6).iter().enumerate() {
            worst = worst.max((hertz(&i.modes[k]) / exact - 1.0).abs());
            close(hertz(&i.modes[k]), *exact, 1e-9, &format!("{number}, mode {}", k + 1));
        }
        let hz = 0.37 * i.lever_frequency;
        let c = Continuum::new(&p);
        let (tip, top) = c.forced(hz, VOLTS * c.force_per_volt, 0.0);
        let moved = i.free_motion(DriveLevel::Voltage(VOLTS), hz).unwrap();
        close(moved.tip.re, tip, 1e-6, &format!("{number}: tip under voltage"));
        close(moved.top.re, top, 1e-6, &format!("{number}: top under voltage"));
    }
    println!("{looked_at} rods and levers, frequencies off by {worst:.1e} at most");
    assert!(looked_at > 350, "{looked_at}");
}
