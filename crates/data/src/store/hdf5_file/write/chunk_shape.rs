//! How datasets are cut.

/// Elements of a chunk: 512 KiB of f64, below the 1 MiB that readers cache by default.
const CHUNK: usize = 65_536;

/// Whole rows, cut along the slowest dimensions until a chunk is small enough.
pub(super) fn chunk(shape: &[usize]) -> Vec<usize> {
    let mut chunk = shape.to_vec();
    for dim in 0..chunk.len() {
        let behind: usize = chunk[dim + 1..].iter().product();
        chunk[dim] = (CHUNK / behind.max(1)).clamp(1, shape[dim]);
        if chunk[dim] > 1 {
            break;
        }
    }
    chunk
}
