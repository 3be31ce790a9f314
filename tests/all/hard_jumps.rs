//! Contacts under JKR whose force jumps strongly as they end, few among many that hardly adhere, against the reference engine.

use afmsweep::observe::Status;
use afmsweep::{Audit, Backend, Scene, Sweep, SweepOutcome};
use std::path::Path;

/// Works of adhesion (J/m^2), moduli (Pa) and tip radii (m): from, to, points.
const AXES: [(f64, f64, usize); 3] = [(1e-3, 0.1, 20), (1e8, 1e10, 20), (5e-9, 40e-9, 25)];
/// With one sample for contacts of all strengths of jump, their largest forces were off by 8.9e-4 to 9.9e-4.
const STRONG: [usize; 5] = [9322, 9271, 9797, 9346, 9794];

fn scene([work, modulus, radius]: [f64; 3], sweep: &str) -> Scene {
    let text = format!(
        r#"
[instrument]
preset = "ha-fung-chen-2005"
[instrument.actuator]
quality_factor = 100
[instrument.cantilever]
quality_factor = 150
[instrument.tip]
radius = "{radius:e} m"
youngs_modulus = "130 GPa"
poisson_ratio = 0.28
[sample]
youngs_modulus = "{modulus:e} Pa"
poisson_ratio = 0.3
surface_energy = "{work:e} J/m^2"
[contact]
law = "jkr"
[drive]
frequency = "resonance"
free_amplitude = "20 nm"
[approach]
gap = "17 nm"
{sweep}
[run]
accuracy = 1e-3
steady = "search"
[output]
observables = ["amplitude", "force_max"]
"#
    );
    Scene::parse(Path::new("jumps.toml"), &text).unwrap()
}

fn run(scene: Scene, backend: Backend) -> SweepOutcome {
    Sweep::new(scene).backend(backend).audit(Audit::None).run().unwrap()
}

/// The point of the grid that stands at this number.
fn point(instance: usize) -> [f64; 3] {
    let [_, moduli, radii] = AXES.map(|axis| axis.2);
    let places = [instance / (moduli * radii), instance / radii % moduli, instance % radii];
    std::array::from_fn(|n| {
        let (from, to, points) = AXES[n];
        from * (to / from).powf(places[n] as f64 / (points - 1) as f64)
    })
}

#[test]
fn strong_jumps_have_the_modes_that_they_move() {
    let paths = ["sample.surface_energy", "sample.youngs_modulus", "instrument.tip.radius"];
    let units = ["J/m^2", "Pa", "m"];
    let mut sweep = "[sweep]\n".to_owned();
    for ((path, unit), (from, to, points)) in paths.into_iter().zip(units).zip(AXES) {
        sweep += &format!(
            "\"{path}\" = {{ from = \"{from:e} {unit}\", to = \"{to:e} {unit}\", points = {points}, scale = \"log\" }}\n"
        );
    }
    let grid = run(scene([0.02, 2e9, 20e-9], &sweep), Backend::Cpu);
    for instance in STRONG {
        let truth = run(scene(point(instance), ""), Backend::Reference).run.results.get(0);
        let (ours, estimate) = (grid.run.results.get(instance), grid.run.estimates[instance]);
        assert_eq!((ours.status, truth.status), (Status::Ok, Status::Ok), "{instance}");
        let error = (ours.measured.force_max / truth.measured.force_max - 1.0).abs();
        println!("{instance}: largest force off by {error:.1e}, estimated {estimate:.1e}");
        assert!(error < 6e-4, "{instance}: largest force off by {error:.1e}, asked 1e-3");
    }
}
