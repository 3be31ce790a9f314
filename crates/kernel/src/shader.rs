//! The shader's text: the files of `shaders/`, composed for what a class needs, behind a generated
//! head that holds every number and the places of every field.
//!
//! The files are WGSL but for a few directives in comments, so that only what is needed exists in
//! the text: `//% if NAME`, `//% end`, and `//% each mode`: the lines up to its end stand once for each mode,
//! with the mode's number in place of `$`; `swinging mode` leaves out the law's memory, and `memory` has it alone;
//! `half` has the halves of a table's rows.
//!
//! The law's kick and its slope, the step and the sums are no files: the kernel's own Rust writes them
//! ([`recorded`](super::recorded), [`recorded_step`](super::recorded_step)).

use super::broyden::{self, state_modes};
use super::constants;
use super::contact::force_table;
use super::newton;
use super::tangent::{PARTIALS, PARTIALS_WITH_MEMORY};
use crate::{Law, Wants};
use std::fmt::Write;

/// Threads of a workgroup.
pub const WORKGROUP: u32 = 64;

/// What a dispatch is for, by the name of its entry point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entry {
    /// Periods of a run.
    Sweep,
    /// The first part of a period with its slope: steps, and the slopes of their kicks.
    Kicks,
    /// The second: what these make of the slope's columns.
    Carry,
    /// After a measured period of the instances that a search has under way, the stride of each.
    Stride,
    /// The same after a period with its slope, by Newton's steps.
    Walk,
}

impl Entry {
    pub const ALL: [Self; 5] = [Self::Sweep, Self::Kicks, Self::Carry, Self::Stride, Self::Walk];

    pub fn name(self) -> &'static str {
        match self {
            Self::Sweep => "sweep",
            Self::Kicks => "kicks",
            Self::Carry => "carry",
            Self::Stride => "stride",
            Self::Walk => "walk",
        }
    }

    /// Whether it belongs to periods with their slopes.
    fn of_slopes(self) -> bool {
        matches!(self, Self::Kicks | Self::Carry | Self::Walk)
    }

    /// Most rounds of a search that it is a part of; a run has one.
    pub fn rounds(self) -> u32 {
        if self.of_slopes() { newton::ROUNDS } else { broyden::ROUNDS }
    }
}

/// What the shader of a class is made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShaderSpec {
    pub entry: Entry,
    pub law: Law,
    /// Stepped modes, 1 to [`super::MODES_MAX`]; the last may be the law's memory.
    pub modes: usize,
    /// What the run measures: the layout of the buffers follows from it.
    pub wants: Wants,
    /// Whether this part of the run is measured; before it only the fundamental is summed.
    pub measured: bool,
    /// Whether free motion decays beside the steady one (a start from rest).
    pub decay: bool,
    /// f64 in place of f32.
    pub double: bool,
    /// Whether all instances have one drive: a GPU then reads the drive's constants once for a workgroup, not for each lane.
    pub one_drive: bool,
}

/// What a binding is to the shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binding {
    Uniform,
    Read,
    Write,
}

const JOB: &str = include_str!("../../../shaders/job.wgsl");
const SWEEP: &str = include_str!("../../../shaders/sweep.wgsl");
const STEP: &str = include_str!("../../../shaders/step.wgsl");
const CONTACT: &str = include_str!("../../../shaders/contact.wgsl");
const TABLE: &str = include_str!("../../../shaders/table.wgsl");
const KICKS: &str = include_str!("../../../shaders/slope/kicks.wgsl");
const CARRY: &str = include_str!("../../../shaders/slope/carry.wgsl");
const NUMBER: &str = include_str!("../../../shaders/number.wgsl");
const SEARCH: &str = include_str!("../../../shaders/search.wgsl");
const STRIDE: &str = include_str!("../../../shaders/broyden/stride.wgsl");
const SOLVE: &str = include_str!("../../../shaders/newton/solve.wgsl");
const WALK: &str = include_str!("../../../shaders/newton/walk.wgsl");

