//! The step and the sums in WGSL: [`Case`], [`Tally`] and [`RunSums`] write them, as laws write their kicks.
//!
//! Each structure of the shader has the members that a class needs. The lists of members are those of the buffers' fields, too
//! ([`ShaderSpec::drive_fields`], [`ShaderSpec::state_fields`]).

use super::constants::ZERO;
use super::contact::Interaction;
use super::flow::Flow;
use super::law::WithLaw;
use super::law_text::{approach_at, kick_at};
use super::recorded::Recorded;
use super::run_sums::RunSums;
use super::sample::{Sample, Wave};
use super::shader::ShaderSpec;
use super::step::{Case, Decay, Free, Met, State};
use super::tally::Tally;
use super::wgsl::function;
use super::{Lane, MODES_MAX, PeriodSums, Wants};

/// A structure of the shader and what its members are called.
pub(super) struct Structure {
    name: &'static str,
    /// What its values are called, and the beginning of its fields in the buffers.
    prefix: &'static str,
    members: Vec<String>,
}

impl Structure {
    fn declaration(&self) -> String {
        let members: String = self.members.iter().map(|member| format!("    {member}: real,\n")).collect();
        format!("\nstruct {} {{\n{members}}}\n", self.name)
    }

    /// Its value, made of these words.
    fn value(&self, words: &[String]) -> String {
        let words: String = words.iter().map(|word| format!("        {word},\n")).collect();
        format!("{}(\n{words}    )", self.name)
    }

    /// `<prefix>_of`, which reads an instance's members, each where `cell` says.
    fn reader(&self, first_line: &str, cell: impl Fn(&String) -> String) -> String {
        let Self { name, prefix, members } = self;
        let value = self.value(&members.iter().map(cell).collect::<Vec<_>>());
        format!("\nfn {prefix}_of(i: u32) -> {name} {{\n{first_line}    return {value};\n}}\n")
    }

    /// Its fields in the buffers.
    pub fn fields(&self) -> impl Iterator<Item = String> {
        self.members.iter().map(|member| format!("{}_{member}", self.prefix))
    }

    /// Where the instance's state has a member.
    fn cell(&self, member: &str) -> String {
        format!("states[at({}, i)]", format!("{}_{member}", self.prefix).to_uppercase())
    }

    /// The declaration, and what reads and stores an instance's.
    fn in_state(&self) -> String {
        let Self { name, prefix, members } = self;
        let store = |member: &String| format!("    {} = {prefix}.{member};\n", self.cell(member));
        let stores: String = members.iter().map(store).collect();
        self.declaration()
            + &self.reader("", |member| self.cell(member))
            + &format!("\nfn store_{prefix}(i: u32, {prefix}: {name}) {{\n{stores}}}\n")
    }

    /// A function of the shader that returns one; `work` makes its members, in their order.
    fn function(&self, head: &str, work: impl FnOnce() -> Vec<Recorded>) -> String {
        function(&format!("\nfn {head} -> {}", self.name), work, |words| self.value(words))
    }
}

fn named(place: &str, member: &str) -> Recorded {
    Recorded::named(format!("{place}.{member}"))
}

/// As many names as are wanted, and zeros.
fn numbered<const N: usize>(place: &str, member: &str, count: usize) -> [Recorded; N] {
    std::array::from_fn(|n| match n < count {
        true => named(place, &format!("{member}_{n}")),
        false => Recorded::splat(ZERO),
    })
}

/// Cosine and sine of each of so many harmonics, in turns.
fn in_turns<T>(count: usize, both: impl Fn(usize) -> [T; 2]) -> impl Iterator<Item = T> {
    (0..count).flat_map(both)
}

fn period_sums(place: &str, wants: Wants) -> PeriodSums<Recorded> {
    let mut sums = PeriodSums::new();
    sums.kept_places(wants).zip(wants.kept()).for_each(|(sum, kept)| *sum = named(place, kept.name));
    sums
}

impl ShaderSpec {
    /// Lever, free motion and gap of one instance, kernel units.
    fn case(&self) -> Structure {
        let (shifts, energy) = (self.law.shifts(), self.sums().energy);
        let mut members = self.drive_fields();
        members.retain(|field| shifts || !field.starts_with("shift_"));
        let of_energy =
            |field: &str| field.starts_with("work_") || ["kick_paid", "mean_corner"].contains(&field);
        members.retain(|field| energy || !of_energy(field));
        members.push("gap".into());
        Structure { name: "Case", prefix: "case", members }
    }

    /// Deviation of each mode at a sample before its kick, the law's memory among them, and contact.
    pub(super) fn state(&self) -> Structure {
        let modes = in_turns(self.modes, |k| [format!("x_{k}"), format!("u_{k}")]);
        Structure { name: "State", prefix: "state", members: modes.chain(["touching".into()]).collect() }
    }

