//! Spectra in the results file and on the page.
//! Truth: the observables, which are measured apart; Fourier sums over waveforms of many more steps; runs of a thousandth of
//! the error; closed forms without a sample.

use crate::program::{Desk, variable};
use crate::report_pages::Report;
use afmsweep::store::{Results, Spectra, read};
use nalgebra::Complex;
use std::f64::consts::TAU;

/// A lever on a rod that it moves, in contact over two gaps and free over the third.
const ROD: &str = "[instrument.actuator]\nquality_factor = 50\nwidth = \"5 um\"\nthickness = \"5 um\"\n\
    [instrument.cantilever]\nstiffness = \"2 N/m\"\nfrequency = \"70 kHz\"\nquality_factor = 20\n\
    [instrument.tip]\nradius = \"10 nm\"\n\
    [sample]\nyoungs_modulus = \"50 MPa\"\n[contact]\nlaw = \"hertz\"\n\
    [drive]\non = \"tip\"\nfrequency = \"68 kHz\"\nfree_amplitude = \"20 nm\"\n\
    [sweep]\n\"approach.gap\" = { values = [\"8 nm\", \"14 nm\", \"40 nm\"] }\n\
    [run]\nsteady = \"search\"\n";
const ASKED: &str = "[output]\nobservables = [\"amplitude\", \"phase\", \"deflection_amplitude\", \
    \"deflection_phase\", \"harmonic_amplitude\"]\nspectra = { instances = \"all\" }\n";
const FREE: f64 = 20e-9;

fn spectra(results: &Results) -> &Spectra {
    results.spectra.as_ref().unwrap()
}

/// Phasors `z = Im(Z exp(i n omega t))`.
fn phasors(amplitude: &[f64], lag: &[f64]) -> Vec<Complex<f64>> {
    amplitude.iter().zip(lag).map(|(a, lag)| Complex::from_polar(*a, -lag.to_radians())).collect()
}

/// The same of a row over one period that begins at the drive's zero.
fn analysed(row: &[f64], harmonics: usize) -> Vec<Complex<f64>> {
    let count = row.len();
    let angle = |n: usize, j: usize| -TAU * ((n * j) % count) as f64 / count as f64;
    let one = |n: usize| -> Complex<f64> {
        let sum: Complex<f64> =
            row.iter().enumerate().map(|(j, value)| Complex::from_polar(*value, angle(n, j))).sum();
        sum * Complex::new(0.0, 2.0 / count as f64)
    };
    (1..=harmonics).map(one).collect()
}

/// Largest difference of two such lists up to harmonic `last`, as a share of the largest truth within three harmonics: a
/// spectrum has zeros between its lobes.
fn apart(found: &[Complex<f64>], truth: &[Complex<f64>], last: usize) -> f64 {
    let near = |n: usize| {
        truth[n.saturating_sub(3)..truth.len().min(n + 4)].iter().map(|z| z.norm()).fold(0.0, f64::max)
    };
    (0..last).map(|n| (found[n] - truth[n]).norm() / near(n)).fold(0.0, f64::max)
}

