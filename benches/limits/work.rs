//! Floating-point operations of one instance-step, counted in the parsed shader: the CPU kernel is its twin.

use afmsweep::kernel::Entry;
use afmsweep::plan::Plan;
use naga::{Block, Expression, Function, MathFunction, Module, Statement};

/// Sums, products, quotients, roots, min, max and abs of a step, and in the share of them that is `measured` of what it
/// adds to the observables' sums: those of every step, and with all that a branch may add. The CPU skips some of the
/// former too, where no lane needs them; a GPU does a few more, the fundamental's sums of every step. Loops are not
/// counted, the kernel has none.
pub fn operations(plan: &Plan, measured: f64) -> [f64; 2] {
    let class = &plan.classes()[0];
    let spec = plan.shader(class, Entry::Sweep);
    let module = naga::front::wgsl::parse_str(&spec.compose()).expect("the shader is right");
    [false, true].map(|branches| {
        let counted = |name: &str| of_function(&module, named(&module, name), branches) as f64;
        counted("step") + measured * counted("tally_add")
    })
}

fn named<'a>(module: &'a Module, name: &str) -> &'a Function {
    let found = module.functions.iter().find(|(_, function)| function.name.as_deref() == Some(name));
    found.map(|(_, function)| function).expect("the shader has it")
}

fn of_function(module: &Module, function: &Function, branches: bool) -> usize {
    let float = |expression: &Expression| match expression {
        Expression::Binary { op, .. } => matches!(
            op,
            naga::BinaryOperator::Add
                | naga::BinaryOperator::Subtract
                | naga::BinaryOperator::Multiply
                | naga::BinaryOperator::Divide
        ),
        Expression::Math { fun, .. } => {
            matches!(fun, MathFunction::Sqrt | MathFunction::Min | MathFunction::Max | MathFunction::Abs)
        }
        _ => false,
    };
    // Products that only say where a table's entry is are whole numbers; there are a few, in tally_fourier.
    let index = |expression: &Expression| match expression {
        Expression::Binary { left, right, .. } => {
            [left, right].iter().any(|side| matches!(function.expressions[**side], Expression::Literal(_)))
        }
        _ => false,
    };
    let own = |one: &Expression| usize::from(float(one) && !index(one));
    of_block(module, function, &function.body, branches, &own)
}

/// Up to where a step may be done, unless branches count.
fn of_block(
    module: &Module,
    function: &Function,
    block: &Block,
    branches: bool,
    own: &dyn Fn(&Expression) -> usize,
) -> usize {
    let mut sum = 0;
    for statement in block {
        sum += match statement {
            Statement::Emit(range) => {
                range.clone().map(|handle| own(&function.expressions[handle])).sum::<usize>()
            }
            Statement::Call { function, .. } => of_function(module, &module.functions[*function], branches),
            Statement::Block(block) => of_block(module, function, block, branches, own),
            Statement::If { accept, reject, .. } if branches => {
                [accept, reject].iter().map(|block| of_block(module, function, block, branches, own)).sum()
            }
            Statement::If { accept, reject, .. } if [accept, reject].iter().any(|block| returns(block)) => {
                return sum;
            }
            _ => 0,
        };
    }
    sum
}

fn returns(block: &Block) -> bool {
    block.iter().any(|statement| matches!(statement, Statement::Return { .. }))
}
