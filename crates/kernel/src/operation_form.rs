//! How the operations of a lane are written in WGSL.

/// How an operation is written.
#[derive(Debug)]
pub struct Form {
    /// WGSL with `a`, `b` and `c` in the places of the operands.
    pub text: &'static str,
    /// How closely it binds: 1 `||`, 2 `&&`, 3 comparisons, 4 sums, 5 products, 6 signs, 7 calls and names.
    pub binds: u8,
    /// Operands that bind less closely than this stand in parentheses.
    pub operands: &'static [u8],
}

pub const ADD: Form = Form { text: "a + b", binds: 4, operands: &[4, 5] };
pub const SUB: Form = Form { text: "a - b", binds: 4, operands: &[4, 5] };
pub const MUL: Form = Form { text: "a * b", binds: 5, operands: &[5, 6] };
pub const DIV: Form = Form { text: "a / b", binds: 5, operands: &[5, 6] };
pub const NEG: Form = Form { text: "-a", binds: 6, operands: &[7] };
pub const MUL_ADD: Form = Form { text: "a * b + c", binds: 4, operands: &[5, 6, 5] };
pub const SQRT: Form = Form { text: "sqrt(a)", binds: 7, operands: &[0] };
pub const ABS: Form = Form { text: "abs(a)", binds: 7, operands: &[0] };
pub const MIN: Form = Form { text: "min(a, b)", binds: 7, operands: &[0, 0] };
pub const MAX: Form = Form { text: "max(a, b)", binds: 7, operands: &[0, 0] };
pub const SELECT: Form = Form { text: "select(a, b, c)", binds: 7, operands: &[0, 0, 0] };
pub const LESS: Form = Form { text: "a < b", binds: 3, operands: &[4, 4] };
pub const BOTH: Form = Form { text: "a && b", binds: 2, operands: &[3, 3] };
pub const EITHER: Form = Form { text: "a || b", binds: 1, operands: &[3, 3] };
pub const NOT: Form = Form { text: "!a", binds: 6, operands: &[7] };
/// The place of a row in the tables: number of the table, and what it is looked up for.
pub const ROW: Form = Form { text: "table_row(a, b)", binds: 7, operands: &[0, 0] };
/// A row's numbers, by their columns.
pub const CELL: [Form; 11] = [
    cell("drives[a]"),
    cell("drives[a + 1u]"),
    cell("drives[a + 2u]"),
    cell("drives[a + 3u]"),
    cell("drives[a + 4u]"),
    cell("drives[a + 5u]"),
    cell("drives[a + 6u]"),
    cell("drives[a + 7u]"),
    cell("drives[a + 8u]"),
    cell("drives[a + 9u]"),
    cell("drives[a + 10u]"),
];

const fn cell(text: &'static str) -> Form {
    Form { text, binds: 7, operands: &[4] }
}
