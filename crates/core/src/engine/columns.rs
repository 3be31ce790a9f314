//! Results of very many instances, column by column: a number that all have in common takes no place.

use super::Finished;
use crate::observe::{Measured, Status};

/// What became of instances, by their numbers. See [`Finished`].
#[derive(Clone, Debug, PartialEq)]
pub struct Columns {
    statuses: Vec<Status>,
    columns: [Column; Measured::WIDTH],
}

/// A number of each instance, by its bits.
#[derive(Clone, Debug, PartialEq)]
enum Column {
    All(u64),
    Each(Vec<u64>),
}

impl Columns {
    /// So many instances that were not run.
    pub fn not_run(count: usize) -> Self {
        let none = Finished::NOT_RUN.measured.numbers().map(f64::to_bits);
        Self { statuses: vec![Status::NotRun; count], columns: none.map(Column::All) }
    }

    /// Number of instances.
    pub fn len(&self) -> usize {
        self.statuses.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.statuses.is_empty()
    }

    /// What became of an instance.
    pub fn get(&self, instance: usize) -> Finished {
        let mut numbers = [f64::NAN; Measured::WIDTH];
        for (number, column) in numbers.iter_mut().zip(&self.columns) {
            *number = f64::from_bits(match column {
                Column::All(bits) => *bits,
                Column::Each(all) => all[instance],
            });
        }
        Finished { measured: Measured::of_numbers(&numbers), status: self.statuses[instance] }
    }

    /// Says what became of an instance.
    pub fn set(&mut self, instance: usize, finished: &Finished) {
        let count = self.len();
        for (number, column) in finished.measured.numbers().into_iter().zip(&mut self.columns) {
            let bits = number.to_bits();
            match column {
                Column::All(all) if *all == bits => {}
                Column::All(all) => {
                    let mut each = vec![*all; count];
                    each[instance] = bits;
                    *column = Column::Each(each);
                }
                Column::Each(each) => each[instance] = bits,
            }
        }
        self.statuses[instance] = finished.status;
    }

    /// One word for each instance.
    pub fn statuses(&self) -> &[Status] {
        &self.statuses
    }

    /// Says how good an instance's numbers are.
    pub fn set_status(&mut self, instance: usize, status: Status) {
        self.statuses[instance] = status;
    }

    /// What became of all of them, in their order.
    pub fn iter(&self) -> impl Iterator<Item = Finished> + Clone + '_ {
        (0..self.len()).map(|instance| self.get(instance))
    }
}

impl From<&[Finished]> for Columns {
    fn from(all: &[Finished]) -> Self {
        let mut columns = Self::not_run(all.len());
        all.iter().enumerate().for_each(|(instance, one)| columns.set(instance, one));
        columns
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every bit comes back, of numbers that are no numbers too; instances that nobody set are not run.
    #[test]
    fn columns_give_back_what_was_set() {
        let odd = f64::from_bits(0xfff8_0000_0000_0001);
        let one = Measured { phase: -0.0, gap: odd, contacts: 2.0, ..Measured::NONE };
        let finished = |measured, status| Finished { measured, status };
        let all = [
            finished(one, Status::Ok),
            Finished::NOT_RUN,
            finished(Measured { phase: 0.0, ..one }, Status::Sensitive),
        ];
        let mut columns = Columns::from(&all[..]);
        let bits = |one: Finished| (one.measured.numbers().map(f64::to_bits), one.status);
        assert!(columns.iter().map(bits).eq(all.iter().copied().map(bits)));
        columns.set(1, &all[0]);
        columns.set_status(0, Status::AccuracyNotMet);
        assert_eq!(bits(columns.get(1)), bits(all[0]));
        assert_eq!(columns.statuses(), [Status::AccuracyNotMet, Status::Ok, Status::Sensitive]);
        assert_eq!((columns.len(), bits(Columns::not_run(1).get(0))), (3, bits(Finished::NOT_RUN)));
    }
}
