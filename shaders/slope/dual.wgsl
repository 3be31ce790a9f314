// A number and its derivatives by the three numbers of an approach. Twin: crates/kernel/src/dual.rs
// The law's own functions with such numbers in place of plain ones are made of its files (crates/kernel/src/derived.rs).

struct Dual {
    value: real,
    by: vec3<real>,
}

fn dual_of(value: real) -> Dual {
    return Dual(value, vec3<real>(ZERO, ZERO, ZERO));
}

fn dual_add(a: Dual, b: Dual) -> Dual {
    return Dual(a.value + b.value, a.by + b.by);
}

fn dual_sub(a: Dual, b: Dual) -> Dual {
    return Dual(a.value - b.value, a.by - b.by);
}

fn dual_mul(a: Dual, b: Dual) -> Dual {
    return Dual(a.value * b.value, a.by * b.value + a.value * b.by);
}

fn dual_mul_add(a: Dual, b: Dual, c: Dual) -> Dual {
    return Dual(a.value * b.value + c.value, a.by * b.value + (a.value * b.by + c.by));
}

fn dual_div(a: Dual, b: Dual) -> Dual {
    let value = a.value / b.value;
    let inverse = ONE / b.value;
    return Dual(value, (-value * b.by + a.by) * inverse);
}

fn dual_neg(a: Dual) -> Dual {
    return Dual(-a.value, -a.by);
}

fn dual_sqrt(a: Dual) -> Dual {
    let value = sqrt(a.value);
    let slope = HALF / max(value, LEAST);
    return Dual(value, a.by * slope);
}

fn dual_abs(a: Dual) -> Dual {
    return Dual(abs(a.value), select(a.by, -a.by, a.value < ZERO));
}

fn dual_min(a: Dual, b: Dual) -> Dual {
    return Dual(min(a.value, b.value), select(b.by, a.by, a.value < b.value));
}

fn dual_max(a: Dual, b: Dual) -> Dual {
    return Dual(max(a.value, b.value), select(b.by, a.by, b.value < a.value));
}

fn dual_less(a: Dual, b: Dual) -> bool {
    return a.value < b.value;
}

fn dual_select(no: Dual, yes: Dual, which: bool) -> Dual {
    return Dual(select(no.value, yes.value, which), select(no.by, yes.by, which));
}
