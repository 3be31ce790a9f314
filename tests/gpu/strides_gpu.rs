//! Searches that begin where something is known of the period map, by the shader against the CPU's: every law, few and many
//! modes; devices that fail on the way; and whole sweeps that begin at neighbours' states.
//!
//! Where a driver computes on the processor the bits are the same, elsewhere the numbers agree to rounding. Without an adapter
//! that computes in f64 these tests are listed as ignored.

use crate::checks;
use crate::shader::{self, CORNERS, gpu, laws, scene};
use afmsweep::control;
use afmsweep::engine::gpu::AdapterReport;
use afmsweep::engine::{Correction, Corrections, Cpu, Engine, Prediction, Predictions, Progress};
use afmsweep::kernel::broyden::{Phase, ROUNDS, state_modes};
use afmsweep::plan::{Plan, Precision, SectionState, StartState};
use afmsweep::scene::Scene;
use libtest_mimic::{Failed, Trial};
use std::path::Path;

/// Periods before the search: some instances are then next to their states, others are not.
pub const WARM: [u32; 2] = [12, 48];

/// A plan, and guesses at the states of its instances: where they are after some periods, with the slopes there.
pub fn guessed(law: &str, modes: usize, warm: u32) -> (Plan, Predictions) {
    let steps = if modes > 4 { 512 } else { 128 };
    let plan = checks::plan_in(&scene(law, "steady", modes, steps, 20), None, Precision::F64);
    let plan = plan.stepping_all(steps);
    let places = shader::after(&plan, warm);
    let once = shader::from_there(&plan, &places);
    let least = vec![0.0; plan.len()];
    let slopes =
        Cpu { strict: true }.slopes(&once, &least, &Progress::default()).expect("slopes are told").all;
    let modes = plan.pairs(0);
    let padded = state_modes(modes);
    let mut guesses = Predictions::new(2 * padded, 1e-6, 3e-5);
    for (i, (place, slope)) in places.iter().zip(slopes).enumerate() {
        let state = [&place.x[..padded], &place.u[..padded]].concat();
        let undoes = undoing(&slope.expect("it was not stopped").slope, modes, padded);
        let scale = plan.driven(i as u32).free_amplitude();
        guesses.push(Prediction { instance: i as u32, touching: place.touching, scale }, &state, &undoes);
    }
    (plan, guesses)
}

/// The inverse of one minus a slope, column by column, filled up with modes at rest, by Gauss and Jordan.
fn undoing(slope: &[f64], modes: usize, padded: usize) -> Vec<f64> {
    let (own, n) = (2 * modes, 2 * padded);
    let place = |k: usize| if k < modes { k } else { padded + k - modes };
    let mut rows: Vec<Vec<f64>> =
        (0..n).map(|i| (0..2 * n).map(|j| f64::from(u8::from(i == j % n))).collect()).collect();
    for column in 0..own {
        for row in 0..own {
            rows[place(row)][place(column)] -= slope[column * own + row];
        }
    }
    for k in 0..n {
        let pivot =
            (k..n).max_by(|a, b| rows[*a][k].abs().total_cmp(&rows[*b][k].abs())).expect("there is one");
        rows.swap(k, pivot);
        let largest = rows[k][k];
        rows[k].iter_mut().for_each(|value| *value /= largest);
        let above = rows[k].clone();
        for (_, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let factor = row[k];
            row.iter_mut().zip(&above).for_each(|(value, above)| *value -= factor * above);
        }
    }
    (0..n * n).map(|entry| rows[entry % n][n + entry / n]).collect()
}

/// Guesses after a search, and what became of them.
pub type Ends = (Predictions, Corrections);

pub fn led(engine: &dyn Engine, (plan, guesses): &(Plan, Predictions)) -> Ends {
    let mut guesses = guesses.clone();
    let arrivals = engine.broyden(plan, &mut guesses, &Progress::default()).expect("it runs");
    (guesses, arrivals)
}

/// Everything of an end, to the bit; of what is not found no result.
fn bits((guesses, arrivals): &Ends, n: usize) -> Vec<u64> {
    let Correction { phase, periods, finished, touching } = &arrivals.all[n];
    let numbers = guesses.place(n).iter().chain(guesses.undoes(n)).map(|value| value.to_bits());
    numbers
        .chain([*phase as u64, u64::from(*periods), u64::from(*touching)])
        .chain(shader::bits(finished))
        .collect()
}

