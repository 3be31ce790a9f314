// The map over two quantities, filled from coarse to fine: its numbers and its cells.

/** @typedef {{id: string, path: string, unit: string, words: string, values: number[], log: boolean}} MapAxis */
/**
 * @typedef {object} Chart
 * @property {number} round
 * @property {MapAxis} x
 * @property {MapAxis} y
 * @property {string} of
 * @property {string} unit
 * @property {(number | null)[]} value by row and column; NaN where it is not computed yet
 * @property {(number | null)[]} error
 * @property {number[]} status -1 where it is not computed yet
 * @property {StatusWord[]} words
 * @property {string[]} warnings
 * @property {number} done rows
 */

const COLUMNS = 32,
  ROWS = 24;
/** Rows that are computed together, from coarse to fine. */
const ROW_PIECES = [
  [0, 8, 16, 23],
  [4, 12, 20],
  [2, 6, 10],
  [14, 18, 22],
  [1, 3, 5],
  [7, 9, 11],
  [13, 15, 17],
  [19, 21],
];

/** What a map can show: words, and the unit. @type {Record<string, {words: string, unit: string}>} */
const MAP_OBSERVABLES = {
  amplitude: { words: 'Amplitude', unit: 'm' },
  phase: { words: 'Phase lag', unit: 'degree' },
  force_max: { words: 'Largest force', unit: 'N' },
  force_min: { words: 'Smallest force', unit: 'N' },
  indentation_max: { words: 'Largest indentation', unit: 'm' },
  contact_time: { words: 'Share of time in contact', unit: '1' },
  dissipation: { words: 'Energy lost per period', unit: 'J' },
  gap: { words: 'Gap', unit: 'm' },
};

/** @type {Chart | null} */
let chart = null;
/** The cell under the pointer or the keys. @type {{column: number, row: number} | null} */
let mapCell = null;

/** Quantities that an axis may be: those with a slider, and of the places held the one that is. */
function mapQuantities() {
  const held = HOLDS[state.hold].id;
  return QUANTITIES.filter(
    (one) =>
      one.path !== '' &&
      one.group !== 'Accuracy' &&
      (!one.holds || one.id === held || one.id === 'd') &&
      Number.isFinite(valueOf(one)),
  );
}

/**
 * The ends of an axis: the user's, or a range about the slider's first place.
 * @param {Quantity} one @returns {[number, number]}
 */
function mapRange(one) {
  if (state.map.ranges[one.id]) return state.map.ranges[one.id];
  if (one.id === 'g') {
    const free = freeAmplitude() ?? 20e-9;
    return [Number((valueOf(quantity('near')) * free).toPrecision(3)), Number((1.05 * free).toPrecision(3))];
  }
  if (one.id === 's' && one.to < 1) return [0.3, 0.95];
  if (!one.log) return rangeOf(one);
  const middle = one.start > 0 ? one.start : valueOf(one) || Math.sqrt(one.from * one.to);
  const round = (/** @type {number} */ value) => Number(value.toPrecision(2));
  return [round(Math.max(one.from, middle / 10)), round(Math.min(one.to, middle * 10))];
}

/** @param {string} id @param {number} count @returns {MapAxis} */
function mapAxis(id, count) {
  const one = quantity(id);
  const [from, to] = mapRange(one);
  const log = one.log && from > 0 && to > 0;
  const values = Array.from({ length: count }, (_, n) => {
    const share = n / (count - 1);
    const value = log ? from * (to / from) ** share : from + (to - from) * share;
    return Number((n === 0 ? from : n === count - 1 ? to : value).toPrecision(6));
  });
  const relative = one.id === 'd' && one.unit === '1';
  return {
    id,
    path: one.path,
    words: one.words,
    log,
    unit: relative ? 'Hz' : one.unit,
    values: relative ? values.map((value) => Number((value * leverFrequency()).toPrecision(9))) : values,
  };
}

/** What was chosen, where it goes with how the place is held. */
function mapChoice() {
  const all = mapQuantities().map((one) => one.id);
  const held = HOLDS[state.hold].id;
  const swap = (/** @type {string} */ id) => (['g', 's', 'F'].includes(id) ? held : all.includes(id) ? id : all[0]);
  const x = swap(state.map.x);
  const y = swap(state.map.y);
  const of = state.map.of === 'gap' && state.hold === 'gap' ? 'phase' : state.map.of;
  return { x, y: y === x ? /** @type {string} */ (all.find((id) => id !== x)) : y, of };
}

/** @param {number} round @returns {Chart} */
function emptyChart(round) {
  const { x, y, of } = mapChoice();
  const size = COLUMNS * ROWS;
  return {
    round,
    of,
    unit: MAP_OBSERVABLES[of].unit,
    x: mapAxis(x, COLUMNS),
    y: mapAxis(y, ROWS),
    words: [],
    warnings: [],
    done: 0,
    value: Array(size).fill(NaN),
    error: Array(size).fill(null),
    status: Array(size).fill(-1),
  };
}

/** @param {Chart} here @param {number[]} rows @param {Answer} answer */
function takeRows(here, rows, answer) {
  rows.forEach((row, k) => {
    for (let column = 0; column < COLUMNS; column++) {
      const [from, to] = [k * COLUMNS + column, row * COLUMNS + column];
      here.value[to] = answer.variables[here.of].data[from];
      here.error[to] = answer.variables.error_estimate.data[from];
      here.status[to] = answer.status[from];
    }
  });
  here.words = answer.words;
  here.done += rows.length;
  here.warnings.push(...answer.warnings);
}

/** The row whose numbers stand for a row, until its own are there. @param {Chart} here @param {number} row */
function rowShown(here, row) {
  for (let away = 0; away < ROWS; away++) {
    for (const one of [row - away, row + away]) {
      if (one >= 0 && one < ROWS && here.status[one * COLUMNS] >= 0) return one;
    }
  }
  return -1;
}

/** @param {Chart} here @returns {[number, number] | null} */
function mapEnds(here) {
  const ok = here.value.filter((one, n) => here.status[n] === 0 && one !== null);
  if (!ok.length) return null;
  return [ok.reduce((a, b) => Math.min(a ?? 0, b ?? 0)) ?? 0, ok.reduce((a, b) => Math.max(a ?? 0, b ?? 0)) ?? 0];
}

function drawMap() {
  if (!chart) return;
  const here = chart;
  const place = surface('map-canvas');
  const ends = mapEnds(here);
  drawCells(place, COLUMNS, ROWS, (column, row) => {
    const shown = rowShown(here, row);
    if (shown < 0) return null;
    const n = shown * COLUMNS + column;
    const [value, ok] = [here.value[n], here.status[n] === 0];
    return { ok, share: ok && value !== null && ends ? (value - ends[0]) / (ends[1] - ends[0] || 1) : NaN };
  });
  drawMapAxes(place, here);
  if (ends) drawBar(place, ends, here.unit);
  drawMapCross(place, here);
  markOld('map', here.round !== rounds.map);
}
