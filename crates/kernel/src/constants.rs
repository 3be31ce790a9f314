//! Every number of the kernel's arithmetic, once: constants here, and by the same names in the
//! generated head of the shader.

macro_rules! constants {
    ($($(#[$doc:meta])* $name:ident = $value:expr;)*) => {
        $($(#[$doc])* pub const $name: f64 = $value;)*
        /// Name and value of each.
        pub(crate) const ALL: &[(&str, f64)] = &[$((stringify!($name), $name)),*];
    };
}

constants! {
    ZERO = 0.0;
    ONE = 1.0;
    TWO = 2.0;
    THREE = 3.0;
    FOUR = 4.0;
    FIVE = 5.0;
    SIX = 6.0;
    EIGHT = 8.0;
    HALF = 0.5;
    QUARTER = 0.25;
    EIGHTH = 0.125;
    SIXTH = 1.0 / 6.0;
    TENTH = 0.1;
    THIRD = 1.0 / 3.0;
    TWELFTH = 1.0 / 12.0;
    TWENTY_FOURTH = 1.0 / 24.0;
    EIGHTIETH = 1.0 / 80.0;
    ONE_120TH = 1.0 / 120.0;
    /// Beyond any indentation, within f32.
    FAR = 1e30;
    /// The longest stride towards a periodic state, in free amplitudes: what is farther off is another motion.
    FARTHEST = 0.1;
    /// Beyond so many periods a stride of a search stands for infinitely many: it is Newton's step.
    NEWTON = 1e5;
    /// Factor on the pseudo-time after a step that leaves the residual as it is. A step that reduces it counts as much more.
    LONGER = 2.0;
    /// Largest factor on the pseudo-time after a step.
    LONGEST = 10.0;
    /// Newton's step is accepted if it reduces the residual by this factor at least.
    GAINS = 1.05;
    /// Keeps 0/0 out: outside, at JKR's fold, in times of touch and of letting go; far below any root of an indentation.
    LEAST = 1e-30;
    /// Factor of Hertz's energy, (2/5) d^2.5.
    HERTZ_ENERGY = 0.4;
    /// Factor of Hertz's slope, 1.5 d^0.5.
    HERTZ_SLOPE = 1.5;
    /// What is left of d^(n/2) in its mean from 0 to d, 2/(n + 2), for n = 2, 3, ...
    POWER_MEAN_5 = 2.0 / 7.0;
    POWER_MEAN_7 = 2.0 / 9.0;
    POWER_MEAN_8 = 0.2;
    POWER_MEAN_9 = 2.0 / 11.0;
    POWER_MEAN_11 = 2.0 / 13.0;
    /// DMT's tail: (1/3 + (TAIL_1 + TAIL_2 x) x)/(1 + TAIL_POLE x) is 1/3 + x/15 + x^2/35 + ... right in its first two
    /// terms, and to 2.7e-3 from 0 to 1.
    TAIL_1 = 1.0 / 15.0 + TAIL_POLE / 3.0;
    TAIL_2 = -0.033_716;
    TAIL_POLE = -0.799_079;
    /// e = y - 1 at JKR's first touch, D = 0: 4^(1/3) - 1.
    JKR_TOUCH = 0.587_401_051_968_199_4;
    /// sqrt(t) there, t = 3.
    JKR_TOUCH_ROOT = 1.732_050_807_568_877_2;
    /// Start of the search for a point of JKR's curve: sqrt(6), and two numbers fitted so that its relative error is at
    /// most 0.9 %.
    JKR_ROOT_SIX = 2.449_489_7;
    JKR_ROOT_A = 0.716_2;
    JKR_ROOT_B = 1.580_26;
    /// Antiderivative of F dD/de by powers 2 to 10 of e.
    JKR_WORK_0 = -5.0;
    JKR_WORK_1 = -34.0 / 3.0;
    JKR_WORK_2 = -25.0 / 3.0;
    JKR_WORK_3 = 14.0 / 5.0;
    JKR_WORK_4 = 28.0 / 3.0;
    JKR_WORK_5 = 22.0 / 3.0;
    JKR_WORK_6 = 3.0;
    JKR_WORK_7 = 2.0 / 3.0;
    JKR_WORK_8 = 1.0 / 15.0;
    /// F by powers 1 to 6 of e.
    JKR_FORCE_0 = -2.0;
    JKR_FORCE_1 = -0.5;
    JKR_FORCE_2 = 7.0 / 3.0;
    JKR_FORCE_3 = 2.5;
    JKR_FORCE_4 = 1.0;
    JKR_FORCE_5 = 1.0 / 6.0;
    /// Stands for a vanishing difference at the fold itself.
    JKR_TINY = 1e-20;
    /// JKR's slope is infinite at the fold; a step cannot use more than it resolves.
    JKR_STEEPEST = -0.5;
}

/// The same in order, from n = 2 on.
pub(crate) const POWER_MEANS: [f64; 10] = [
    HALF,
    HERTZ_ENERGY,
    THIRD,
    POWER_MEAN_5,
    QUARTER,
    POWER_MEAN_7,
    POWER_MEAN_8,
    POWER_MEAN_9,
    SIXTH,
    POWER_MEAN_11,
];
