//! Searches by Newton's steps, whole on the device, against the CPU's: every law, few and many modes; devices that fail on the way;
//! and grids of tapping cases, whose states are those that rounds on the host find.
//!
//! Where a driver computes on the processor the bits are the same, elsewhere the numbers agree to rounding. Without an adapter
//! that computes in f64 these tests are listed as ignored.

use crate::checks;
use crate::shader::{self, gpu, laws, scene};
use afmsweep::engine::gpu::AdapterReport;
use afmsweep::engine::{
    Cpu, Engine, NewtonResult, NewtonResults, NewtonStart, NewtonStarts, PeriodJacobian, Progress,
};
use afmsweep::kernel::broyden::Phase;
use afmsweep::kernel::newton::ROUNDS;
use afmsweep::orbit::{self, OrbitSolution};
use afmsweep::plan::{Plan, Precision, SectionState, StartState};
use afmsweep::scene::Scene;
use libtest_mimic::{Failed, Trial};
use std::path::Path;

/// Periods before the search: the instances are far from their states, or near to them.
pub const WARM: [u32; 2] = [3, 32];

/// A plan of 30 instances under a law: see [`begun_in`].
pub fn begun(law: &str, modes: usize, warm: u32) -> (Plan, NewtonStarts) {
    let steps = if modes > 4 { 512 } else { 128 };
    let plan = checks::plan_in(&scene(law, "steady", modes, steps, 20), None, Precision::F64);
    begun_in(&plan.stepping_all(steps), warm)
}

/// A small swing that adhesion holds to the sample, mostly.
pub fn held() -> (Plan, NewtonStarts) {
    let text = GRID.replace("LAW", "jkr").replace("20 nm", "0.5 nm").replace("8 nm", "-2 nm");
    let scene =
        Scene::parse(Path::new("held.toml"), &text.replace("19.5 nm", "2 nm")).expect("it is a scene");
    begun_in(&checks::plan_in(&scene, None, Precision::F64).stepping_all(256), WARM[0])
}

/// A plan whose instances begin where they are after some periods, and searches from there: of every third instance the first
/// stride is Newton's.
pub fn begun_in(plan: &Plan, warm: u32) -> (Plan, NewtonStarts) {
    let seek = |i: u32| {
        let time = if i.is_multiple_of(3) { f64::INFINITY } else { 20.0 };
        NewtonStart { scale: plan.driven(i).free_amplitude(), time, least: 1e-6 }
    };
    let seeks = NewtonStarts { near: 1e-6, enough: 1e-4, all: plan.instances().map(seek).collect() };
    (shader::from_there(plan, &shader::after(plan, warm)), seeks)
}

pub fn sought(engine: &dyn Engine, (plan, seeks): &(Plan, NewtonStarts)) -> NewtonResults {
    engine.newton(plan, seeks, &Progress::default()).expect("it runs")
}

/// Everything of an end, to the bit.
fn bits(one: &NewtonResult) -> Vec<u64> {
    let found = one.found.iter().flat_map(|PeriodJacobian { end, slope }| {
        let numbers = end.x.iter().chain(&end.u).chain(slope.iter()).map(|value| value.to_bits());
        numbers.chain([u64::from(end.touching), u64::from(end.finite)]).collect::<Vec<u64>>()
    });
    [one.phase as u64, u64::from(one.periods)].into_iter().chain(found).collect()
}

/// How many ends are the same; an error where one is not.
pub fn same(ours: &NewtonResults, theirs: &NewtonResults, what: &str) -> Result<usize, Failed> {
    let count = theirs.all.len();
    assert_eq!(ours.all.len(), count);
    match (0..count).find(|n| bits(&ours.all[*n]) != bits(&theirs.all[*n])) {
        None => Ok(count),
        Some(n) => Err(format!("{what}, instance {n}:\n{:?}\n{:?}", ours.all[n], theirs.all[n]).into()),
    }
}

/// The same searches in f32, which are over where f64 takes them on.
fn in_f32((plan, seeks): (Plan, NewtonStarts)) -> (Plan, NewtonStarts) {
    (plan.in_precision(Precision::F32), NewtonStarts { near: 1e-3, enough: 1e-2, ..seeks })
}

/// How many have each phase.
fn phases(searches: &NewtonResults) -> [usize; 3] {
    let count = |phase: Phase| searches.all.iter().filter(|one| one.phase == phase).count();
    [Phase::On, Phase::Found, Phase::Lost].map(count)
}

