//! A lane that writes down what is done with it: a law that runs with it writes its own shader.
//!
//! Every operation becomes a node of a tape, and [`wgsl::function`](super::wgsl::function) turns the tape into
//! WGSL with the operations in their order.

use super::Lane;
use super::constants;
use super::contact::force_table::COLUMNS;
use super::operation_form::{self, Form};
use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number of the shader: its node's place on the tape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Recorded(pub(super) u32);

/// A truth value of the shader, likewise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Flag(u32);

/// What a node is.
#[derive(Clone, Debug)]
pub(super) enum Node {
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

/// In the order in which they came to be.
#[derive(Clone, Copy, Debug)]
pub(super) enum Statement {
    Node(u32),
    Branch(usize),
}

#[derive(Debug, Default)]
pub(super) struct Branch {
    pub mask: u32,
    pub body: Vec<Statement>,
    pub variables: Vec<u32>,
}

/// All that was recorded for one function.
#[derive(Debug, Default)]
pub struct Tape {
    pub(super) nodes: Vec<Node>,
    pub(super) branches: Vec<Branch>,
    /// Statements of the function, and of the branches that are open.
    pub(super) open: Vec<Vec<Statement>>,
}

thread_local! {
    static TAPE: RefCell<Tape> = RefCell::default();
}

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

/// What `work` records, and the numbers that it returns.
pub(super) fn record(work: impl FnOnce() -> Vec<Recorded>) -> (Tape, Vec<Recorded>) {
    TAPE.set(Tape { open: vec![Vec::new()], ..Tape::default() });
    let results = work();
    (TAPE.take(), results)
}

macro_rules! binary {
    ($($trait:ident $name:ident $form:ident),*) => {
        $(impl $trait for Recorded {
            type Output = Self;
            fn $name(self, other: Self) -> Self {
                Self(operation(&operation_form::$form, [self.0, other.0, 0]))
            }
        })*
    };
}

binary!(Add add ADD, Sub sub SUB, Mul mul MUL, Div div DIV);

impl Neg for Recorded {
    type Output = Self;
    fn neg(self) -> Self {
        Self(operation(&operation_form::NEG, [self.0, 0, 0]))
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
        Self(operation(&operation_form::SQRT, [self.0, 0, 0]))
    }
    fn abs(self) -> Self {
        Self(operation(&operation_form::ABS, [self.0, 0, 0]))
    }
    fn min(self, other: Self) -> Self {
        Self(operation(&operation_form::MIN, [self.0, other.0, 0]))
    }
    fn max(self, other: Self) -> Self {
        Self(operation(&operation_form::MAX, [self.0, other.0, 0]))
    }
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Self(operation(&operation_form::MUL_ADD, [self.0, factor.0, term.0]))
    }
    fn less(self, other: Self) -> Flag {
        Flag(operation(&operation_form::LESS, [self.0, other.0, 0]))
    }
    fn select(mask: Flag, yes: Self, no: Self) -> Self {
        Self(operation(&operation_form::SELECT, [no.0, yes.0, mask.0]))
    }
    fn both(a: Flag, b: Flag) -> Flag {
        Flag(operation(&operation_form::BOTH, [a.0, b.0, 0]))
    }
    fn either(a: Flag, b: Flag) -> Flag {
        Flag(operation(&operation_form::EITHER, [a.0, b.0, 0]))
    }
    fn not(a: Flag) -> Flag {
        Flag(operation(&operation_form::NOT, [a.0, 0, 0]))
    }
    /// A row of the tables that follow the drives.
    fn look_up(self, table: Self) -> [Self; COLUMNS] {
        let row = operation(&operation_form::ROW, [table.0, self.0, 0]);
        std::array::from_fn(|column| Self(operation(&operation_form::CELL[column], [row, 0, 0])))
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