/// How many ends are the same; an error where one is not.
pub fn same(ours: &Ends, theirs: &Ends, what: &str) -> Result<usize, Failed> {
    let count = theirs.1.all.len();
    assert_eq!(ours.1.all.len(), count);
    match (0..count).find(|n| bits(ours, *n) != bits(theirs, *n)) {
        None => Ok(count),
        Some(n) => {
            let show = |ends: &Ends| format!("{:?} {:?}", ends.1.all[n], ends.0.place(n));
            Err(format!("{what}, instance {n}:\n{}\n{}", show(ours), show(theirs)).into())
        }
    }
}

/// How many have each phase.
fn phases(ends: &Ends) -> [usize; 3] {
    let count = |phase: Phase| ends.1.all.iter().filter(|one| one.phase == phase).count();
    [Phase::On, Phase::Found, Phase::Lost].map(count)
}

fn same_bits(modes: usize) -> Result<(), Failed> {
    let (gpu, cpu) = (gpu(), Cpu { strict: true });
    assert!(gpu.strict);
    let (mut all, mut ended) = (0, [0; 3]);
    let mut rounds = [0; ROUNDS as usize + 1];
    for law in laws() {
        for warm in WARM {
            let begun = guessed(law, modes, warm);
            let what = format!("{law}, {modes} modes, after {warm} periods");
            let (ours, theirs) = (led(&gpu, &begun), led(&cpu, &begun));
            assert!(ours.1.notes.is_empty(), "{what}: {:?}", ours.1.notes);
            all += same(&ours, &theirs, &what)?;
            ended.iter_mut().zip(phases(&theirs)).for_each(|(all, some)| *all += some);
            theirs.1.all.iter().for_each(|one| rounds[one.periods as usize] += 1);
        }
    }
    println!(
        "{modes} modes: {all} of {all} identical, {ended:?} on, found, lost, after 0 to {ROUNDS} periods {rounds:?}"
    );
    assert!(ended[1] > all / 4 && ended[2] > 0, "{ended:?}");
    assert!(rounds[1..4].iter().all(|count| *count > 0) && rounds[0] == 0, "{rounds:?}");
    Ok(())
}

/// Truth: running on from what was found leads nowhere else.
fn what_is_found_is_periodic() -> Result<(), Failed> {
    let begun = guessed("dmt", 3, WARM[1]);
    let (guesses, arrivals) = led(&gpu(), &begun);
    let found: Vec<usize> =
        (0..arrivals.all.len()).filter(|n| arrivals.all[*n].phase == Phase::Found).collect();
    let instances: Vec<u32> = found.iter().map(|n| *n as u32).collect();
    let station = |n: &usize| {
        let (x, u) = guesses.place(*n).split_at(guesses.numbers / 2);
        let mut station = SectionState { touching: guesses.all[*n].touching, ..SectionState::FREE };
        station.x[..x.len()].copy_from_slice(x);
        station.u[..u.len()].copy_from_slice(u);
        station
    };
    let starts: Vec<SectionState> = found.iter().map(station).collect();
    let on =
        begun.0.trial(&instances, 40, 1).starting_at(starts.iter().copied().map(StartState::from).collect());
    let ends = Cpu::default().run(&on, &Progress::default()).expect("it runs").ends;
    let mut farthest: f64 = 0.0;
    for (start, (end, n)) in starts.iter().zip(ends.iter().zip(&found)) {
        let end = end.as_ref().expect("it was stepped");
        let off = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        let apart = (off(&start.x, &end.x) + off(&start.u, &end.u)).sqrt() / guesses.all[*n].scale;
        farthest = farthest.max(apart);
    }
    println!("{} found, 40 periods later at most {farthest:.1e} free amplitudes away", found.len());
    assert!(found.len() > 10 && farthest < 1e-4, "{farthest:e}");
    Ok(())
}