fn same_bits(modes: usize, precision: Precision) -> Result<(), Failed> {
    let (gpu, cpu) = (gpu(), Cpu { strict: true });
    assert!(gpu.strict);
    let (mut all, mut ended) = (0, [0; 3]);
    // Of what is found, by periods.
    let (mut one, mut few, mut many) = (0, 0, 0);
    for law in laws() {
        for warm in WARM {
            let begun = begun(law, modes, warm);
            let begun = if precision == Precision::F32 { in_f32(begun) } else { begun };
            let what = format!("{law}, {modes} modes, {}, after {warm} periods", precision.name());
            let (ours, theirs) = (sought(&gpu, &begun), sought(&cpu, &begun));
            assert!(ours.notes.is_empty(), "{what}: {:?}", ours.notes);
            all += same(&ours, &theirs, &what)?;
            ended.iter_mut().zip(phases(&theirs)).for_each(|(all, some)| *all += some);
            let found = theirs.all.iter().filter(|one| one.phase == Phase::Found);
            found.for_each(|sought| match sought.periods {
                0..=1 => one += 1,
                2..=12 => few += 1,
                _ => many += 1,
            });
        }
    }
    println!(
        "{modes} modes, {}: {all} of {all} identical, {ended:?} on, found, lost; of those found {one} in a period, {few} in 2 to 12, {many} in up to {ROUNDS}",
        precision.name()
    );
    assert!(ended[1] > all / 2 && one > 0 && few > all / 4, "{ended:?}, {one}, {few}");
    assert!(precision == Precision::F32 || ended[0] > 0 && ended[2] > 0 && many > 0, "{ended:?}, {many}");
    Ok(())
}

/// Pieces, however small, change no bit.
fn pieces_change_no_bit() -> Result<(), Failed> {
    for law in ["dmt", "jkr"] {
        let begun = begun(law, 2, WARM[0]);
        let whole = sought(&Cpu { strict: true }, &begun);
        for chunk in [1, 7, 29] {
            let mut small = gpu();
            small.chunk = Some(chunk);
            let ours = sought(&small, &begun);
            assert!(ours.notes.is_empty(), "{:?}", ours.notes);
            same(&ours, &whole, &format!("{law}, pieces of {chunk}"))?;
        }
    }
    Ok(())
}

/// A period longer than the loops that lavapipe can do in one dispatch goes in parts.
fn long_periods_go_in_parts() -> Result<(), Failed> {
    let steps = 70_000;
    let plan =
        checks::plan_in(&scene("dmt", "steady", 1, steps, 6), None, Precision::F64).stepping_all(steps);
    let all: Vec<u32> = plan.instances().step_by(4).take(4).collect();
    let seek = |i: &u32| NewtonStart { scale: plan.driven(*i).free_amplitude(), time: 20.0, least: 1e-6 };
    let seeks = NewtonStarts { near: 1e-6, enough: 1e-4, all: all.iter().map(seek).collect() };
    let begun =
        (plan.trial(&all, 1, 1).starting_at(vec![StartState::from(SectionState::FREE); all.len()]), seeks);
    let ours = sought(&gpu(), &begun);
    assert!(ours.notes.is_empty(), "{:?}", ours.notes);
    same(&ours, &sought(&Cpu { strict: true }, &begun), "70,000 steps a period")?;
    assert!(ours.all.iter().any(|one| one.phase == Phase::Found && one.periods > 1), "{:?}", phases(&ours));
    Ok(())
}

fn a_lost_device_changes_no_bit() -> Result<(), Failed> {
    let begun = begun("jkr", 3, WARM[0]);
    let whole = sought(&Cpu { strict: true }, &begun);
    for (at, times, words) in [(1, 1, "new device"), (5, 1, "new device"), (3, u32::MAX, "on the CPU")] {
        let mut frail = gpu();
        (frail.drill.lose_at, frail.drill.times) = (Some(at), times);
        let ours = sought(&frail, &begun);
        let notes = ours.notes.join("; ");
        assert!(notes.contains("device was lost") && notes.contains(words), "{notes}");
        same(&ours, &whole, &format!("lost {times} times at dispatch {at}"))?;
    }
    let mut small = gpu();
    small.drill.memory_for = Some(5);
    let ours = sought(&small, &begun);
    assert!(ours.notes.iter().any(|note| note.contains("out of memory")), "{:?}", ours.notes);
    same(&ours, &whole, "halved")?;
    Ok(())
}

/// A run that is stopped has no ends.
fn a_stopped_search_has_no_ends() -> Result<(), Failed> {
    let (plan, seeks) = begun("dmt", 1, WARM[0]);
    let progress = Progress::default();
    progress.stop();
    for engine in [&gpu() as &dyn Engine, &Cpu { strict: true }] {
        let searches = engine.newton(&plan, &seeks, &progress)?;
        assert!(searches.all.iter().all(|one| one.phase == Phase::On && one.found.is_none()));
        assert_eq!(searches.all.len(), plan.len());
    }
    Ok(())
}

