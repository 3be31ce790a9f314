//! Elementary effects of trajectories.

use super::estimate::{Estimate, Spread, sd};

/// Effects in the order of the groups, in units of the output for a step over the whole range of levels.
#[derive(Clone, Debug, PartialEq)]
pub struct Effects {
    /// Mean effect; NaN for a group of several parameters, which may move against each other.
    pub mu: Vec<f64>,
    /// Mean size of an effect (F. Campolongo, J. Cariboni and A. Saltelli, Environ. Model. Softw. 22, 1509 (2007)).
    pub mu_star: Vec<Estimate>,
    /// Standard deviation of the effects; NaN for a group of several parameters.
    pub sigma: Vec<f64>,
}

/// Trajectories of a design: which group moves at which step, and which way.
#[derive(Clone, Debug)]
pub struct Steps<'a> {
    /// Parameters of each group.
    pub groups: &'a [Vec<usize>],
    /// Values of the parameters, by parameter and row.
    pub parameters: &'a [&'a [f64]],
    pub levels: u64,
}

/// Effects of the trajectories among `units`; `rows` has the output of every row of the design.
pub fn effects(rows: &[f64], units: &[u32], steps: &Steps, spread: Spread) -> Effects {
    let groups = steps.groups.len();
    let step = steps.levels as f64 / (2.0 * (steps.levels as f64 - 1.0));
    let mut of = vec![Vec::with_capacity(units.len()); groups];
    let mut place = std::collections::HashMap::new();
    for (at, unit) in units.iter().enumerate() {
        place.insert(*unit, at);
        for row in *unit as usize * (groups + 1)..*unit as usize * (groups + 1) + groups {
            let moves = |member: &usize| steps.parameters[*member][row + 1] - steps.parameters[*member][row];
            let moved = steps.groups.iter().enumerate().find_map(|(group, members)| {
                members.iter().map(moves).find(|by| *by != 0.0).map(|by| (group, by))
            });
            if let Some((group, by)) = moved {
                of[group].push((rows[row + 1] - rows[row]) / step * by.signum());
            }
        }
    }
    // A step that no number can show leaves a trajectory without its effect: nothing is said then.
    let whole = of.iter().all(|effects| effects.len() == units.len());
    let alone = |group: usize, value: f64| if steps.groups[group].len() == 1 { value } else { f64::NAN };
    let mean = |effects: &[f64]| effects.iter().sum::<f64>() / effects.len() as f64;
    let statistic = |some: &[u32]| {
        let size = |effects: &Vec<f64>| match whole {
            true => some.iter().map(|unit| effects[place[unit]].abs()).sum::<f64>() / some.len() as f64,
            false => f64::NAN,
        };
        of.iter().map(size).collect()
    };
    Effects {
        mu: of.iter().enumerate().map(|(group, effects)| alone(group, mean(effects))).collect(),
        sigma: of.iter().enumerate().map(|(group, effects)| alone(group, sd(effects))).collect(),
        mu_star: spread.estimate(units, statistic),
    }
}