    /// What is summed over the steps of a period: so much, and what links samples across its start.
    pub(super) fn tally(&self, sums: Wants) -> Structure {
        let waves = in_turns(sums.harmonics, |n| [format!("cosine_{n}"), format!("sine_{n}")]);
        let mut members: Vec<String> = waves.chain(sums.kept().map(|sum| sum.name.into())).collect();
        if self.wants.looks_back() {
            members.extend(["last_0", "last_1", "touched"].map(str::to_owned));
        }
        Structure { name: "Tally", prefix: "tally", members }
    }

    /// What a period's end changes of the run's sums: of a measured one all of them.
    pub(super) fn run_sums(&self, measured: bool) -> Structure {
        let mut members: Vec<String> =
            ["last_cosine", "last_sine", "change_0", "change_1", "change_2", "change_3"]
                .map(str::to_owned)
                .into();
        if measured {
            members.push("largest".into());
            members.extend(in_turns(self.wants.harmonics, |n| [format!("cosine_{n}"), format!("sine_{n}")]));
            members.extend(self.wants.kept().map(|sum| sum.name.into()));
        }
        Structure { name: "RunSums", prefix: "run_sums", members }
    }

    /// An instance's constants and state, and the parts of a step: `meet`, `fly` and `sampled`.
    pub fn step_text(&self) -> String {
        let case = self.case();
        let cell = |member: &String| match member.as_str() {
            "gap" => "cases[at(CASE_GAP, i)]".to_owned(),
            _ => format!("drives[DRIVE_{} * job.drives + row]", member.to_uppercase()),
        };
        let row = if self.one_drive { "    let row = 0u;\n" } else { "    let row = drive_of[i];\n" };
        case.declaration()
            + &case.reader(row, cell)
            + &self.state().in_state()
            + &self.law.with(StepText(self))
    }

    /// The sums of a period: what a step adds, how they begin, and how a period's end takes them into the run's.
    pub fn sums_text(&self) -> String {
        let (tally, run) = (self.tally(self.sums()), self.run_sums(self.measured));
        let added = || {
            let mut sums = self.recorded_tally();
            let wave = |n: usize| {
                let at = |more| Recorded::named(format!("waves[2u * ({n}u * job.steps + index){more}]"));
                vec![Wave { cosine: at(""), sine: at(" + 1u") }]
            };
            let waves: Vec<_> = (0..self.sums().harmonics).map(wave).collect();
            sums.add(&sample_at("sample"), &waves, 0, self.sums());
            self.tally_numbers(&sums)
        };
        let next = || {
            let mut sums = self.recorded_tally();
            sums.next_period();
            self.tally_numbers(&sums)
        };
        let closed = || {
            let mut sums = self.recorded_run_sums();
            let measured = self.measured.then_some(self.wants);
            sums.close(&self.recorded_tally(), Recorded::named("real(job.steps)"), measured);
            self.run_numbers(&sums, self.measured)
        };
        tally.in_state()
            + &tally.function("tally_add(tally: Tally, sample: Sample, index: u32)", added)
            + &tally.function("tally_next_period(tally: Tally)", next)
            + &run.in_state()
            + &run.function("close_period(run_sums: RunSums, tally: Tally)", closed)
    }

    /// The run's sums before the first period.
    pub(super) fn begin_text(&self) -> String {
        let run = self.run_sums(true);
        run.in_state() + &run.function("begin_run()", || self.run_numbers(&RunSums::new(), true))
    }

    fn recorded_tally(&self) -> Tally<Recorded> {
        let mut tally = Tally::resume(numbered("tally", "last", 2), named("tally", "touched"));
        tally.cosine = numbered("tally", "cosine", self.sums().harmonics);
        tally.sine = numbered("tally", "sine", self.sums().harmonics);
        tally.sums = period_sums("tally", self.sums());
        tally
    }

    /// In the order of its members.
    fn tally_numbers(&self, tally: &Tally<Recorded>) -> Vec<Recorded> {
        let sums = self.sums();
        let waves = in_turns(sums.harmonics, |n| [tally.cosine[n], tally.sine[n]]);
        let mut numbers: Vec<Recorded> = waves.chain(tally.sums.kept(sums).copied()).collect();
        if self.wants.looks_back() {
            numbers.extend(tally.carried());
        }
        numbers
    }

    fn recorded_run_sums(&self) -> RunSums<Recorded> {
        let own = |member| named("run_sums", member);
        RunSums {
            last_cosine: own("last_cosine"),
            last_sine: own("last_sine"),
            changes: numbered("run_sums", "change", 4),
            largest: own("largest"),
            cosine: numbered("run_sums", "cosine", self.wants.harmonics),
            sine: numbered("run_sums", "sine", self.wants.harmonics),
            sums: period_sums("run_sums", self.wants),
        }
    }