/// The same to rounding, where the driver may fuse and reorder: of nearly all instances, since a step's last bits may decide
/// on which branch of a law it is.
fn agrees() -> Result<(), Failed> {
    for law in laws() {
        let begun = begun(law, 2, WARM[1]);
        let mut free = gpu();
        free.strict = false;
        let (ours, theirs) = (sought(&free, &begun), sought(&Cpu { strict: true }, &begun));
        let near = |n: &usize| match (&ours.all[*n].found, &theirs.all[*n].found) {
            (Some(a), Some(b)) => apart(&a.end, &b.end) < 1e-6 * begun.1.all[*n].scale,
            (a, b) => a.is_none() && b.is_none(),
        };
        let (count, alike) = (ours.all.len(), (0..ours.all.len()).filter(near).count());
        println!("{law}: {alike} of {count} alike");
        assert!(10 * alike >= 9 * count, "{law}: {alike} of {count}");
    }
    Ok(())
}

/// What f32 comes to is next to what f64 does, of nearly all instances.
fn f32_comes_near() -> Result<(), Failed> {
    for law in laws() {
        let double = begun(law, 2, WARM[0]);
        let (ours, theirs) = (sought(&gpu(), &in_f32(double.clone())), sought(&gpu(), &double));
        let both = ours.all.iter().zip(&theirs.all).zip(&double.1.all);
        let shares: Vec<f64> = both
            .filter_map(|((a, b), seek)| {
                Some(apart(&a.found.as_ref()?.end, &b.found.as_ref()?.end) / seek.scale)
            })
            .collect();
        let near = shares.iter().filter(|share| **share < 2e-3).count();
        let found = theirs.all.iter().filter(|one| one.found.is_some()).count();
        println!("{law}: f32 comes near {near} of {found} states");
        assert!(20 * near >= 19 * found && found > 20, "{law}: {near} of {found}");
    }
    Ok(())
}

/// How far two states are apart, m.
fn apart(a: &SectionState, b: &SectionState) -> f64 {
    let off = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    (off(&a.x, &b.x) + off(&a.u, &b.u)).sqrt()
}

/// 240 tapping cases of two modes.
const GRID: &str = r#"
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
"sample.youngs_modulus" = { from = "0.3 GPa", to = "5 GPa", points = 12, scale = "log" }
"approach.gap" = { from = "8 nm", to = "19.5 nm", points = 20 }
[run]
steady = "search"
periods = 600
[output]
observables = ["amplitude", "phase", "force_max"]
"#;

/// Searches of a plan from where its scene begins; nothing is waited for.
fn settled(plan: &Plan, engine: &dyn Engine) -> OrbitSolution {
    orbit::solve_without_integration(plan, &[], engine, &Progress::default()).expect("it runs")
}

/// Quality factor, moduli, gaps and surface energy.
const GRIDS: [[&str; 6]; 4] = [
    ["100", "0.3 GPa", "5 GPa", "8 nm", "19.5 nm", "30 mJ"],
    ["400", "0.1 GPa", "10 GPa", "4 nm", "19.9 nm", "30 mJ"],
    ["400", "0.1 GPa", "100 GPa", "1 nm", "19.9 nm", "80 mJ"],
    ["2000", "0.1 GPa", "10 GPa", "4 nm", "19.9 nm", "30 mJ"],
];

