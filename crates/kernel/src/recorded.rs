//! A lane that writes down what is done with it: a law that runs with it writes its own shader.
//!
//! Every operation becomes a node of a tape, and [`Tape::function`] turns the tape into WGSL with the operations in their
//! order. What is used once stands where it is used; the rest gets a name.

use super::Lane;
use super::constants;
use std::cell::RefCell;
use std::fmt::Write;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number of the shader: its node's place on the tape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Recorded(u32);

/// A truth value of the shader, likewise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Flag(u32);

/// What a node is.
#[derive(Clone, Debug)]
enum Node {
    /// A name of the function's surroundings.
    Name(String),
    Operation {
        form: &'static Form,
        operands: [u32; 3],
    },
    /// What a branch leaves: one value where it is not taken, another where it is.
    Variable {
        branch: usize,
        otherwise: u32,
        taken: u32,
    },
}

/// How an operation is written.
#[derive(Debug)]
struct Form {
    /// WGSL with `a`, `b` and `c` in the places of the operands.
    text: &'static str,
    /// How closely it binds: 1 `||`, 2 `&&`, 3 comparisons, 4 sums, 5 products, 6 signs, 7 calls and names.
    binds: u8,
    /// Operands that bind less closely than this stand in parentheses.
    operands: &'static [u8],
}

const ADD: Form = Form { text: "a + b", binds: 4, operands: &[4, 5] };
const SUB: Form = Form { text: "a - b", binds: 4, operands: &[4, 5] };
const MUL: Form = Form { text: "a * b", binds: 5, operands: &[5, 6] };
const DIV: Form = Form { text: "a / b", binds: 5, operands: &[5, 6] };
const NEG: Form = Form { text: "-a", binds: 6, operands: &[7] };
const MUL_ADD: Form = Form { text: "a * b + c", binds: 4, operands: &[5, 6, 5] };
const SQRT: Form = Form { text: "sqrt(a)", binds: 7, operands: &[0] };
const ABS: Form = Form { text: "abs(a)", binds: 7, operands: &[0] };
const MIN: Form = Form { text: "min(a, b)", binds: 7, operands: &[0, 0] };
const MAX: Form = Form { text: "max(a, b)", binds: 7, operands: &[0, 0] };
const SELECT: Form = Form { text: "select(a, b, c)", binds: 7, operands: &[0, 0, 0] };
const LESS: Form = Form { text: "a < b", binds: 3, operands: &[4, 4] };
const BOTH: Form = Form { text: "a && b", binds: 2, operands: &[3, 3] };
const EITHER: Form = Form { text: "a || b", binds: 1, operands: &[3, 3] };
const NOT: Form = Form { text: "!a", binds: 6, operands: &[7] };

/// In the order in which they came to be.
#[derive(Clone, Copy, Debug)]
enum Statement {
    Node(u32),
    Branch(usize),
}

#[derive(Debug, Default)]
struct Branch {
    mask: u32,
    body: Vec<Statement>,
    variables: Vec<u32>,
}

/// All that was recorded for one function.
#[derive(Debug, Default)]
pub struct Tape {
    nodes: Vec<Node>,
    branches: Vec<Branch>,
    /// Statements of the function, and of the branches that are open.
    open: Vec<Vec<Statement>>,
}

thread_local! {
    static TAPE: RefCell<Tape> = RefCell::default();
}

/// Longer expressions get a name even where they are used once.
const LONGEST_EXPRESSION: usize = 60;

impl Recorded {
    /// A number that has this name where the function's text stands.
    pub fn named(name: impl Into<String>) -> Self {
        Self(push(Node::Name(name.into())))
    }
}

fn push(node: Node) -> u32 {
    TAPE.with_borrow_mut(|tape| {
        let place = tape.nodes.len() as u32;
        tape.nodes.push(node);
        if let Some(block) = tape.open.last_mut() {
            block.push(Statement::Node(place));
        }
        place
    })
}

