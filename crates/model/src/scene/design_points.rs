//! The points of a design, drawn.

use crate::design::Design;
use rayon::prelude::*;

/// Points that are drawn together: there may be very many.
const AT_ONCE: usize = 1 << 16;

/// The values of a design's quantities, each by itself.
pub(super) fn drawn(design: &Design) -> Vec<Vec<f64>> {
    let mut columns = vec![Vec::new(); design.parameters.len()];
    columns.iter_mut().for_each(|column: &mut Vec<f64>| column.reserve_exact(design.len()));
    for from in (0..design.len()).step_by(AT_ONCE) {
        let to = design.len().min(from + AT_ONCE);
        let rows: Vec<Vec<f64>> = (from..to).into_par_iter().map(|row| design.values(row)).collect();
        for (n, column) in columns.iter_mut().enumerate() {
            column.extend(rows.iter().map(|row| row[n]));
        }
    }
    columns
}