impl ShaderSpec {
    /// Bytes of a number.
    pub fn bytes(&self) -> u64 {
        if self.double { 8 } else { 4 }
    }

    /// Sums that this part of the run keeps.
    pub(super) fn sums(&self) -> Wants {
        if self.measured { self.wants } else { Wants::FUNDAMENTAL }
    }

    /// Numbers that a kick's slope has.
    pub fn partials(&self) -> usize {
        match (self.law.has_memory(), self.law.shifts()) {
            (true, _) => PARTIALS_WITH_MEMORY,
            (false, true) => PARTIALS,
            (false, false) => PARTIALS / 2,
        }
    }

    /// The bindings of group 0, in order.
    pub fn bindings(&self) -> Vec<Binding> {
        use Binding::{Read, Uniform, Write};
        match self.entry {
            Entry::Sweep if self.decay => vec![Uniform, Read, Read, Read, Read, Write, Write, Read, Read],
            Entry::Sweep => vec![Uniform, Read, Read, Read, Read, Write, Write, Read],
            Entry::Kicks => vec![Uniform, Read, Read, Read, Read, Write, Write, Write, Read],
            Entry::Carry => vec![Uniform, Read, Read, Read, Read, Read, Write, Read],
            Entry::Stride => vec![Uniform, Read, Write, Write, Write, Write, Write],
            Entry::Walk => vec![Uniform, Read, Write, Write, Write, Read, Write, Write],
        }
    }

    /// Fields of a row of the table of drives, in order.
    pub fn drive_fields(&self) -> Vec<String> {
        let motion = ["m00", "m01", "m11", "rate", "pull", "drag", "land_x", "land_u", "shift_x", "shift_u"];
        let each = |name: &&str| (0..self.modes).map(|k| format!("{name}_{k}")).collect::<Vec<_>>();
        let own = |name: &str| [name.to_owned()];
        let mut fields: Vec<String> = motion.iter().flat_map(each).chain(own("corner")).collect();
        fields.extend(["work_x", "work_u"].iter().flat_map(each));
        fields
            .extend(["kick_paid", "mean_corner", "free_cosine", "free_sine", "free_rate"].map(str::to_owned));
        fields
    }

    /// Fields of an instance's constants, in order.
    pub fn case_fields(&self) -> Vec<String> {
        let law = self.law.fields().iter().map(|name| format!("law_{name}"));
        let more: &[&str] = match self.entry {
            Entry::Kicks => &["little"],
            Entry::Walk => &["little", "scale", "near", "enough", "memory", "touching"],
            Entry::Stride => &["scale", "near", "sure", "still", "memory", "touching"],
            Entry::Sweep | Entry::Carry => &[],
        };
        let more = more.iter().map(|name| (*name).to_owned());
        std::iter::once("gap".to_owned()).chain(law).chain(more).collect()
    }

    /// Fields of an instance's state, tally and run sums, in order; beside slopes those of its state and of the steps seen.
    pub fn state_fields(&self) -> Vec<String> {
        let mut fields: Vec<String> = self.state().fields().collect();
        if self.entry.of_slopes() {
            let here = ["indentation", "speed", "acceleration", "touching", "size", "contact"];
            let memory: &[&str] = if self.law.has_memory() { &["memory_x", "memory_u"] } else { &[] };
            fields.extend(here.iter().chain(memory).map(|name| format!("here_{name}")));
            fields.extend(["indentation", "size"].map(|name| format!("before_{name}")));
            return fields;
        }
        fields.extend(self.tally(self.wants).fields());
        fields.extend(self.run_sums(true).fields());
        fields
    }

    /// The head and the law alone, for an entry point that asks for kicks.
    pub fn law_text(&self) -> String {
        self.head() + &self.law_of() + &self.expanded(CONTACT) + "\n" + &self.law.kick_text()
    }

    /// The head and these files, which ask for no kicks.
    fn lawless(&self, files: &[&str]) -> String {
        files.iter().fold(self.head(), |text, file| text + &self.expanded(file))
    }