/// Of as many operands as the form has; the others do not count.
fn operation(form: &'static Form, operands: [u32; 3]) -> u32 {
    push(Node::Operation { form, operands })
}

/// The text of a function of which `work` makes the numbers that it returns; `close` puts those into its last line.
pub fn function(
    head: &str,
    work: impl FnOnce() -> Vec<Recorded>,
    close: impl FnOnce(&[String]) -> String,
) -> String {
    TAPE.set(Tape { open: vec![Vec::new()], ..Tape::default() });
    let results = work();
    let tape = TAPE.take();
    Writer::new(&tape, &results).function(head, &tape.open[0], &results, close)
}

macro_rules! binary {
    ($($trait:ident $name:ident $form:ident),*) => {
        $(impl $trait for Recorded {
            type Output = Self;
            fn $name(self, other: Self) -> Self {
                Self(operation(&$form, [self.0, other.0, 0]))
            }
        })*
    };
}

binary!(Add add ADD, Sub sub SUB, Mul mul MUL, Div div DIV);

impl Neg for Recorded {
    type Output = Self;
    fn neg(self) -> Self {
        Self(operation(&NEG, [self.0, 0, 0]))
    }
}

impl From<Recorded> for f64 {
    /// What a shader computes is not known here.
    fn from(_: Recorded) -> f64 {
        f64::NAN
    }
}

impl Lane for Recorded {
    type Mask = Flag;
    type Element = Self;
    const WIDTH: usize = 1;

    fn gather(value: &dyn Fn(usize) -> f64) -> Self {
        Self::splat(value(0))
    }
    fn lane(self, _: usize) -> f64 {
        self.into()
    }
    fn load(from: &[Self]) -> Self {
        from[0]
    }
    fn store(self, to: &mut [Self]) {
        to[0] = self;
    }
    fn element(value: f64) -> Self {
        Self::splat(value)
    }
    fn broadcast(element: Self) -> Self {
        element
    }
    /// By its name in the shader's head. What has none there is no shader to any driver.
    fn splat(value: f64) -> Self {
        let same = |(_, known): &&(&str, f64)| known.to_bits() == value.to_bits();
        let name = constants::ALL.iter().find(same).map(|(name, _)| (*name).to_owned());
        Self::named(name.unwrap_or_else(|| format!("no constant is {value:e}")))
    }
    fn sqrt(self) -> Self {
        Self(operation(&SQRT, [self.0, 0, 0]))
    }
    fn abs(self) -> Self {
        Self(operation(&ABS, [self.0, 0, 0]))
    }
    fn min(self, other: Self) -> Self {
        Self(operation(&MIN, [self.0, other.0, 0]))
    }
    fn max(self, other: Self) -> Self {
        Self(operation(&MAX, [self.0, other.0, 0]))
    }
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Self(operation(&MUL_ADD, [self.0, factor.0, term.0]))
    }
    fn less(self, other: Self) -> Flag {
        Flag(operation(&LESS, [self.0, other.0, 0]))
    }
    fn select(mask: Flag, yes: Self, no: Self) -> Self {
        Self(operation(&SELECT, [no.0, yes.0, mask.0]))
    }
    fn both(a: Flag, b: Flag) -> Flag {
        Flag(operation(&BOTH, [a.0, b.0, 0]))
    }
    fn either(a: Flag, b: Flag) -> Flag {
        Flag(operation(&EITHER, [a.0, b.0, 0]))
    }
    fn not(a: Flag) -> Flag {
        Flag(operation(&NOT, [a.0, 0, 0]))
    }
    /// A shader's instance goes its own way: what depends on a mask belongs into [`Lane::when`].
    fn any(_: Flag) -> bool {
        true
    }

    fn when<T>(
        mask: Flag,
        otherwise: T,
        work: impl FnOnce() -> T,
        zip: impl FnOnce(T, T, &mut dyn FnMut(Self, Self) -> Self) -> T,
    ) -> T {
        let branch = TAPE.with_borrow_mut(|tape| {
            tape.branches.push(Branch { mask: mask.0, ..Branch::default() });
            tape.open.push(Vec::new());
            tape.branches.len() - 1
        });
        let taken = work();
        TAPE.with_borrow_mut(|tape| {
            tape.branches[branch].body = tape.open.pop().unwrap_or_default();
            if let Some(block) = tape.open.last_mut() {
                block.push(Statement::Branch(branch));
            }
        });
        zip(otherwise, taken, &mut |otherwise, taken| {
            if otherwise == taken {
                return taken;
            }
            TAPE.with_borrow_mut(|tape| {
                let place = tape.nodes.len() as u32;
                tape.nodes.push(Node::Variable { branch, otherwise: otherwise.0, taken: taken.0 });
                tape.branches[branch].variables.push(place);
                Self(place)
            })
        })
    }
}

