//! Table, picture and files of a bench.

use super::BenchSeries;
use crate::report::{Chart, ChartField, Document, Look, Plot};
use std::fmt::Write;

/// Marks the page, so that the folder may be written again.
pub const GENERATOR: &str = "afmsweep bench";

/// One row for each engine and precision: speed by size, and the error beside it.
pub fn table(all: &[BenchSeries]) -> Vec<Vec<String>> {
    let sizes: Vec<String> = all
        .first()
        .map(|series| series.points.iter().map(|point| format!("{} instances", point.instances)).collect())
        .unwrap_or_default();
    let mut head = vec!["engine".to_owned()];
    head.extend(sizes);
    head.extend(["median error", "largest error", "compared"].map(str::to_owned));
    let mut rows = vec![head];
    for series in all {
        let mut row = vec![name(series)];
        row.extend(series.points.iter().map(|point| format!("{:.2e}/s", point.rate)));
        let error = series.error;
        row.push(format!("{:.1e}", error.median));
        row.push(format!("{:.1e}", error.largest));
        row.push(format!("{} of {}", error.counted, error.tried));
        rows.push(row);
    }
    rows
}

fn name(series: &BenchSeries) -> String {
    format!("{} {}", series.backend, series.precision.name())
}

fn csv(all: &[BenchSeries]) -> String {
    let mut text = String::from(
        "backend,precision,device,instances,periods,seconds,instance_steps_per_second,median_error,largest_error\n",
    );
    for series in all {
        for point in &series.points {
            // Writing to a String cannot fail.
            let _ = writeln!(
                text,
                "{},{},\"{}\",{},{},{:.4},{:.4e},{:.2e},{:.2e}",
                series.backend,
                series.precision.name(),
                series.device.replace('"', "'"),
                point.instances,
                point.periods,
                point.seconds,
                point.rate,
                series.error.median,
                series.error.largest
            );
        }
    }
    text
}

fn picture(title: &str, all: &[BenchSeries]) -> String {
    let line = |series: &BenchSeries| {
        series.points.iter().map(|point| (point.instances as f64, point.rate)).collect()
    };
    let chart = Chart {
        title: title.to_owned(),
        x: ChartField { label: "instances".into(), units: "1".into(), log: true },
        series: all
            .iter()
            .map(|series| {
                let name = format!("{}, median error {:.0e}", name(series), series.error.median);
                Look::line(&name, 2.0, series.backend == "cpu")
            })
            .collect(),
        panels: vec![Plot::new("instance-steps per second", "1", 340.0, all.iter().map(line).collect())],
    };
    chart.draw()
}

/// The bench's files, by name: the page as HTML and Markdown, the picture, the numbers.
pub fn files(title: &str, command: &str, date: &str, all: &[BenchSeries]) -> Vec<(String, String)> {
    let mut page = Document { title: format!("Speed and error: {title}"), ..Document::default() };
    page.paragraph("", format!("Made by the command \"{command}\", {date}."));
    let mut devices: Vec<String> =
        all.iter().map(|series| format!("{}: {}", series.backend, series.device)).collect();
    devices.dedup();
    page.paragraph("", devices.join("; ") + ".");
    page.paragraph(
        "",
        "Every instance is run once as planned, without error control. Speed is that of the engine's whole run, \
         packing, transfers and observables included, the fastest of several runs; large ensembles are timed over \
         few periods (bench.csv has them), in which packing weighs more than in a whole run. Error is that of the worst observable of an instance, on the scale on which accuracy \
         counts, against the reference engine, which carries all modes that matter and locates every contact; \
         it does not depend on the size of the ensemble.",
    );
    page.table("", table(all));
    page.figure("speed.svg", "Instance-steps per second over the size of the ensemble");
    vec![
        ("index.html".into(), page.html(GENERATOR)),
        ("README.md".into(), page.markdown()),
        ("speed.svg".into(), picture(title, all)),
        ("bench.csv".into(), csv(all)),
    ]
}