#[test]
fn the_first_harmonics_are_the_observables_to_the_accuracy() {
    let desk = Desk::new();
    let results = desk.run(&desk.write("rod.toml", &format!("{ROD}{ASKED}")), &[]);
    let waited = ROD.replace("steady = \"search\"", "periods = 400\nmeasure = 1");
    let waited = desk.run(&desk.write("waited.toml", &format!("{waited}{ASKED}")), &[]);
    let rest =
        desk.write("rest.toml", &format!("{ROD}{ASKED}").replace("steady = \"search\"", "start = \"rest\""));
    desk.refuses(&["run", rest.to_str().unwrap()], &["a start from rest has no spectra"]);
    // A thousandth of the error.
    let exact = ROD.replace("steady = \"search\"", "steady = \"search\"\naccuracy = 1e-6");
    let exact = desk.run(&desk.write("exact.toml", &format!("{exact}{ASKED}")), &["--precision", "f64"]);
    for results in [&results, &waited, &exact] {
        assert_eq!(results.status, [0; 3]);
        let of = spectra(results);
        for i in 0..3 {
            let near = |name: &str, found: f64, within: f64| {
                let stored = variable(results, name)[i];
                assert!((found - stored).abs() <= within, "{name} {i}: {found:e} {stored:e}");
            };
            near("amplitude", of.tip_amplitude[i][0], 1e-3 * FREE);
            near("phase", of.tip_phase[i][0], 1e-3_f64.to_degrees());
            near("deflection_amplitude", of.deflection_amplitude[i][0], 1e-3 * FREE);
            near("deflection_phase", of.deflection_phase[i][0], 1e-3_f64.to_degrees());
            for n in 0..10 {
                let stored = variable(results, "harmonic_amplitude")[10 * i + n];
                let found = of.tip_amplitude[i][n];
                assert!((found - stored).abs() < 1e-3 * FREE, "{i} {n}: {found:e} {stored:e}");
                assert!((of.frequency[i][n] / (68e3 * (n + 1) as f64) - 1.0).abs() < 1e-12);
            }
        }
    }
    // Beyond the steps' own modes: harmonics near the lever's second one, which a run of this accuracy leaves to a spring.
    let of = spectra(&results);
    for i in 0..2 {
        for n in 1..10 {
            let truth = variable(&exact, "harmonic_amplitude")[10 * i + n];
            let found = of.tip_amplitude[i][n];
            assert!((found / truth - 1.0).abs() < 0.05, "{i} {n}: {found:e} {truth:e}");
        }
    }
    // The last instance never touches: its closed form, and nothing beyond.
    let last = variable(&results, "amplitude")[2];
    assert!((last - FREE).abs() < 1e-9 * FREE && (of.tip_amplitude[2][0] - FREE).abs() < 1e-9 * FREE);
    assert_eq!((of.tip_amplitude[2][1], of.force_amplitude[2][0]), (0.0, 0.0));
    assert!(of.tip_phase[2][1].is_nan() && of.force_phase[2][0].is_nan());
    // Rows are as long as the longest.
    let most = *results.steps_per_period.iter().max().unwrap() as usize / 4;
    assert!(Spectra::COLUMNS.iter().all(|column| (column.of)(of).iter().all(|row| row.len() == most)));
}

/// A lever of two modes, stepped with both.
fn two_modes(law: &str, steps: u32, more: &str) -> String {
    format!(
        "[instrument.cantilever]\nmodes = [{{ stiffness = \"40 N/m\", frequency = \"300 kHz\", quality_factor = 100 }}, \
         {{ stiffness = \"1600 N/m\", frequency = \"1880 kHz\", quality_factor = 200 }}]\n\
         [instrument.tip]\nradius = \"10 nm\"\n[sample]\nyoungs_modulus = \"1 GPa\"\nsurface_energy = \"20 mJ/m^2\"\n\
         [contact]\nlaw = \"{law}\"\n[drive]\non = \"tip\"\nfrequency = \"299 kHz\"\nfree_amplitude = \"20 nm\"\n\
         [approach]\ngap = \"15 nm\"\n[run]\nsteady = \"search\"\nmodes = 2\naccuracy = 0.1\nsteps_per_period = {steps}\n\
         [output]\nspectra = {{ instances = [0] }}\n{more}"
    )
}

#[test]
fn travel_force_and_deflection_are_those_of_the_motion() {
    let desk = Desk::new();
    let waves = "waveforms = { instances = [0], samples_per_period = 4096, periods = 1 }\n";
    for law in ["hertz", "dmt", "jkr"] {
        let run = |steps: u32, more: &str| {
            let name = format!("{law}{steps}.toml");
            desk.run(&desk.write(&name, &two_modes(law, steps, more)), &["--precision", "f64"])
        };
        let fine = run(4096, waves);
        let truth = fine.waveforms.as_ref().unwrap();
        let (tip, force) = (analysed(&truth.tip_travel[0], 64), analysed(&truth.force[0], 64));
        let errors = [256, 512, 1024].map(|steps| {
            let results = run(steps, "");
            let of = spectra(&results);
            assert_eq!(of.tip_amplitude[0].len(), steps as usize / 4);
            let found = phasors(&of.tip_amplitude[0], &of.tip_phase[0]);
            // On this base at rest all travel bends the lever.
            assert_eq!(of.deflection_amplitude[0], of.tip_amplitude[0]);
            let forces = phasors(&of.force_amplitude[0], &of.force_phase[0]);
            // Where JKR's contact breaks, the samples of the truth miss the jump.
            let within = if law == "jkr" { 1e-2 } else { 1e-3 };
            let last = steps as usize / 16;
            let off = apart(&forces, &force, last.min(32));
            assert!(off < within, "{law} {steps}: the force is {off:e} off");
            let off = apart(&found, &tip, last);
            assert!(off < 1e-3, "{law} {steps}: the travel is {off:e} off");
            let off = apart(&found, &tip, (steps as usize / 8).min(64));
            assert!(off < 4e-3, "{law} {steps}: the travel is {off:e} off at an eighth of the steps");
            apart(&found, &tip, 32)
        });
        // Order 2 at least.
        for pair in errors.windows(2) {
            assert!(pair[1] < 0.25 * pair[0], "{law}: {errors:?}");
        }
        assert!(errors[2] < 1e-4, "{law}: {errors:?}");
    }
}

