//! The page: ratios at equal error, tables, CSV and pictures.

use crate::level::Cost;
use crate::measure::Point;
use crate::problem::PERIODS;
use crate::settled::{NAME, Settled};
use afmsweep::report::{Chart, ChartField, Document, Look, Plot};
use std::fmt::Write;

/// Marks the page, so that the folder may be written again.
pub const GENERATOR: &str = "afmsweep precision bench";
/// Median errors at which solvers are compared.
const LEVELS: [f64; 4] = [1e-3, 1e-5, 1e-6, 1e-7];

/// Solvers that stand in one line of the comparison: the cheaper of several methods at each accuracy.
struct Family {
    name: &'static str,
    /// How the names of its solvers begin.
    begin: &'static str,
}

const FAMILIES: [Family; 9] = [
    Family { name: "cpu, f32 or f64", begin: "cpu " },
    Family { name: "cpu f32", begin: "cpu f32" },
    Family { name: "cpu f64", begin: "cpu f64" },
    Family { name: "RK4 by hand", begin: "RK4" },
    Family { name: "heyoka", begin: "heyoka" },
    Family { name: "ode_solvers", begin: "ode_solvers" },
    Family { name: "diffsol", begin: "diffsol" },
    Family { name: "diffrax", begin: "diffrax" },
    Family { name: "SciPy", begin: "SciPy" },
];

/// What the page says of how it was made.
pub struct Story {
    pub command: String,
    pub date: String,
    pub paragraphs: Vec<(String, String)>,
}

impl Family {
    fn of<'a>(&self, points: &'a [Point], law: &str) -> Vec<&'a Point> {
        let ours = |point: &&Point| point.law == law && point.solver.starts_with(self.begin);
        let mut members: Vec<&Point> = points.iter().filter(ours).collect();
        // Settings of one solver after each other, in the order in which they were given.
        members.sort_by(|a, b| a.solver.cmp(&b.solver));
        members
    }
}

fn laws(points: &[Point]) -> Vec<String> {
    let mut laws: Vec<String> = points.iter().map(|point| point.law.clone()).collect();
    laws.dedup();
    laws
}

/// The law as it is written.
fn title(law: &str) -> String {
    match law {
        "hertz" => "Hertz".to_owned(),
        other => other.to_uppercase(),
    }
}

/// Times at equal median error, and how many times this crate's they are.
fn comparison(points: &[Point], law: &str) -> Vec<Vec<String>> {
    let mut head = vec!["solver".to_owned()];
    head.extend(LEVELS.iter().map(|level| format!("at {level:.0e}")));
    head.extend(LEVELS.iter().map(|level| format!("ratio at {level:.0e}")));
    let mut rows = vec![head];
    let ours = FAMILIES[0].of(points, law);
    for family in &FAMILIES[1..] {
        let members = family.of(points, law);
        if members.is_empty() {
            continue;
        }
        let costs: Vec<Cost> = LEVELS.iter().map(|level| Cost::at(&members, *level)).collect();
        let mut row = vec![family.name.to_owned()];
        row.extend(costs.iter().map(ToString::to_string));
        row.extend(costs.iter().zip(LEVELS).map(|(cost, level)| cost.over(Cost::at(&ours, level))));
        rows.push(row);
    }
    rows
}

fn shown(error: f64) -> String {
    if error.is_finite() { format!("{error:.1e}") } else { "none".to_owned() }
}

