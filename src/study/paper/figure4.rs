//! Figure 4: the run of section 4 under the three laws, as printed and with a drive that reaches the printed
//! deformation; and the two readings of 4(c).

use super::super::scene_run::{SceneRun, run, scene};
use super::super::{Numbers, StudyError};
use super::printed_choices::{DEEP, jkr_at_radius};
use super::table1::contact;
use super::{FIGURE_4, LAWS, Picture};
use crate::orbit::OrbitTable;
use crate::record;
use crate::report::{Chart, ChartField, Look, Plot};
use crate::scene::{ActuatorModel, DriveLevel, LawChoice, Scene};
use crate::store::Waveforms;
use std::path::Path;

/// How close the drive is to reach [`DEEP`], relative.
const CLOSE: f64 = 1e-9;
/// Every so many samples of a waveform go into a picture: 85 a drive period, 13 a period of the lever.
const EVERY: usize = 3;

pub(super) fn find(numbers: &mut Numbers, folder: &Path) -> Result<Vec<Picture>, StudyError> {
    let mut pictures = Vec::new();
    let printed = three(numbers, "fig4", None)?;
    save(&printed, folder, "figure_4")?;
    pictures.push((
        "figure_4.svg".to_owned(),
        picture(&printed, "Figure 4: 15 V at 30 kHz from rest, undamped")?,
    ));
    let voltage = voltage_for(DEEP)?;
    numbers.add("scaled.voltage", "voltage at which a²/R reaches 150 nm under Hertz", voltage, "V");
    let scaled = three(numbers, "scaled", Some(voltage))?;
    save(&scaled, folder, "figure_4_scaled")?;
    let title = format!("Figure 4 with {voltage:.1} V, so that a²/R reaches 150 nm");
    pictures.push(("figure_4_scaled.svg".to_owned(), picture(&scaled, &title)?));
    pictures.push(("figure_4_readings.svg".to_owned(), readings(numbers, &scaled)?));
    Ok(pictures)
}

/// Writes the results file of each law.
fn save(runs: &[SceneRun], folder: &Path, name: &str) -> Result<(), StudyError> {
    runs.iter().zip(LAWS).try_for_each(|(ran, (law, _))| ran.save(&folder.join(format!("{name}_{law}.h5"))))
}

/// Scene of figure 4 under the `law`-th law, at another voltage.
fn figure(law: usize, voltage: Option<f64>, model: ActuatorModel) -> Result<Scene, StudyError> {
    let (name, text) = FIGURE_4[law];
    Ok(scene(&format!("scenes/paper_fig4_{name}.toml"), text, |scene| {
        scene.base.instrument.actuator.model = model;
        if let Some(voltage) = voltage {
            scene.base.drive.level = DriveLevel::Voltage(voltage);
        }
    })?)
}

/// Largest deformation (m) of the paper's Hertz run with another coupling of rod and lever.
pub(super) fn deepest(model: ActuatorModel) -> Result<f64, StudyError> {
    Ok(run(figure(0, None, model)?)?.first().measured.indentation_max)
}

/// Runs the three laws and notes what is largest in them.
fn three(numbers: &mut Numbers, key: &str, voltage: Option<f64>) -> Result<Vec<SceneRun>, StudyError> {
    let mut all = Vec::new();
    for (number, (law, name)) in LAWS.into_iter().enumerate() {
        let ran = run(figure(number, voltage, ActuatorModel::Coupled)?)?;
        let measured = ran.first().measured;
        let mut add = |what: &str, meaning: &str, value: f64, units: &'static str| {
            numbers.add(format!("{key}.{law}.{what}"), format!("{meaning}, {name}"), value, units);
        };
        add("depth", "largest deformation", measured.indentation_max, "m");
        add("force_max", "largest force", measured.force_max, "N");
        add("force_min", "smallest force", measured.force_min, "N");
        add(
            "touches",
            "times that the tip touches",
            measured.contacts * f64::from(ran.scene.run.measure),
            "1",
        );
        add("contact_time", "share of the time in contact", measured.contact_time, "1");
        let waves = waveform(&ran)?;
        let largest = |values: &[f64]| values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        add("top", "largest travel of the rod's top", largest(&waves.top), "m");
        add("tip", "largest travel of the tip", largest(&waves.tip), "m");
        all.push(ran);
    }
    let hertz = waveform(&all[0])?;
    for (ran, (law, name)) in all.iter().zip(LAWS).skip(1) {
        let other = waveform(ran)?;
        let apart = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let tip = format!("largest distance of the tip's travel from that under Hertz, {name}");
        numbers.add(format!("{key}.{law}.tip_apart"), tip, apart(&hertz.tip, &other.tip), "m");
        let top = format!("the same for the rod's top, {name}");
        numbers.add(format!("{key}.{law}.top_apart"), top, apart(&hertz.top, &other.top), "m");
    }
    Ok(all)
}

