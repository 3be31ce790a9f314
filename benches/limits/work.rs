//! Floating-point operations of one instance-step, counted in the parsed shader: the CPU kernel is its twin.

use afmsweep::contact::Law;
use afmsweep::kernel::ShaderSpec;
use afmsweep::kernel::contact::{Dmt, Hertz, Interaction, Jkr, Nothing};
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::Start;
use naga::{Block, Expression, Function, MathFunction, Module, Statement};

/// + - * / sqrt min max abs of a step and of what it adds to the observables' sums, both sides of every branch.
pub fn operations(plan: &Plan) -> usize {
    let class = &plan.classes[0];
    let spec = ShaderSpec {
        law: match class.law {
            Law::None => <Nothing as Interaction<f64>>::SHADER,
            Law::Hertz => <Hertz<f64> as Interaction<f64>>::SHADER,
            Law::Dmt => <Dmt<f64> as Interaction<f64>>::SHADER,
            Law::Jkr => <Jkr<f64> as Interaction<f64>>::SHADER,
        },
        modes: class.modes,
        wants: plan.wants,
        measured: true,
        decay: plan.run.start == Start::Rest,
        double: plan.precision == Precision::F64,
    };
    let module = naga::front::wgsl::parse_str(&spec.compose()).expect("the shader is right");
    ["step", "tally_add"].iter().map(|name| of_function(&module, named(&module, name))).sum()
}

fn named<'a>(module: &'a Module, name: &str) -> &'a Function {
    let found = module.functions.iter().find(|(_, function)| function.name.as_deref() == Some(name));
    found.map(|(_, function)| function).expect("the shader has it")
}

fn of_function(module: &Module, function: &Function) -> usize {
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
    let own = function.expressions.iter().filter(|(_, one)| float(one) && !index(one)).count();
    own + calls(module, &function.body)
}

fn calls(module: &Module, block: &Block) -> usize {
    block
        .iter()
        .map(|statement| match statement {
            Statement::Call { function, .. } => of_function(module, &module.functions[*function]),
            Statement::Block(block) => calls(module, block),
            Statement::If { accept, reject, .. } => calls(module, accept) + calls(module, reject),
            _ => 0,
        })
        .sum()
}
