//! The cases that a sweep stands for, one after the other: quicker than [`Scene::instance`](super::Scene::instance), and without
//! the scene.

use super::address::Address;
use super::axis_zip::law_of;
use super::params::{LawChoice, Params};
use super::{Axis, LAW, Layout, Scene};
use std::sync::Arc;

/// The base case of a scene, and what its sweep puts into it.
#[derive(Clone, Debug)]
pub struct Cases {
    base: Params,
    sets: Vec<Set>,
    count: usize,
}

/// What varies along an axis.
#[derive(Clone, Debug)]
struct Set {
    stride: usize,
    length: usize,
    what: What,
}

#[derive(Clone, Debug)]
enum What {
    Value(Address, Arc<Vec<f64>>),
    Law(Vec<LawChoice>),
}

impl Cases {
    /// Those of a scene.
    pub fn of(scene: &Scene) -> Self {
        let (mut sets, mut stride) = (Vec::new(), scene.len());
        for axis in &scene.sweep.axes {
            let length = axis.values.len();
            if scene.sweep.layout == Layout::Grid {
                stride /= length.max(1);
            } else {
                stride = 1;
            }
            push(&mut sets, axis, (stride, length));
        }
        Self { base: scene.base.clone(), sets, count: scene.len() }
    }

    /// The case before anything is put in: what [`Cases::put`] takes.
    pub fn base(&self) -> Params {
        self.base.clone()
    }

    /// Makes a case that was the base, or any instance, into this instance.
    pub fn put(&self, params: &mut Params, instance: usize) {
        for Set { stride, length, what } in &self.sets {
            let at = instance / stride % length;
            match what {
                What::Value(address, values) => address.set(params, values[at]),
                What::Law(laws) => params.contact.law = laws[at],
            }
        }
    }

    /// An instance, by itself.
    pub fn instance(&self, instance: usize) -> Params {
        let mut params = self.base();
        self.put(&mut params, instance);
        params
    }

    /// How many quantities have a value of their own in each instance.
    pub fn columns(&self) -> usize {
        self.sets.iter().filter(|set| set.length == self.count).count()
    }

    /// The values of a quantity that has one of its own in each instance.
    pub fn column(&self, path: &str) -> Option<&Arc<Vec<f64>>> {
        self.sets.iter().find_map(|set| match &set.what {
            What::Value(address, values) if set.length == self.count && address.path() == path => {
                Some(values)
            }
            _ => None,
        })
    }
}

fn push(sets: &mut Vec<Set>, axis: &Axis, (stride, length): (usize, usize)) {
    let laws: Option<Vec<LawChoice>> = match axis.path == LAW {
        true => axis.words.iter().map(|word| law_of(word)).collect(),
        false => None,
    };
    let address = || Address::find(&axis.path);
    if let Some(laws) = laws.filter(|laws| laws.len() == length) {
        sets.push(Set { stride, length, what: What::Law(laws) });
    } else if let Some(address) = address() {
        sets.push(Set { stride, length, what: What::Value(address, Arc::clone(&axis.values)) });
    }
    axis.columns.iter().for_each(|column| push(sets, column, (stride, length)));
}