/// Searches of a grid find what rounds on the host find: as many states at least, and nearly all of them the same within the accuracy
/// (where there are two branches either may be found). On the device as on the CPU that does as it does, to the bit.
fn grids_have_the_hosts_states(law: &str) -> Result<(), Failed> {
    for grid in GRIDS {
        let quality = grid[0];
        let text =
            GRID.replace("LAW", law).replace("quality_factor = 100", &format!("quality_factor = {quality}"));
        let text = text.replace("0.3 GPa", grid[1]).replace("5 GPa", grid[2]).replace("8 nm", grid[3]);
        let text = text.replace("19.5 nm", grid[4]).replace("30 mJ", grid[5]);
        let plan = checks::plan_in(&Scene::parse(Path::new("grid.toml"), &text)?, None, Precision::F64);
        let host = settled(&plan, &Cpu::default());
        let (ours, twin) = (settled(&plan, &gpu()), settled(&plan, &Cpu { strict: true }));
        assert!(ours.outcome.notes.is_empty(), "{law}: {:?}", ours.outcome.notes);
        assert_eq!(ours.periods, twin.periods, "{law}");
        let (mut others, mut farthest): (usize, f64) = (0, 0.0);
        for i in plan.instances() {
            let n = i as usize;
            assert_eq!(ours.state(n), twin.state(n), "{law}, instance {i}");
            if let (Some(a), Some(b)) = (ours.state(n), host.state(n)) {
                let share = apart(&a.section, &b.section) / plan.driven(i).free_amplitude();
                let near = share < plan.run.accuracy;
                others += usize::from(!near);
                farthest = farthest.max(if near { share } else { 0.0 });
            }
        }
        let count = |settled: &OrbitSolution| settled.found.iter().flatten().count();
        let periods = |settled: &OrbitSolution| settled.periods.iter().sum::<u32>();
        let (all, found, by_host) = (plan.len(), count(&ours), count(&host));
        println!(
            "{law}, quality factor {quality}: {found} of {all} found, by rounds on the host {by_host}; {others} are others, the rest within {farthest:.1e}; {} and {} periods",
            periods(&ours),
            periods(&host)
        );
        assert!(found >= by_host && found > all / 2, "{law}: {found} of {all}, {by_host}");
        assert!(others <= all / 50, "{law}: {others} other states");
    }
    Ok(())
}

/// A shader's text whose strides lead back.
fn back(text: String) -> String {
    text.replace("= (*step)[k] * times;", "= -(*step)[k] * times;")
}

/// Where a device's strides lead back its searches take longer: they are its own.
fn strides_are_the_devices() -> Result<(), Failed> {
    let scene = Scene::parse(Path::new("grid.toml"), &GRID.replace("LAW", "hertz"))?;
    let plan = checks::plan_in(&scene, None, Precision::F64);
    type Edit = fn(String) -> String;
    let faults: [(&str, Edit); 3] = [
        ("both precisions", back),
        ("f32", |text| if text.contains("alias real = f32;") { back(text) } else { text }),
        ("f64", |text| if text.contains("alias real = f64;") { back(text) } else { text }),
    ];
    let periods = |engine: &dyn Engine| settled(&plan, engine).periods.iter().sum::<u32>();
    let ours = periods(&gpu());
    for (which, fault) in faults {
        let mut faulty = gpu();
        faulty.drill.edit = Some(fault);
        let others = periods(&faulty);
        println!("{ours} periods, and {others} where strides lead back in {which}");
        assert!(others > 2 * ours, "{which}: {others} and {ours} periods");
    }
    Ok(())
}

/// The tests of this file, of which those run that the adapters found can run.
pub fn tests(found: &[AdapterReport]) -> Vec<Trial> {
    let double = found.iter().any(|one| one.double);
    let exact = shader::exact(found) && double;
    let mut tests = Vec::new();
    let mut add = |name: &str, runs: bool, test: Box<dyn FnOnce() -> Result<(), Failed> + Send>| {
        tests.push(Trial::test(format!("newton_{name}"), test).with_ignored_flag(!runs));
    };
    // Of the corners some in each precision: a driver takes minutes over the largest in f64.
    for modes in [1, 2, 3, 4, 5, 6, 8, 10, 16, 24] {
        let name = format!("same_bits_as_the_cpu_{modes}_modes");
        let runs = exact && [1, 4, 8].contains(&modes);
        add(&name, runs, Box::new(move || same_bits(modes, Precision::F64)));
    }
    for modes in [1, 2, 3, 8, 24] {
        let name = format!("same_bits_as_the_cpu_{modes}_modes_f32");
        // 24 modes take a driver a minute and a half.
        let runs = exact && [1, 8].contains(&modes);
        add(&name, runs, Box::new(move || same_bits(modes, Precision::F32)));
    }
    add("f32_comes_near", double, Box::new(f32_comes_near));
    add("agree_with_the_cpu_to_rounding", double, Box::new(agrees));
    add("pieces_change_no_bit", exact, Box::new(pieces_change_no_bit));
    add("long_periods_go_in_parts", exact, Box::new(long_periods_go_in_parts));
    add("a_lost_device_changes_no_bit", exact, Box::new(a_lost_device_changes_no_bit));
    add("a_stopped_search_has_no_ends", double, Box::new(a_stopped_search_has_no_ends));
    for law in ["hertz", "dmt", "jkr"] {
        let name = format!("grids_have_the_hosts_states_{law}");
        add(&name, exact, Box::new(move || grids_have_the_hosts_states(law)));
    }
    add("strides_are_the_devices", exact, Box::new(strides_are_the_devices));
    tests
}