/// The voltage at which the Hertz run's largest deformation, its a²/R, is `depth` (m): secant steps, as the
/// soft sample hardly bends the straight line between the two.
fn voltage_for(depth: f64) -> Result<f64, StudyError> {
    let at = |voltage: f64| -> Result<f64, StudyError> {
        let ran = run(figure(0, Some(voltage), ActuatorModel::Coupled)?)?;
        Ok(ran.first().measured.indentation_max - depth)
    };
    let (mut old, mut new) = (15.0, 240.0);
    let (mut old_gap, mut new_gap) = (at(old)?, at(new)?);
    for _ in 0..20 {
        if new_gap.abs() <= CLOSE * depth {
            return Ok(new);
        }
        let next = new - new_gap * (new - old) / (new_gap - old_gap);
        (old, old_gap) = (new, new_gap);
        (new, new_gap) = (next, at(next)?);
    }
    Err(StudyError::NoDrive { wanted: depth, reached: new_gap + depth, voltage: new })
}

/// One run over time, SI.
struct Wave {
    time: Vec<f64>,
    top: Vec<f64>,
    tip: Vec<f64>,
    depth: Vec<f64>,
    force: Vec<f64>,
}

/// The waveforms of a run's first instance; empty for a scene that does not ask for them.
fn waveform(ran: &SceneRun) -> Result<Wave, StudyError> {
    let waves = match &ran.scene.output.waveforms {
        Some(request) => record::waveforms(&ran.plan, &OrbitTable::default(), request)?,
        None => Waveforms::default(),
    };
    let first = |rows: Vec<Vec<f64>>| rows.into_iter().next().unwrap_or_default();
    Ok(Wave {
        time: first(waves.time),
        top: first(waves.actuator_top),
        tip: first(waves.tip_travel),
        depth: first(waves.indentation),
        force: first(waves.force),
    })
}

fn pairs(time: &[f64], values: &[f64]) -> Vec<(f64, f64)> {
    time.iter().copied().zip(values.iter().copied()).step_by(EVERY).collect()
}

fn panel(label: &str, units: &str, lines: Vec<Vec<(f64, f64)>>) -> Plot {
    Plot::new(label, units, 150.0, lines)
}

fn time_axis() -> ChartField {
    ChartField { label: "time".into(), units: "s".into(), log: false }
}

/// (a) to (d), the three laws in each.
fn picture(runs: &[SceneRun], title: &str) -> Result<String, StudyError> {
    let mut lines: [Vec<Vec<(f64, f64)>>; 4] = Default::default();
    for ran in runs {
        let waves = waveform(ran)?;
        let kinds = [&waves.top, &waves.tip, &waves.depth, &waves.force];
        for (panel, values) in lines.iter_mut().zip(kinds) {
            panel.push(pairs(&waves.time, values));
        }
    }
    let widths = [6.0, 3.6, 1.4];
    let [top, tip, depth, force] = lines;
    let chart = Chart {
        title: title.to_owned(),
        x: time_axis(),
        series: LAWS.iter().zip(widths).map(|((_, name), width)| Look::line(name, width, false)).collect(),
        panels: vec![
            panel("(a) rod's top", "m", top),
            panel("(b) tip", "m", tip),
            panel("(c) deformation", "m", depth),
            panel("(d) force", "N", force),
        ],
    };
    Ok(chart.draw())
}

/// Figure 4(c) and (d) for JKR read both ways: deformation as travel less gap; or the contact radius from
/// a²/R = travel less gap, as under Hertz, and deformation and force from that radius.
fn readings(numbers: &mut Numbers, runs: &[SceneRun]) -> Result<String, StudyError> {
    let contact = contact(&runs[2].scene.base, LawChoice::Jkr);
    let read = |travel: f64| match travel > 0.0 {
        true => jkr_at_radius(&contact, (travel * contact.radius).sqrt()),
        false => (f64::NAN, f64::NAN),
    };
    let deepest = read(runs[2].first().measured.indentation_max);
    numbers.add("reading.jkr.depth", "largest deformation, JKR, read off a²/R", deepest.0, "m");
    numbers.add("reading.jkr.force_max", "largest force, JKR, read off a²/R", deepest.1, "N");
    let mut depths = Vec::new();
    let mut forces = Vec::new();
    for ran in [&runs[0], &runs[2]] {
        let waves = waveform(ran)?;
        depths.push(pairs(&waves.time, &waves.depth));
        forces.push(pairs(&waves.time, &waves.force));
    }
    let travel = depths[1].clone();
    depths.push(travel.iter().map(|&(t, value)| (t, read(value).0)).collect());
    forces.push(travel.iter().map(|&(t, value)| (t, read(value).1)).collect());
    let chart = Chart {
        title: "Figure 4(c) and (d), the two readings".into(),
        x: time_axis(),
        series: vec![
            Look::line("Hertz", 5.0, false),
            Look::line("JKR, deformation = travel less gap", 2.2, false),
            Look::line("JKR, the paper's reading: a²/R = travel less gap", 1.4, false),
        ],
        panels: vec![panel("(c) deformation", "m", depths), panel("(d) force", "N", forces)],
    };
    Ok(chart.draw())
}
