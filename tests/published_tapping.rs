use afmsweep::engine::{Cpu, Engine, Progress};
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::Scene;
use std::path::Path;

fn main_(name: &str, precision: Precision) {
    for p in [None, Some(64), Some(128), Some(256), Some(512), Some(1024), Some(2048), Some(4096)] {
        let mut scene = Scene::load(Path::new(name)).unwrap();
        scene.run.steps_per_period = p;
        let plan = Plan::new(&scene, precision).unwrap();
        let out = Cpu::default().run(&plan, &Progress::default()).unwrap();
        let m = out.results[0].measured;
        println!(
            "{:?} {} {:?} A {:.10} ph {:.8} fmax {:.9} fmin {:.9} mean {:.9} ind {:.9} ct {:.8} E {:.9e} V {:.6e} c {}",
            p,
            plan.cases[0].steps,
            out.results[0].status,
            m.harmonics[0] * 1e9,
            m.phase,
            m.force_max * 1e9,
            m.force_min * 1e9,
            m.force_mean * 1e9,
            m.indentation_max * 1e9,
            m.contact_time,
            m.dissipation,
            m.virial,
            m.contacts
        );
    }
}

#[test]
fn show() {
    main_("tests/scenes/steady/published_dmt.toml", Precision::F64);
    main_("tests/scenes/steady/published_jkr.toml", Precision::F64);
    main_("tests/scenes/steady/published_dmt.toml", Precision::F32);
    main_("tests/scenes/steady/published_jkr.toml", Precision::F32);
}