    /// In the order of its members.
    fn run_numbers(&self, run: &RunSums<Recorded>, measured: bool) -> Vec<Recorded> {
        let mut numbers = vec![run.last_cosine, run.last_sine];
        numbers.extend(run.changes);
        if measured {
            numbers.push(run.largest);
            numbers.extend(in_turns(self.wants.harmonics, |n| [run.cosine[n], run.sine[n]]));
            numbers.extend(run.sums.kept(self.wants));
        }
        numbers
    }
}

fn sample_at(place: &str) -> Sample<Recorded> {
    let own = |member| named(place, member);
    Sample {
        steady: own("steady"),
        beyond: own("beyond"),
        indentation: own("indentation"),
        work: own("work"),
        virial: own("virial"),
        least: own("least"),
        most: own("most"),
        kick: kick_at(&format!("{place}.kick")),
    }
}

/// The parts of a step under a law.
struct StepText<'a>(&'a ShaderSpec);

impl WithLaw<Recorded> for StepText<'_> {
    type Output = String;

    fn with<I: Interaction<Recorded>>(self) -> String {
        let Self(spec) = self;
        let energy = spec.sums().energy;
        let meet = || {
            let decay = Decay {
                travel: named("decay", "travel"),
                speed: named("decay", "speed"),
                acceleration: named("decay", "acceleration"),
            };
            let wave = Wave { cosine: Recorded::named("cosine"), sine: Recorded::named("sine") };
            let met = case::<I>(spec).meet(&state(spec), wave, spec.decay.then_some(decay), energy);
            let at = met.approach;
            let memory = I::MEMORY.then_some(at.memory).into_iter().flatten();
            let own = [met.steady, met.beyond].into_iter().chain(energy.then_some(met.excess));
            own.chain([at.indentation, at.speed, at.acceleration]).chain(memory).collect()
        };
        let fly = || {
            let mut state = state(spec);
            case::<I>(spec).fly(&mut state, &kick_at("kick"));
            in_turns(spec.modes, |k| [state.x[k], state.u[k]]).chain([state.touching]).collect()
        };
        let sampled = || {
            let own = |member| named("met", member);
            let approach = approach_at("met.at", |_, number| number);
            let met = Met { steady: own("steady"), beyond: own("beyond"), excess: own("excess"), approach };
            let sample = case::<I>(spec).sampled(&met, kick_at("kick"), energy);
            let work = energy.then_some([sample.work, sample.virial]).into_iter().flatten();
            // The law's own function makes them.
            let forces = spec.sums().forces.then_some([sample.least, sample.most]).into_iter().flatten();
            [sample.beyond, sample.indentation].into_iter().chain(work).chain(forces).collect()
        };
        let met = |words: &[String]| {
            let (own, approach) = words.split_at(words.len() - if I::MEMORY { 5 } else { 3 });
            format!("Met({}, Approach({}))", own.join(", "), approach.join(", "))
        };
        let meet_head = "\nfn meet(lever: Case, state: State, cosine: real, sine: real, decay: Decay) -> Met";
        let sampled_head = "\nfn sampled(lever: Case, met: Met, kick: Kick) -> Sample";
        function(meet_head, meet, met)
            + &spec.state().function("fly(lever: Case, state: State, kick: Kick)", fly)
            + &function(sampled_head, sampled, |words| format!("Sample({}, kick)", words.join(", ")))
    }
}

fn state(spec: &ShaderSpec) -> State<Recorded, MODES_MAX> {
    let (x, u) = (numbered("state", "x", spec.modes), numbered("state", "u", spec.modes));
    State { x, u, touching: named("state", "touching") }
}

fn case<I: Interaction<Recorded>>(spec: &ShaderSpec) -> Case<Recorded, I, MODES_MAX> {
    let own = |member| named("lever", member);
    let each = |member| numbered("lever", member, spec.modes);
    Case {
        flow: Flow {
            count: spec.modes - usize::from(I::MEMORY),
            m00: each("m00"),
            m01: each("m01"),
            m11: each("m11"),
            rate: each("rate"),
            pull: each("pull"),
            drag: each("drag"),
            work_x: each("work_x"),
            work_u: each("work_u"),
            land_x: each("land_x"),
            land_u: each("land_u"),
            shift_x: each("shift_x"),
            shift_u: each("shift_u"),
            corner: own("corner"),
            kick_paid: own("kick_paid"),
            mean_corner: own("mean_corner"),
        },
        free: Free { cosine: own("free_cosine"), sine: own("free_sine"), rate: own("free_rate") },
        gap: own("gap"),
        // The law stands in a function of its own.
        law: I::from_numbers(|| Recorded::splat(ZERO)),
    }
}
