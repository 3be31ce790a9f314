//! What a run writes down, as bytes and back: portions, and what is asked of single instances after them.

mod answers;
mod columns;
mod portion;
mod view;

pub use answers::{
    allowance_from_bytes, allowance_to_bytes, from_bytes as answers_from_bytes, numbers_from_bytes,
    numbers_question, numbers_to_bytes, questions, to_bytes as answers_to_bytes,
};
pub use portion::{number as portion_number, to_bytes as portion_to_bytes};
pub(super) use view::View;