/// Times to the periodic state: by searching, and by as many periods of each solver as waiting takes.
fn to_the_state(points: &[Point], settled: &Settled) -> Vec<Vec<String>> {
    let mut head = vec!["solver".to_owned()];
    head.extend(LEVELS.iter().map(|level| format!("at {level:.0e}")));
    head.extend(LEVELS.iter().map(|level| format!("ratio at {level:.0e}")));
    let ours: Vec<&Point> = settled.points.iter().collect();
    let ours = LEVELS.map(|level| Cost::at(&ours, level));
    let mut rows = vec![head];
    let mut add = |name: String, costs: Vec<Cost>| {
        let mut row = vec![name];
        row.extend(costs.iter().map(ToString::to_string));
        row.extend(costs.iter().zip(ours).map(|(cost, ours)| cost.over(ours)));
        rows.push(row);
    };
    add(NAME.to_owned(), ours.to_vec());
    let waited = LEVELS.map(|level| settled.periods(level));
    for family in &FAMILIES[1..] {
        let members = family.of(points, &settled.law);
        if !members.is_empty() {
            let cost = |(level, periods): (&f64, &Option<f64>)| match periods {
                Some(periods) => Cost::at(&members, *level).times(periods / f64::from(PERIODS)),
                None => Cost::NotReached,
            };
            add(family.name.to_owned(), LEVELS.iter().zip(&waited).map(cost).collect());
        }
    }
    let mut last = vec!["periods waited".to_owned()];
    let shown = |periods: &Option<f64>| periods.map_or_else(|| "more".to_owned(), |n| format!("{n:.0}"));
    last.extend(waited.iter().map(shown));
    last.resize(1 + 2 * LEVELS.len(), String::new());
    rows.push(last);
    rows
}

/// Every point of a law.
fn table(points: &[Point], law: &str) -> Vec<Vec<String>> {
    let head = [
        "solver",
        "setting",
        "steps per period",
        "time per instance",
        "median",
        "95 %",
        "largest",
        "instances",
        "given up",
    ];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for point in points.iter().filter(|point| point.law == law) {
        rows.push(vec![
            point.solver.clone(),
            point.setting.clone(),
            point.steps.map_or_else(|| "unknown".to_owned(), |steps| format!("{steps:.0}")),
            format!("{:.3} ms{}", 1e3 * point.seconds, if point.clock == "wall" { " (wall)" } else { "" }),
            shown(point.errors.median),
            shown(point.errors.p95),
            shown(point.errors.largest),
            format!("{} of {}", point.errors.counted, point.instances),
            point.failed.to_string(),
        ]);
    }
    rows
}

fn csv(points: &[Point], settled: &[Settled]) -> String {
    let mut text = String::from(
        "law,solver,setting,steps_per_period,seconds_per_instance,clock,median_error,p95_error,largest_error,\
         instances,counted,given_up\n",
    );
    for point in points.iter().chain(settled.iter().flat_map(|settled| &settled.points)) {
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{},{},\"{}\",{},{:.4e},{},{:.3e},{:.3e},{:.3e},{},{},{}",
            point.law,
            point.solver,
            point.setting,
            point.steps.map_or_else(String::new, |steps| format!("{steps:.1}")),
            point.seconds,
            point.clock,
            point.errors.median,
            point.errors.p95,
            point.errors.largest,
            point.instances,
            point.errors.counted,
            point.failed
        );
    }
    text
}

type Value = fn(&Point) -> f64;

/// A value that can stand on a logarithmic axis, or a gap in the line.
fn logarithmic(value: f64) -> f64 {
    if value > 0.0 && value.is_finite() { value } else { f64::NAN }
}

/// There are six colours: lines from the seventh on are dashed.
fn look(name: &str, number: usize) -> Look {
    // The CPU's lines show below the GPU's where both give the same.
    let width = if name.starts_with("cpu") { 3.4 } else { 1.8 };
    Look { name: name.to_owned(), width, dashed: number >= 6, dots: true }
}

/// Median, 95th percentile and largest error over time or steps, for engines and two opponents.
fn diagram(points: &[Point], law: &str, x: ChartField, over: Value) -> String {
    const SOLVERS: [&str; 6] =
        ["cpu f32", "cpu f64", "gpu f32", "gpu f64", "RK4 by hand", "ode_solvers dop853"];
    let present: Vec<&str> = SOLVERS
        .into_iter()
        .filter(|name| points.iter().any(|point| point.law == law && point.solver == *name))
        .collect();
    let panel = |label: &str, value: Value| Plot {
        label: label.to_owned(),
        units: "1".into(),
        lines: present
            .iter()
            .map(|name| {
                let line = points.iter().filter(|point| point.law == law && point.solver == *name);
                line.map(|point| (over(point), logarithmic(value(point)))).collect()
            })
            .collect(),
        marks: Vec::new(),
        height: 210.0,
    };
    let chart = Chart {
        title: format!("{}: error over {}", title(law), x.label),
        x,
        series: present.iter().map(|name| look(name, 0)).collect(),
        panels: vec![
            panel("median error", |point| point.errors.median),
            panel("95th percentile", |point| point.errors.p95),
            panel("largest error", |point| point.errors.largest),
        ],
    };
    chart.draw()
}