/// Makes text of a tape.
struct Writer<'a> {
    tape: &'a Tape,
    /// How often each node is used.
    uses: Vec<u32>,
    branches_used: Vec<bool>,
    /// What stands for a node: its name, or the expression that is used once.
    words: Vec<String>,
    named: usize,
}

impl<'a> Writer<'a> {
    fn new(tape: &'a Tape, results: &[Recorded]) -> Self {
        let count = tape.nodes.len();
        let mut writer = Self {
            tape,
            uses: vec![0; count],
            branches_used: vec![false; tape.branches.len()],
            words: vec![String::new(); count],
            named: 0,
        };
        results.iter().for_each(|result| writer.mark(result.0));
        writer
    }

    /// Counts a use of a node, and with the first one those of its operands.
    fn mark(&mut self, node: u32) {
        let place = node as usize;
        self.uses[place] += 1;
        if self.uses[place] > 1 {
            return;
        }
        let tape = self.tape;
        match &tape.nodes[place] {
            Node::Name(_) => {}
            Node::Operation { form, operands } => {
                operands[..form.operands.len()].iter().for_each(|operand| self.mark(*operand));
            }
            Node::Variable { branch, otherwise, taken } => {
                if !self.branches_used[*branch] {
                    self.branches_used[*branch] = true;
                    self.mark(tape.branches[*branch].mask);
                }
                self.mark(*otherwise);
                self.mark(*taken);
            }
        }
    }

    fn function(
        mut self,
        head: &str,
        block: &[Statement],
        results: &[Recorded],
        close: impl FnOnce(&[String]) -> String,
    ) -> String {
        let mut out = format!("{head} {{\n");
        self.block(block, 1, &mut out);
        let results: Vec<String> = results.iter().map(|result| self.bare(result.0)).collect();
        let _ = writeln!(out, "    return {};\n}}", close(&results));
        out
    }

    fn block(&mut self, block: &[Statement], depth: usize, out: &mut String) {
        let indent = "    ".repeat(depth);
        let tape = self.tape;
        for statement in block {
            match *statement {
                Statement::Node(node) => self.node(node, &indent, out),
                Statement::Branch(branch) if self.branches_used[branch] => {
                    let Branch { mask, body, variables } = &tape.branches[branch];
                    let used: Vec<u32> =
                        variables.iter().copied().filter(|node| self.uses[*node as usize] > 0).collect();
                    let mut taken = Vec::new();
                    for node in used {
                        let Node::Variable { otherwise, taken: value, .. } = tape.nodes[node as usize] else {
                            continue;
                        };
                        let name = self.name();
                        let _ = writeln!(out, "{indent}var {name} = {};", self.bare(otherwise));
                        self.words[node as usize].clone_from(&name);
                        taken.push((name, value));
                    }
                    let _ = writeln!(out, "{indent}if {} {{", self.bare(*mask));
                    self.block(body, depth + 1, out);
                    for (name, value) in taken {
                        let _ = writeln!(out, "{indent}    {name} = {};", self.bare(value));
                    }
                    let _ = writeln!(out, "{indent}}}");
                }
                Statement::Branch(_) => {}
            }
        }
    }

