//! WGSL of what was recorded: every operation in its order, branches where there were some.
//!
//! What is used once stands where it is used; the rest gets a name. What is not used is left out.

use super::operation_form::Form;
use super::recorded::{Branch, Node, Recorded, Statement, Tape, record};
use std::fmt::Write;

/// Longer expressions get a name even where they are used once.
const LONGEST_EXPRESSION: usize = 60;

/// The text of a function of which `work` makes the numbers that it returns; `close` makes one value of them.
pub fn function(
    head: &str,
    work: impl FnOnce() -> Vec<Recorded>,
    close: impl FnOnce(&[String]) -> String,
) -> String {
    let (tape, results) = record(work);
    Writer::new(&tape, &results).function(head, &tape.open[0], &results, close)
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

    /// A line for an operation, or the words to be put where it is used.
    fn node(&mut self, node: u32, indent: &str, out: &mut String) {
        let (place, tape) = (node as usize, self.tape);
        let Node::Operation { form, operands } = &tape.nodes[place] else { return };
        if self.uses[place] == 0 {
            return;
        }
        let mut text = self.expression(form, operands);
        if self.uses[place] > 1 || text.len() > LONGEST_EXPRESSION {
            let name = self.name();
            let _ = writeln!(out, "{indent}let {name} = {text};");
            text = name;
        }
        self.words[place] = text;
    }

    fn name(&mut self) -> String {
        self.named += 1;
        format!("t{}", self.named)
    }

    /// An operation's text: its form, with the operands in place of the letters that stand alone.
    fn expression(&self, form: &Form, operands: &[u32; 3]) -> String {
        let letters: Vec<char> = form.text.chars().collect();
        let alone = |n: usize| {
            let beside =
                |at: Option<usize>| at.and_then(|at| letters.get(at)).is_some_and(|c| c.is_alphabetic());
            !beside(n.checked_sub(1)) && !beside(Some(n + 1))
        };
        let mut out = String::new();
        for (n, letter) in letters.iter().enumerate() {
            match ['a', 'b', 'c'].iter().position(|name| name == letter).filter(|_| alone(n)) {
                Some(which) => out += &self.within(operands[which], form.operands[which]),
                None => out.push(*letter),
            }
        }
        out
    }

    /// The words that stand for a node.
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
    use crate::Lane;
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
