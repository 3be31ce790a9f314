// Linear equations of an instance, by Gauss' elimination with pivots. Twin: crates/kernel/src/newton.rs

// A number of the slope; its columns are as crates/kernel/src/tangent.rs's twin leaves them.
fn slope_at(column: u32, row: u32, i: u32) -> real {
    return columns[at(row * NUMBERS + column, i)];
}

// The root of the sum of the squares of the whole slope.
fn steepness(i: u32) -> real {
    var even = ZERO;
    var odd = ZERO;
    var column = 0u;
    loop {
        if column >= job.count {
            break;
        }
        var row = 0u;
        loop {
            if row >= job.count {
                break;
            }
            let first = slope_at(column, row, i);
            let second = slope_at(column, row + 1u, i);
            even = first * first + even;
            odd = second * second + odd;
            row += 2u;
        }
        column += 1u;
    }
    return sqrt(even + odd);
}

fn fill(i: u32, shift: real) {
    var column = 0u;
    loop {
        if column >= job.count {
            break;
        }
        var row = 0u;
        loop {
            if row >= job.count {
                break;
            }
            factors[entry(column, row, i)] = select(ZERO, shift, row == column) - slope_at(column, row, i);
            factors[entry(column, row + 1u, i)] = select(ZERO, shift, row + 1u == column) - slope_at(column, row + 1u, i);
            row += 2u;
        }
        column += 1u;
    }
}

// The row of the largest number of a column, from the diagonal on.
fn pivot_of(i: u32, k: u32) -> u32 {
    var pivot = k;
    var largest = abs(factors[entry(k, k, i)]);
    var row = k + 1u;
    loop {
        if row >= job.count {
            break;
        }
        let size = abs(factors[entry(k, row, i)]);
        if largest < size {
            largest = size;
            pivot = row;
        }
        row += 1u;
    }
    return pivot;
}

fn swap(i: u32, k: u32, pivot: u32, step: ptr<function, Numbers>) {
    var column = k;
    loop {
        if column >= job.count {
            break;
        }
        let above = factors[entry(column, k, i)];
        factors[entry(column, k, i)] = factors[entry(column, pivot, i)];
        factors[entry(column, pivot, i)] = above;
        column += 1u;
    }
    let above = (*step)[k];
    (*step)[k] = (*step)[pivot];
    (*step)[pivot] = above;
}

fn take(place: u32, share: real, by: real) {
    factors[place] = -share * by + factors[place];
}

// Takes the k-th row from those below it, so that nothing is left of the k-th column there. Four of them at a turn: lavapipe ends a
// dispatch's loops after 65,535, all that instances side by side go through counts, and where one of them is looked at and another
// strides that is three solutions of up to 24 modes' equations.
fn clear(i: u32, k: u32, inverse: real, step: ptr<function, Numbers>) {
    var row = k + 1u;
    loop {
        if row >= job.count {
            break;
        }
        let share = factors[entry(k, row, i)] * inverse;
        factors[entry(k, row, i)] = share;
        (*step)[row] = -share * (*step)[k] + (*step)[row];
        row += 1u;
    }
    var column = k + 1u;
    loop {
        if column >= job.count {
            break;
        }
        let by = factors[entry(column, k, i)];
        row = k + 1u;
        loop {
            if row >= job.count {
                break;
            }
            take(entry(column, row, i), factors[entry(k, row, i)], by);
            if row + 1u < job.count {
                take(entry(column, row + 1u, i), factors[entry(k, row + 1u, i)], by);
            }
            if row + 2u < job.count {
                take(entry(column, row + 2u, i), factors[entry(k, row + 2u, i)], by);
            }
            if row + 3u < job.count {
                take(entry(column, row + 3u, i), factors[entry(k, row + 3u, i)], by);
            }
            row += 4u;
        }
        column += 1u;
    }
}

// Solves (shift - slope) step = step; false where a column has no pivot.
fn solve(i: u32, shift: real, step: ptr<function, Numbers>) -> bool {
    fill(i, shift);
    var k = 0u;
    loop {
        if k >= job.count {
            break;
        }
        let pivot = pivot_of(i, k);
        let largest = factors[entry(k, pivot, i)];
        if !(ZERO < abs(largest)) {
            return false;
        }
        if pivot != k {
            swap(i, k, pivot, step);
        }
        clear(i, k, ONE / largest, step);
        k += 1u;
    }
    loop {
        if k == 0u {
            break;
        }
        k -= 1u;
        (*step)[k] = (*step)[k] / factors[entry(k, k, i)];
        var row = 0u;
        loop {
            if row >= k {
                break;
            }
            (*step)[row] = -factors[entry(k, row, i)] * (*step)[k] + (*step)[row];
            row += 1u;
        }
    }
    return true;
}