    /// The whole shader.
    pub fn compose(&self) -> String {
        match self.entry {
            Entry::Carry => return self.lawless(&[JOB, CARRY]),
            Entry::Stride => return self.lawless(&[JOB, NUMBER, SEARCH, STRIDE]) + &self.begin_text(),
            Entry::Walk => return self.lawless(&[JOB, NUMBER, SEARCH, SOLVE, WALK]),
            Entry::Kicks | Entry::Sweep => {}
        }
        let mut text = self.law_text();
        let mut add = |file: &str| text += &self.expanded(file);
        let tables = if self.law.is_sum() { &[TABLE][..] } else { &[] };
        [JOB, STEP].iter().chain(tables).for_each(|file| add(file));
        if self.entry == Entry::Kicks {
            add(KICKS);
            return text + &self.step_text() + "\n" + &self.law.slope_text();
        }
        [NUMBER, SWEEP].iter().for_each(|file| add(file));
        if self.sums().forces {
            text += &self.law.forces_text();
        }
        text + &self.step_text() + &self.sums_text()
    }

    fn head(&self) -> String {
        let mut head = format!(
            "// {} law, {} modes, {}\nalias real = {};\n",
            self.law.name(),
            self.modes,
            match self.entry {
                Entry::Sweep if self.measured => "measured",
                Entry::Sweep => "settling",
                entry => entry.name(),
            },
            if self.double { "f64" } else { "f32" }
        );
        // Writing to a String cannot fail.
        for (name, value) in constants::ALL {
            let _ = writeln!(head, "const {name}: real = {};", self.literal(*value));
        }
        let _ = writeln!(head, "const WORKGROUP: u32 = {WORKGROUP}u;");
        let _ = writeln!(head, "const EXPONENT: u32 = {:#x}u;", f32::INFINITY.to_bits());
        let _ = writeln!(head, "const MODES: u32 = {}u;", self.modes);
        let _ = writeln!(head, "const PARTIALS: u32 = {}u;", self.partials());
        let walks = self.entry == Entry::Walk;
        let numbers = 2 * if walks { self.modes } else { state_modes(self.modes) };
        let _ =
            writeln!(head, "const NUMBERS: u32 = {numbers}u;\nconst HALF_NUMBERS: u32 = {}u;", numbers / 2);
        let _ = writeln!(head, "const ROUNDS: u32 = {}u;", self.entry.rounds());
        let tables =
            [("DRIVE_", self.drive_fields()), ("CASE_", self.case_fields()), ("", self.state_fields())];
        for (prefix, fields) in &tables {
            for (place, field) in fields.iter().enumerate() {
                let _ = writeln!(head, "const {prefix}{}: u32 = {place}u;", field.to_uppercase());
            }
        }
        let (columns, rows) = (force_table::COLUMNS, force_table::ROWS);
        let fields = self.drive_fields().len();
        let _ = writeln!(
            head,
            "const TABLE_COLUMNS: u32 = {columns}u;\nconst TABLE_ROWS: u32 = {rows}u;\nconst DRIVE_FIELDS: u32 = {fields}u;"
        );
        let member = |field: &&str| format!("    {field}: real,\n");
        // A structure must have a member.
        let members = if self.law.fields().is_empty() { &["none"] } else { self.law.fields() };
        let members: String = members.iter().map(member).collect();
        head + &format!("\nstruct Law {{\n{members}}}\n")
    }

    /// What makes an instance's law of its constants.
    fn law_of(&self) -> String {
        let value = |field: &&str| format!("cases[at(CASE_LAW_{}, i)], ", field.to_uppercase());
        let values: String = self.law.fields().iter().map(value).collect();
        let values = if values.is_empty() { "ZERO".into() } else { values };
        format!("\nfn law_of(i: u32) -> Law {{\n    return Law({values});\n}}\n")
    }

