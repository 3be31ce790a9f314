// The curve over the gap, approach and retract: its numbers.

/**
 * @typedef {object} Way
 * @property {string} name
 * @property {Record<string, (number | null)[]>} values in SI, over the gaps
 * @property {(number | null)[]} error
 * @property {number[]} status
 * @property {boolean[]} jump whether the state is not continued from the point before
 * @property {string[]} branch
 */
/**
 * @typedef {object} Curve
 * @property {number} round
 * @property {'searched' | 'followed'} kind
 * @property {number[]} gaps rising
 * @property {Way[]} ways
 * @property {StatusWord[]} words
 * @property {string[]} warnings
 * @property {any} waveforms
 * @property {number} ms
 * @property {Table} scene
 */

const CURVE_PLOTS = [
  { name: 'amplitude', words: 'Amplitude', unit: 'm' },
  { name: 'phase', words: 'Phase lag', unit: 'degree' },
  { name: 'force_max', words: 'Largest force', unit: 'N' },
  { name: 'indentation_max', words: 'Largest indentation', unit: 'm' },
];
const WAY_NAMES = ['approach', 'retract'];

/** @type {Curve | null} */
let curve = null;
/** @type {Plot[]} */
const curvePlots = [];
let curveTen = 9;
/** @type {{ten: number, unit: string}[]} */
let curvePrefixes = [];

/** Lags that pass 360 degrees go on below 0, so that the line stays whole. @param {(number | null)[]} all */
function unwrapped(all) {
  /** @type {number | null} */
  let last = null;
  const joined = all.map((one) => {
    if (one === null) return null;
    last = last === null ? one : one - 360 * Math.round((one - last) / 360);
    return last;
  });
  const known = joined.filter((one) => one !== null).sort((a, b) => a - b);
  const turns = known.length ? Math.floor(known[known.length >> 1] / 360) : 0;
  return joined.map((one) => (one === null ? null : one - 360 * turns));
}

/**
 * @param {Answer} answer @param {number} round @param {number} ms @param {Table} scene
 * @returns {Curve}
 */
function curveFrom(answer, round, ms, scene) {
  const gaps = /** @type {number[]} */ (answer.axes[answer.axes.length - 1].values);
  const count = gaps.length;
  const followed = answer.axes.length > 1;
  const order = gaps.map((_, n) => n).sort((a, b) => gaps[a] - gaps[b]);
  const meanings = answer.flags.branch.meanings;
  const ways = (followed ? WAY_NAMES : ['searched']).map((name, way) => {
    const places = order.map((n) => way * count + n);
    /** @type {Record<string, (number | null)[]>} */
    const values = {};
    for (const one of [...CURVE_OBSERVABLES, 'drive_work'])
      values[one] = places.map((n) => answer.variables[one].data[n]);
    values.phase = unwrapped(values.phase);
    return {
      name,
      values,
      error: places.map((n) => answer.variables.error_estimate.data[n]),
      status: places.map((n) => answer.status[n]),
      jump: places.map((n) => answer.flags.jump?.data[n] === 1),
      branch: places.map((n) => meanings[answer.flags.branch.data[n]]),
    };
  });
  return {
    round,
    ms,
    scene,
    ways,
    kind: followed ? 'followed' : 'searched',
    gaps: order.map((n) => gaps[n]),
    words: answer.words,
    warnings: answer.warnings,
    waveforms: answer.waveforms && { of: answer.waveforms, order, count },
  };
}

/**
 * The motion at a point of the followed curve.
 * @param {Curve} from @param {number} way @param {number} n @returns {Motion}
 */
function motionOfCurve(from, way, n) {
  const { of, order, count } = from.waveforms;
  const place = way * count + order[n];
  const one = from.ways[way];
  return {
    round: from.round,
    gap: from.gaps[n],
    time: of.time[of.time.length > 1 ? place : 0],
    travel: of.tip_travel[place],
    force: of.force[place],
    values: Object.fromEntries(Object.keys(one.values).map((name) => [name, one.values[name][n]])),
    error: one.error[n],
    status: one.status[n],
    words: from.words,
    branch: one.branch[n],
    warnings: [],
    source: `on the ${one.name}`,
    ms: from.ms,
    scene: from.scene,
    place,
    detailed: false,
  };
}