/// Shares of a run, and a page of it.
#[test]
fn shares_have_them_and_the_page_shows_them() {
    let desk = Desk::new();
    let path = desk.write("rod.toml", &format!("{ROD}{ASKED}"));
    let whole = desk.run(&path, &[]);
    let name = path.to_str().unwrap();
    for share in ["1/2", "2/2"] {
        let file = format!("share{}.h5", &share[..1]);
        desk.works(&["run", name, "-q", "--shard", share, "-o", &file]);
    }
    desk.works(&["merge", "share1.h5", "share2.h5", "--no-audit", "-o", "merged.h5"]);
    let merged = read(&desk.path("merged.h5")).unwrap();
    assert_eq!(format!("{:?}", merged.spectra), format!("{:?}", whole.spectra));

    let report = Report::of(&whole);
    report.check();
    let words = report.words("spectrum_0.svg");
    for expected in ["harmonic of 68 kHz", "travel of the tip (nm)", "force on the tip (nN)"] {
        assert!(words.lines().any(|line| line == expected), "{expected}: {words}");
    }
    assert!(report.words("spectrum_2.svg").contains("nothing"), "no force where nothing touches");
    let page = report.text("index.html");
    assert!(page.contains("<h2>Spectra</h2>"));
    assert!(page.contains("Harmonics above 1 % of the first: of the travel 2; of the force 2, 3"), "{page}");
    assert!(page.contains("of the travel none; of the force none"), "{page}");
    assert!(page.contains("harmonic 2 at 136 kHz: travel of the tip "), "{page}");
    let csv = report.text("spectrum_0.csv");
    let mut lines = csv.lines();
    assert_eq!(
        lines.next().unwrap(),
        "harmonic,frequency [Hz],tip_amplitude [m],tip_phase [degree],deflection_amplitude [m],\
         deflection_phase [degree],force_amplitude [N],force_phase [degree]"
    );
    let row: Vec<f64> = lines.nth(1).unwrap().split(',').map(|cell| cell.parse().unwrap()).collect();
    let of = spectra(&whole);
    assert_eq!((row[0], row[2], row[7]), (2.0, of.tip_amplitude[0][1], of.force_phase[0][1]));
}

/// All instances by one word, which the scene with every value has as well.
#[test]
fn a_word_stands_for_all_instances() {
    let parse = |text: &str| afmsweep::Scene::parse(std::path::Path::new("a.toml"), text).unwrap();
    let sweep = "[sweep]\n\"approach.gap\" = { values = [\"8 nm\", \"14 nm\", \"40 nm\"] }\n[output]\n";
    let scene =
        parse(&format!("{sweep}spectra = {{ instances = \"all\" }}\nwaveforms = {{ instances = \"all\" }}"));
    assert_eq!(scene.output.spectra.as_deref(), Some(&[0, 1, 2][..]));
    assert_eq!(scene.output.waveforms.as_ref().unwrap().instances, [0, 1, 2]);
    let again = parse(&scene.resolved_toml());
    assert_eq!(again.output, scene.output);
    assert_eq!(scene.resolved_toml().matches("instances = \"all\"").count(), 2, "{}", scene.resolved_toml());
    let some = parse(&format!("{sweep}spectra = {{ instances = [2, 0] }}"));
    assert!(some.resolved_toml().contains("spectra = { instances = [2, 0] }"));
    assert_eq!(parse(&some.resolved_toml()).output.spectra, Some(vec![2, 0]));
}