/// Median error over CPU time, each family by its points that no other one of it beats in both.
fn peers(points: &[Point], law: &str) -> String {
    let families: Vec<(&str, Vec<&Point>)> = FAMILIES[1..]
        .iter()
        .map(|family| (family.name, front(family.of(points, law))))
        .filter(|(_, members)| !members.is_empty())
        .collect();
    let chart = Chart {
        title: format!("{}: median error over CPU time, one thread", title(law)),
        x: ChartField { label: "CPU time per instance".into(), units: "s".into(), log: true },
        series: families.iter().enumerate().map(|(number, (name, _))| look(name, number)).collect(),
        panels: vec![Plot {
            label: "median error".into(),
            units: "1".into(),
            lines: families
                .iter()
                .map(|(_, members)| {
                    members.iter().map(|point| (point.seconds, point.errors.median)).collect()
                })
                .collect(),
            marks: Vec::new(),
            height: 420.0,
        }],
    };
    chart.draw()
}

/// The points that are better than all cheaper ones.
fn front(mut points: Vec<&Point>) -> Vec<&Point> {
    points.retain(|point| logarithmic(point.errors.median).is_finite());
    points.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let mut best = f64::INFINITY;
    points.retain(|point| {
        let better = point.errors.median < best;
        best = best.min(point.errors.median);
        better
    });
    points
}

/// The files, by name.
pub fn files(points: &[Point], settled: &[Settled], story: &Story) -> Vec<(String, String)> {
    let mut page = Document { title: "Work and precision".to_owned(), ..Document::default() };
    page.paragraph("", format!("Made by the command \"{}\", {}.", story.command, story.date));
    for (lead, text) in &story.paragraphs {
        page.paragraph(lead, text.clone());
    }
    let mut pictures = Vec::new();
    for law in laws(points) {
        page.heading(&title(&law));
        page.table(
            "CPU time per instance (one thread) to a median error, and its ratio to this crate's CPU engine, the faster of f32 \
             and f64; between measured points by their logarithms, never beyond them. \"At most\": a setting that is \
             better than asked and cheaper than what lies between others; \"about\": so are both.",
            comparison(points, &law),
        );
        for settled in settled.iter().filter(|settled| settled.law == law) {
            page.table(
                &format!(
                    "To the periodic state: CPU time per instance of this crate's search, with the median error of what it \
                     finds against the reference's own periodic state ({} of {} instances count: those with a state that \
                     waiting ends in); and of the solvers above, their time for a period times the periods after which the \
                     median of fine steps is so near to where waiting ends.",
                    settled.counted, settled.instances
                ),
                to_the_state(points, settled),
            );
        }
        let time = ChartField { label: "time per instance".into(), units: "s".into(), log: true };
        let steps = ChartField { label: "steps per period".into(), units: "1".into(), log: true };
        let drawn = [
            (format!("{law}_peers.svg"), peers(points, &law), "Median error over CPU time, all solvers"),
            (
                format!("{law}_time.svg"),
                diagram(points, &law, time, |point| point.seconds),
                "Errors over time per instance; every line is one solver",
            ),
            (
                format!("{law}_steps.svg"),
                diagram(points, &law, steps, |point| point.steps.unwrap_or(f64::NAN)),
                "Errors over steps per drive period; the adaptive solver by its mean of accepted steps",
            ),
        ];
        for (file, svg, caption) in drawn {
            page.figure(&file, caption);
            pictures.push((file, svg));
        }
    }
    page.heading("All points");
    for law in laws(points) {
        let searches = settled.iter().flat_map(|settled| &settled.points);
        let all: Vec<Point> = points.iter().chain(searches).cloned().collect();
        page.table(&title(&law), table(&all, &law));
    }
    let mut files = vec![
        ("index.html".to_owned(), page.html(GENERATOR)),
        ("README.md".to_owned(), page.markdown()),
        ("precision.csv".to_owned(), csv(points, settled)),
    ];
    files.extend(pictures);
    files
}
