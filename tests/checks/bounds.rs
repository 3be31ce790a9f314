//! Every tolerance of the dynamic tests, with its evidence. Errors are on the scales of the
//! accuracy asked for, which is 1e-3 unless a test says otherwise.

/// Confirmed tapping points with 8192 steps a period: amplitude and forces relative, phase in
/// degrees, contact time, loss. Seen: 8e-11 in amplitude, 1.2e-8 degree, 7e-11, 3e-8 (its digits), 1.3e-10.
pub const PUBLISHED_FINE: [f64; 5] = [1e-9, 1e-7, 1e-9, 1e-7, 1e-9];
/// The same with the 128 steps that the plan takes for 1e-3. Seen: 1.3e-7, 5.4e-5, 1.8e-6, 7.7e-6, 1.3e-5.
pub const PUBLISHED_PLAN: [f64; 5] = [1e-6, 2e-4, 1e-5, 3e-5, 5e-5];

/// A mode with less than this share of the tip's static flexibility and of its free motion is left
/// out of the independent integration: an explicit method pays for the fastest mode.
pub const UNSEEN: f64 = 3e-5;

/// Same oscillators, the plan's steps, every observable. Seen: 2e-4 (force on 60 GPa).
pub const STEPS_PLAN: f64 = 5e-4;
/// Amplitude (of the free one) and phase (rad) of one mode at the plan's steps. Seen: 8e-6, 5e-5.
pub const AMPLITUDE: f64 = 1e-5;
pub const PHASE: f64 = 1.7e-4;
/// A pull at the top of the swing, relative to itself. Seen: 3e-6; the free swing's is off by 0.03.
pub const PULL_AT_TOP: f64 = 1e-4;
/// Same oscillators with 2048 steps, every observable. Seen: 9e-7 (contact time).
pub const STEPS_FINE: f64 = 3e-6;
/// All modes of the instrument against those kept, every observable: the accuracy asked for.
/// Seen: 3e-4 (largest force on a moving base).
pub const REDUCTION: f64 = 1e-3;
/// The same, amplitude and phase. Seen: 4e-6, 2.4e-4.
pub const REDUCTION_SWING: f64 = 3e-4;
/// The same from rest. Seen: 1.2e-3 for the loss, whose sum is made for motion that repeats (what it
/// leaves out comes back within a period), and 9e-5 for everything else.
pub const REDUCTION_REST: f64 = 2e-3;
/// Travel from rest, all modes against those kept. Seen: 5.8e-4 (a base that sets off at once).
pub const TRAVEL: f64 = 1e-3;

/// Orders of convergence of the swing, over twelve gaps. Seen: 3.43 (4 but for the onset, which is
/// smooth to 1.5 only), 2.79 and 2.62 (a kink and a jump, from 64 steps to 4,096).
pub const ORDER_HERTZ: f64 = 3.3;
pub const ORDER_DMT: f64 = 2.6;
/// A flat punch, whose force has a corner at touch. Seen: 3.31.
pub const ORDER_PUNCH: f64 = 3.0;
pub const ORDER_JKR: f64 = 2.4;
/// Tips of other shapes with 4,096 steps, every observable. Seen: 8.5e-8 (contact time).
pub const SHAPES_FINE: f64 = 3e-7;
/// The same of a hyperboloid, whose series is right to 2e-6 of the force. Seen: 1.3e-6 (largest force).
pub const HYPERBOLOID_FINE: f64 = 3e-6;

/// Order of the largest force of a table of Hertz's or DMT's law in its rows, and its errors with 161 of them. Seen: 3.2,
/// 7e-7.
pub const ORDER_TABLE: f64 = 2.0;
pub const TABLE_FINE: f64 = 2e-6;

/// JKR's loss per tap at the plan's steps, relative. Seen: 2.5e-4 (4 GPa, 10 nm).
pub const JKR_LOSS: f64 = 5e-4;
/// Tips with a liquid neck, or under JKR with forces beside it, and 2,048 steps, every observable. Seen: 8.8e-7 (contact time).
pub const NECK_FINE: f64 = 2e-6;
/// Loss of a liquid neck at the plan's steps, relative. Seen: 3.8e-4.
pub const NECK_LOSS: f64 = 5e-4;
/// Loss of a table whose way out differs, against the area of the function that it was made of. Seen: 5.9e-4, most of it of the
/// table's cubics.
pub const LOOP_LOSS: f64 = 1e-3;
/// Loss of a law without memory, and drive less modes less sample, in units of the drive's
/// work. Seen: 5e-7, and 2.2e-5 for levers of several modes (the modes beyond those kept).
pub const NO_LOSS: f64 = 5e-6;
pub const BOOKS: f64 = 5e-5;

/// f32 against f64, both at the plan's steps for 1e-3. Seen: 1.0e-5 (largest force).
pub const SINGLE: f64 = 5e-5;

/// The CPU rounding sums of products once against twice, f64, steady instances. Seen: 1.5e-14.
pub const ROUNDING: f64 = 1e-12;

/// The shader against the CPU in the same precision where the driver may fuse and reorder, steady instances,
/// after more than 20,000 steps. Seen on lavapipe: 6.0e-5, and 3.1e-4 after half as many periods, in the
/// largest force on 30 GPa, whose indentation is a small difference of travels (swing and phase 1.5e-7), and
/// 2.0e-13 in f64. Where it may not, the bits are the same.
pub const SHADER_SINGLE: f64 = 4e-4;
pub const SHADER_DOUBLE: f64 = 1e-11;
/// So many times these under a law with memory: where a relaxing contact stops widening, rounding decides in which part of a
/// step each of its two formulas holds, and the least force shows it. Seen: 8.6e-4 and, in f64, 7.2e-11, of one instance.
pub const SHADER_MEMORY: f64 = 10.0;

/// Sixteen steps a period on a medium sample, whatever the accuracy asked for. Seen: 3.8e-3.
pub const SIXTEEN: f64 = 1e-2;
/// A graze of a part in 1e6 of the swing, much shorter than a step: its time is known to a third of
/// one. Seen: 2.2e-3 of the period at 128 steps; everything else within 1e-4.
pub const GRAZE: f64 = 3e-3;