/// Pieces and dispatches, however small, change no bit.
fn pieces_change_no_bit() -> Result<(), Failed> {
    for law in ["dmt", "jkr"] {
        let begun = guessed(law, 2, WARM[0]);
        let whole = led(&Cpu { strict: true }, &begun);
        for chunk in [1, 7, 29] {
            let mut small = gpu();
            small.chunk = Some(chunk);
            let ours = led(&small, &begun);
            assert!(ours.1.notes.is_empty(), "{:?}", ours.1.notes);
            same(&ours, &whole, &format!("{law}, pieces of {chunk}"))?;
        }
        // Some of a plan, in another order.
        let mut some = Predictions::new(begun.1.numbers, begun.1.near, begun.1.sure);
        let order: Vec<usize> = (0..begun.1.all.len()).rev().step_by(2).collect();
        order.iter().for_each(|n| some.push(begun.1.all[*n], begun.1.place(*n), begun.1.undoes(*n)));
        let part = led(&gpu(), &(begun.0.clone(), some));
        for (k, n) in order.into_iter().enumerate() {
            assert_eq!(bits(&part, k), bits(&whole, n), "{law}, instance {n}");
        }
    }
    Ok(())
}

/// A period longer than the loops that lavapipe can do in one dispatch goes in parts.
fn long_periods_go_in_parts() -> Result<(), Failed> {
    let (steps, count) = (70_000, 6);
    let plan =
        checks::plan_in(&scene("dmt", "steady", 1, steps, 6), None, Precision::F64).stepping_all(steps);
    let mut guesses = Predictions::new(2, 1e-6, 3e-5);
    for i in plan.instances().step_by(4).take(count) {
        let guess = Prediction { instance: i, touching: false, scale: plan.driven(i).free_amplitude() };
        // What the free lever's own decay tells of the map.
        guesses.push(guess, &[0.0; 2], &[10.0, 0.0, 0.0, 10.0]);
    }
    let begun = (plan, guesses);
    let ours = led(&gpu(), &begun);
    assert!(ours.1.notes.is_empty(), "{:?}", ours.1.notes);
    same(&ours, &led(&Cpu { strict: true }, &begun), "70,000 steps a period")?;
    assert!(ours.1.all.iter().any(|one| one.periods > 1), "{:?}", ours.1.all);
    Ok(())
}

fn a_lost_device_changes_no_bit() -> Result<(), Failed> {
    let begun = guessed("jkr", 3, WARM[0]);
    let whole = led(&Cpu { strict: true }, &begun);
    for (at, times, words) in [(1, 1, "new device"), (5, 1, "new device"), (3, u32::MAX, "on the CPU")] {
        let mut frail = gpu();
        (frail.drill.lose_at, frail.drill.times) = (Some(at), times);
        let ours = led(&frail, &begun);
        let notes = ours.1.notes.join("; ");
        assert!(notes.contains("device was lost") && notes.contains(words), "{notes}");
        same(&ours, &whole, &format!("lost {times} times at dispatch {at}"))?;
    }
    let mut small = gpu();
    small.drill.memory_for = Some(5);
    let ours = led(&small, &begun);
    assert!(ours.1.notes.iter().any(|note| note.contains("out of memory")), "{:?}", ours.1.notes);
    same(&ours, &whole, "halved")?;
    Ok(())
}

/// A run that is stopped has no ends.
fn a_stopped_search_has_no_ends() -> Result<(), Failed> {
    let (plan, mut guesses) = guessed("dmt", 1, WARM[0]);
    let (before, progress) = (guesses.clone(), Progress::default());
    progress.stop();
    let arrivals = gpu().broyden(&plan, &mut guesses, &progress)?;
    assert!(arrivals.all.iter().all(|one| one.phase == Phase::On && one.periods == 0));
    assert_eq!((guesses.places, guesses.undoes), (before.places, before.undoes));
    Ok(())
}

/// The same to rounding, where the driver may fuse and reorder: of nearly all instances, since a step's last bits may decide
/// on which branch of a law it is.
fn agrees() -> Result<(), Failed> {
    for law in laws() {
        let begun = guessed(law, 2, WARM[1]);
        let mut free = gpu();
        free.strict = false;
        let (ours, theirs) = (led(&free, &begun), led(&Cpu { strict: true }, &begun));
        let near = |n: &usize| {
            let (a, b) = (&ours.1.all[*n], &theirs.1.all[*n]);
            let scale = begun.1.all[*n].scale;
            let apart = ours.0.place(*n).iter().zip(theirs.0.place(*n)).map(|(a, b)| (a - b).abs() / scale);
            a.phase == b.phase && a.periods == b.periods && apart.fold(0.0, f64::max) < 1e-9
        };
        let (count, alike) = (ours.1.all.len(), (0..ours.1.all.len()).filter(near).count());
        println!("{law}: {alike} of {count} alike");
        assert!(10 * alike >= 9 * count, "{law}: {alike} of {count}");
    }
    Ok(())
}

