//! Results of very many instances by column. A number that is the same for all takes no memory per instance.

use super::Finished;
use crate::observe::{Measured, Observable, Status};

/// Results of instances, by number. See [`Finished`].
#[derive(Clone, Debug, PartialEq)]
pub struct ResultColumns {
    statuses: Vec<Status>,
    columns: [Column; Measured::WIDTH],
    /// Which numbers are stored; the others read as NaN.
    held: WantedColumns,
}

/// A number of each instance, by its bits.
#[derive(Clone, Debug, PartialEq)]
enum Column {
    All(u64),
    Each(Vec<u64>),
}

impl ResultColumns {
    /// `count` instances that were not run.
    pub fn not_run(count: usize) -> Self {
        let none = Finished::NOT_RUN.measured.numbers().map(f64::to_bits);
        let held = WantedColumns([true; Measured::WIDTH]);
        Self { statuses: vec![Status::NotRun; count], columns: none.map(Column::All), held }
    }

    /// The same. Numbers that are always measured are stored only if these observables need them.
    pub fn of_observables(count: usize, asked: &[Observable]) -> Self {
        Self { held: WantedColumns::by(asked), ..Self::not_run(count) }
    }

    /// Number of instances.
    pub fn len(&self) -> usize {
        self.statuses.len()
    }

    /// Whether there are no instances.
    pub fn is_empty(&self) -> bool {
        self.statuses.is_empty()
    }

    /// The result of an instance.
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

    /// Sets the result of an instance.
    pub fn set(&mut self, instance: usize, finished: &Finished) {
        let count = self.len();
        let numbers = finished.measured.numbers().into_iter().zip(self.held.0);
        for ((number, _), column) in numbers.zip(&mut self.columns).filter(|((_, held), _)| *held) {
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

    /// The status of each instance.
    pub fn statuses(&self) -> &[Status] {
        &self.statuses
    }

    /// Sets the status of an instance.
    pub fn set_status(&mut self, instance: usize, status: Status) {
        self.statuses[instance] = status;
    }

    /// All results, in order.
    pub fn iter(&self) -> impl Iterator<Item = Finished> + Clone + '_ {
        (0..self.len()).map(|instance| self.get(instance))
    }
}

/// Which numbers of a measurement are needed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WantedColumns([bool; Measured::WIDTH]);

impl WantedColumns {
    /// The numbers in these observables, and those that determine branches, contacts and scales of errors.
    pub fn by(asked: &[Observable]) -> Self {
        let mut wanted = Measured::of_numbers(&[1.0; Measured::WIDTH]);
        let mut drop_unless = |of: &[Observable], number: &dyn Fn(&mut Measured) -> &mut f64| {
            if !of.iter().any(|one| asked.contains(one)) {
                *number(&mut wanted) = f64::NAN;
            }
        };
        drop_unless(&[Observable::DeflectionAmplitude, Observable::DeflectionPhase], &|all| {
            &mut all.deflection_amplitude
        });
        drop_unless(&[Observable::DeflectionPhase], &|all| &mut all.deflection_phase);
        drop_unless(&[Observable::DeflectionMean], &|all| &mut all.deflection_mean);
        drop_unless(&[Observable::FreePhase], &|all| &mut all.free_phase);
        drop_unless(&[Observable::FrequencyShift], &|all| &mut all.frequency_shift);
        drop_unless(&[Observable::Gap], &|all| &mut all.gap);
        // The loss is a scale of the virial's errors.
        drop_unless(&[Observable::Dissipation, Observable::Virial], &|all| &mut all.dissipation);
        drop_unless(&[Observable::Virial], &|all| &mut all.virial);
        Self(wanted.numbers().map(|number| !number.is_nan()))
    }

    /// The measurement with only these numbers.
    pub fn only(self, measured: &Measured) -> Measured {
        let mut numbers = measured.numbers();
        numbers.iter_mut().zip(self.0).for_each(|(number, wanted)| {
            if !wanted {
                *number = f64::NAN;
            }
        });
        Measured::of_numbers(&numbers)
    }
}

impl From<&[Finished]> for ResultColumns {
    fn from(all: &[Finished]) -> Self {
        let mut columns = Self::not_run(all.len());
        all.iter().enumerate().for_each(|(instance, one)| columns.set(instance, one));
        columns
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every bit comes back, also of NaNs; instances that were never set are not run.
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
        let mut columns = ResultColumns::from(&all[..]);
        let bits = |one: Finished| (one.measured.numbers().map(f64::to_bits), one.status);
        assert!(columns.iter().map(bits).eq(all.iter().copied().map(bits)));
        columns.set(1, &all[0]);
        columns.set_status(0, Status::AccuracyNotMet);
        assert_eq!(bits(columns.get(1)), bits(all[0]));
        assert_eq!(columns.statuses(), [Status::AccuracyNotMet, Status::Ok, Status::Sensitive]);
        assert_eq!((columns.len(), bits(ResultColumns::not_run(1).get(0))), (3, bits(Finished::NOT_RUN)));
    }

    /// Every requested number comes back; numbers that are always measured but were not requested do not.
    #[test]
    fn what_was_asked_for_is_held() {
        let numbers: [f64; Measured::WIDTH] = std::array::from_fn(|n| n as f64);
        let finished = Finished { measured: Measured::of_numbers(&numbers), status: Status::Ok };
        for observable in Observable::all() {
            let mut columns = ResultColumns::of_observables(2, &[observable]);
            columns.set(1, &finished);
            let written = |one: Finished| {
                let mut row = vec![f64::NAN; observable.width()];
                observable.write(&one.measured, &mut row);
                row
            };
            assert_eq!(written(columns.get(1)), written(finished), "{}", observable.name());
            let back = columns.get(1).measured;
            assert_eq!(
                (back.phase, back.force_mean),
                (finished.measured.phase, finished.measured.force_mean)
            );
            assert_eq!(back.gap.is_nan(), observable != Observable::Gap);
        }
    }
}
