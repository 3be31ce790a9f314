//! Compiles the shader to SPIR-V that forbids the driver to fuse sums of products, or to reorder them. Every operation of the
//! text then rounds, as on the CPU path.

use super::Failure;
use naga::back::spv;
use naga::front::wgsl;
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use naga::valid::{Capabilities, ValidationFlags, Validator};

/// Words before the first instruction.
const HEADER: usize = 5;
// SPIR-V specification, section 3: instructions and the decoration.
const DECORATE: u32 = 71;
const NO_CONTRACTION: u32 = 42;
/// FNegate, FAdd, FSub, FMul, FDiv, VectorTimesScalar.
const ARITHMETIC: [u32; 6] = [127, 129, 131, 133, 136, 142];

/// Compiles the text and decorates every result of float arithmetic with `NoContraction`. An index that is `checked` stays within
/// its array, whatever the text says.
pub(super) fn compile(text: &str, checked: bool) -> Result<Vec<u32>, Failure> {
    translated(text, checked).map(|words| decorated(&words)).map_err(Failure::Refused)
}

/// A shader as SPIR-V, of which a driver may fuse sums and products, or as `strict` runs have it.
///
/// # Errors
/// What is wrong with the text, and where.
pub fn spirv(text: &str, strict: bool) -> Result<Vec<u32>, String> {
    let words = translated(text, false)?;
    Ok(if strict { decorated(&words) } else { words })
}

fn translated(text: &str, checked: bool) -> Result<Vec<u32>, String> {
    let module = wgsl::parse_str(text).map_err(|error| error.emit_to_string(text))?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::FLOAT64)
        .validate(&module)
        .map_err(|error| error.emit_to_string(text))?;
    let policy = if checked { BoundsCheckPolicy::Restrict } else { BoundsCheckPolicy::Unchecked };
    let bounds_check_policies =
        BoundsCheckPolicies { index: policy, buffer: policy, image_load: policy, binding_array: policy };
    let options =
        spv::Options { flags: spv::WriterFlags::empty(), bounds_check_policies, ..spv::Options::default() };
    spv::write_vec(&module, &info, &options, None).map_err(|error| error.to_string())
}

fn decorated(words: &[u32]) -> Vec<u32> {
    let mut place = None;
    let mut decorations = Vec::new();
    let mut at = HEADER;
    while let Some(first) = words.get(at) {
        let (code, length) = (first & 0xffff, (first >> 16) as usize);
        if code == DECORATE {
            place.get_or_insert(at);
        }
        if ARITHMETIC.contains(&code)
            && let Some(result) = words.get(at + 2)
        {
            decorations.extend([3 << 16 | DECORATE, *result, NO_CONTRACTION]);
        }
        at += length.max(1);
    }
    // The bindings are decorated, so a place exists.
    let place = place.unwrap_or(HEADER);
    [&words[..place], &decorations, &words[place..]].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sum_and_product_is_decorated() {
        let text = "@group(0) @binding(0) var<storage, read_write> a: array<f32>;
            @compute @workgroup_size(1) fn sweep() {
                let both = a[6] * vec3<f32>(a[7], a[8], a[9]);
                a[0] = a[1] * a[2] + a[3] - a[4] / -a[5];
                a[1] = both.x;
            }";
        let words = compile(text, false).unwrap();
        let (mut results, mut targets, mut at) = (Vec::new(), Vec::new(), HEADER);
        while at < words.len() {
            match words[at] & 0xffff {
                DECORATE if words[at + 2] == NO_CONTRACTION => targets.push(words[at + 1]),
                code if ARITHMETIC.contains(&code) => results.push(words[at + 2]),
                _ => {}
            }
            at += (words[at] >> 16) as usize;
        }
        assert_eq!(at, words.len());
        assert_eq!(results.len(), 6);
        assert_eq!(targets, results);
    }
}