    /// A number as the shader's text has it: the nearest of its precision.
    fn literal(&self, value: f64) -> String {
        if self.double { format!("{value:?}lf") } else { format!("{:?}f", value as f32) }
    }

    /// A file as a part of the shader.
    fn expanded(&self, file: &str) -> String {
        format!("\n{}", self.expand(file))
    }

    /// Carries out a file's directives.
    fn expand(&self, file: &str) -> String {
        let lines: Vec<&str> = file.lines().collect();
        let mut out = String::new();
        self.block(&lines, None, &mut out);
        out
    }

    fn block(&self, lines: &[&str], item: Option<&str>, out: &mut String) {
        let mut at = 0;
        while at < lines.len() {
            let line = lines[at];
            let Some(directive) = line.trim().strip_prefix("//% ") else {
                match item {
                    Some(item) => *out += &line.replace('$', item),
                    None => *out += line,
                }
                out.push('\n');
                at += 1;
                continue;
            };
            let end = at + 1 + closing(&lines[at + 1..]);
            let inside = &lines[at + 1..end];
            let items = directive.strip_prefix("each ").and_then(|what| self.items(what));
            let holds = directive.strip_prefix("if ").and_then(|name| self.holds(name));
            match (items, holds) {
                (Some(items), _) => items.iter().for_each(|item| self.block(inside, Some(item), out)),
                (_, Some(true)) => self.block(inside, item, out),
                (_, Some(false)) => {}
                // No driver takes this for a shader: a misspelt directive must not remove lines in silence.
                _ => *out += &format!("unknown directive: {directive}\n"),
            }
            at = end + 1;
        }
    }

    /// What lines are written once for each of; none where that is not known.
    fn items(&self, what: &str) -> Option<Vec<String>> {
        let swinging = self.modes - usize::from(self.law.has_memory());
        // The steps of a search among a table's rows.
        if what == "half" {
            let steps = std::iter::successors(Some(force_table::ROWS / 2), |step| Some(step / 2));
            return Some(steps.take_while(|step| *step > 0).map(|step| step.to_string()).collect());
        }
        let places = match what {
            "mode" => 0..self.modes,
            // What moves the tip, and what the law remembers.
            "swinging mode" => 0..swinging,
            "memory" => swinging..self.modes,
            _ => return None,
        };
        Some(places.map(|number| number.to_string()).collect())
    }

    /// Whether a condition holds; none where it is not known.
    fn holds(&self, condition: &str) -> Option<bool> {
        Some(match condition {
            "looks back" => self.wants.looks_back(),
            "decay" => self.decay,
            "shifts" => self.law.shifts(),
            "one drive" => self.one_drive,
            "several drives" => !self.one_drive,
            "energy" => self.sums().energy,
            "forces" => self.sums().forces,
            _ => return None,
        })
    }
}

/// Lines up to the `//% end` that closes a block.
fn closing(lines: &[&str]) -> usize {
    let mut depth = 0;
    for (number, line) in lines.iter().enumerate() {
        match line.trim() {
            "//% end" if depth == 0 => return number,
            "//% end" => depth -= 1,
            line if line.starts_with("//% ") => depth += 1,
            _ => {}
        }
    }
    lines.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_misspelt_directive_does_not_remove_lines_in_silence() {
        let law = Law::Hertz;
        let (wants, entry) = (Wants::ENERGY, Entry::Sweep);
        let (measured, decay, double, one_drive) = (true, false, false, false);
        let spec = ShaderSpec { entry, law, modes: 2, wants, measured, decay, double, one_drive };
        assert_eq!(spec.expand("a\n//% if energy\nb\n//% end\n"), "a\nb\n");
        assert_eq!(spec.expand("a\n//% if decay\nb\n//% end\n"), "a\n");
        for line in ["if shift", "each modes", "each", "if", "unless decay"] {
            let text = spec.expand(&format!("a\n//% {line}\nb\n//% end\n"));
            assert_eq!(text, format!("a\nunknown directive: {line}\n"));
        }
        assert!(!spec.compose().contains("unknown directive"));
    }
}