/// 1,600 instances of two modes, enough to begin at one another's states.
const SWEEP: &str = r#"
[instrument.cantilever]
modes = [{ stiffness = "26 N/m", frequency = "300 kHz", quality_factor = 100 }, { stiffness = "1000 N/m", frequency = "1880 kHz", quality_factor = 150 }]
[contact]
law = "LAW"
[sample]
surface_energy = "30 mJ/m^2"
[drive]
on = "tip"
frequency = "300 kHz"
free_amplitude = "20 nm"
[sweep]
"sample.youngs_modulus" = { from = "0.5 GPa", to = "5 GPa", points = 40, scale = "log" }
"approach.gap" = { from = "12 nm", to = "16 nm", points = 40 }
[run]
steady = "search"
periods = 600
[output]
observables = ["amplitude", "phase", "force_max"]
"#;

/// A whole sweep whose instances begin at their neighbours' states: on the device as on the CPU, and the strides are the
/// device's.
fn sweeps_as_the_cpu_does() -> Result<(), Failed> {
    for law in ["dmt", "jkr"] {
        let scene = Scene::parse(Path::new("sweep.toml"), &SWEEP.replace("LAW", law))?;
        let plan = checks::plan_in(&scene, None, Precision::F64);
        let run = |engine: &dyn Engine| control::run(&plan, engine, &Progress::default()).expect("it runs");
        let bits = |ran: &control::RunResult| -> Vec<Vec<u64>> {
            let one = |(finished, estimate): (_, &f64)| {
                [shader::bits(&finished), vec![estimate.to_bits()]].concat()
            };
            ran.results.iter().zip(&ran.estimates).map(one).collect()
        };
        let (ours, theirs) = (run(&gpu()), run(&Cpu { strict: true }));
        let (a, b) = (bits(&ours), bits(&theirs));
        let other = a.iter().zip(&b).filter(|(a, b)| a != b).count();
        assert_eq!((other, a.len()), (0, plan.len()), "{law}");
        assert_eq!(ours.periods, theirs.periods);
        let started = theirs.neighbour_started();
        println!("{law}: {} instances identical, {started:.3} begun at neighbours", a.len());
        assert!(started > 0.7, "{law}: {started}");
        // Where strides lead back instead, more instances are left to a search of their own.
        let mut faulty = gpu();
        faulty.drill.edit =
            Some(|text| text.replace("places[at(k, i)] + next[k]", "places[at(k, i)] - next[k]"));
        assert!(run(&faulty).neighbour_started() < started, "{law}: the strides are not the device's");
    }
    Ok(())
}

/// The tests of this file, of which those run that the adapters found can run.
pub fn tests(found: &[AdapterReport]) -> Vec<Trial> {
    let double = found.iter().any(|one| one.double);
    let exact = shader::exact(found) && double;
    let mut tests = Vec::new();
    let mut add = |name: &str, runs: bool, test: Box<dyn FnOnce() -> Result<(), Failed> + Send>| {
        tests.push(Trial::test(format!("strides_{name}"), test).with_ignored_flag(!runs));
    };
    for modes in [1, 2, 3, 4, 5, 6, 8, 10, 16, 24] {
        let name = format!("same_bits_as_the_cpu_{modes}_modes");
        add(&name, exact && CORNERS.contains(&modes), Box::new(move || same_bits(modes)));
    }
    add("agree_with_the_cpu_to_rounding", double, Box::new(agrees));
    add("end_at_periodic_states", double, Box::new(what_is_found_is_periodic));
    add("pieces_change_no_bit", exact, Box::new(pieces_change_no_bit));
    add("long_periods_go_in_parts", exact, Box::new(long_periods_go_in_parts));
    add("a_lost_device_changes_no_bit", exact, Box::new(a_lost_device_changes_no_bit));
    add("a_stopped_search_has_no_ends", double, Box::new(a_stopped_search_has_no_ends));
    add("sweeps_as_the_cpu_does", exact, Box::new(sweeps_as_the_cpu_does));
    tests
}