    /// A line for a node, or the words to be put where it is used.
    fn node(&mut self, node: u32, indent: &str, out: &mut String) {
        let place = node as usize;
        if self.uses[place] == 0 {
            return;
        }
        let (text, atom) = self.expression(node);
        let short = self.uses[place] == 1 && text.len() <= LONGEST_EXPRESSION;
        if atom || short {
            self.words[place] = text;
            return;
        }
        let name = self.name();
        let _ = writeln!(out, "{indent}let {name} = {text};");
        self.words[place] = name;
    }

    fn name(&mut self) -> String {
        self.named += 1;
        format!("t{}", self.named)
    }

    /// A node's text, and whether it is a name.
    fn expression(&self, node: u32) -> (String, bool) {
        match &self.tape.nodes[node as usize] {
            Node::Name(name) => (name.clone(), true),
            Node::Variable { .. } => (self.words[node as usize].clone(), true),
            Node::Operation { form, operands } => {
                // An operand is a letter that stands alone.
                let letters: Vec<char> = form.text.chars().collect();
                let alone = |n: usize| {
                    let beside = |at: Option<usize>| {
                        at.and_then(|at| letters.get(at)).is_some_and(|c| c.is_alphabetic())
                    };
                    !beside(n.checked_sub(1)) && !beside(Some(n + 1))
                };
                let mut out = String::new();
                for (n, letter) in letters.iter().enumerate() {
                    match ['a', 'b', 'c'].iter().position(|name| name == letter).filter(|_| alone(n)) {
                        Some(which) => out += &self.within(operands[which], form.operands[which]),
                        None => out.push(*letter),
                    }
                }
                (out, false)
            }
        }
    }

    fn bare(&self, node: u32) -> String {
        match &self.tape.nodes[node as usize] {
            Node::Name(name) => name.clone(),
            _ => self.words[node as usize].clone(),
        }
    }

    /// In parentheses where it is an expression that binds less closely than `least`.
    fn within(&self, node: u32, least: u8) -> String {
        let bare = self.bare(node);
        let name = bare.chars().all(|c| c.is_alphanumeric() || "_.".contains(c));
        match &self.tape.nodes[node as usize] {
            Node::Operation { form, .. } if !name && form.binds < least => format!("({bare})"),
            _ => bare,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constants::{HALF, ONE, ZERO};

    fn text(work: impl FnOnce(Recorded) -> Recorded) -> String {
        function("fn f(x: real) -> real", || vec![work(Recorded::named("x"))], |words| words.join(", "))
    }

    #[test]
    fn operations_stand_in_their_order() {
        let half = || Recorded::splat(HALF);
        assert_eq!(
            text(|x| x.mul_add(half(), -(x + half())) / x.abs()),
            "fn f(x: real) -> real {\n    return (x * HALF + -(x + HALF)) / abs(x);\n}\n"
        );
    }

    #[test]
    fn what_is_used_twice_has_a_name_and_what_is_not_used_is_left_out() {
        let made = text(|x| {
            let _unused = x.sqrt();
            let root = (x * x).sqrt();
            root * root
        });
        assert_eq!(made, "fn f(x: real) -> real {\n    let t1 = sqrt(x * x);\n    return t1 * t1;\n}\n");
    }

    #[test]
    fn a_branch_changes_what_it_makes_and_nothing_else() {
        let made = text(|x| {
            let zero = Recorded::splat(ZERO);
            crate::when(zero.less(x), zero, || x + Recorded::splat(ONE)) * x
        });
        let expected = "fn f(x: real) -> real {\n    var t1 = ZERO;\n    if ZERO < x {\n        t1 = x + ONE;\n    }\n    return t1 * x;\n}\n";
        assert_eq!(made, expected);
    }

    #[test]
    fn a_number_that_the_head_does_not_have_is_no_shader() {
        assert!(text(|x| x * Recorded::splat(0.123)).contains("no constant is"));
    }
}
