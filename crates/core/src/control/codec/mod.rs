//! The stored bytes of a run: chunks, and answers to follow-up questions.

mod chunk_codec;
mod chunk_reader;
mod column_codec;
mod followup_codec;

pub use chunk_codec::{number as portion_number, to_bytes as portion_to_bytes};
pub(super) use chunk_reader::ChunkReader;
pub use followup_codec::{
    budget_from_bytes, budget_to_bytes, from_bytes as answers_from_bytes, keys, numbers_from_bytes,
    numbers_key, numbers_to_bytes, to_bytes as answers_to_bytes,
};
