// The results that the page was given: axes, columns, statuses, and which row stands where.

/**
 * A swept quantity. Of a grid `values` are its places; a list has one number a row in place of them. `together` are the
 * quantities that vary together along an axis of names or samples.
 * @typedef {{words: string, short: string, unit: string, path: string, labels: string[], values: number[] | null,
 *   together: {unit: string, path: string, values: number[]}[]}} Axis
 */
/** @typedef {{key: string, words: string, short: string, unit: string, role: 'swept' | 'observable' | 'quality'}} ColumnHead */
/** @typedef {{words: string, meanings: string[], bits: boolean}} FlagHead */
/** @typedef {{rows: number[], samples: number, stored: number, shared: boolean}} WaveHead */
/**
 * @typedef {object} Start
 * @property {string} title
 * @property {string} file
 * @property {number} count of rows
 * @property {boolean} list
 * @property {Axis[]} axes
 * @property {ColumnHead[]} columns each has `count` numbers of four bytes in the pack, the axes of a list among them
 * @property {Record<number, StatusWord>} words of the status codes
 * @property {FlagHead[]} flags each has `count` bytes in the pack, behind the statuses
 * @property {WaveHead | null} waves
 * @property {{title: string, base: Table} | null} live
 */
/** @type {Start} */
const START = JSON.parse(document.getElementById('start')?.textContent ?? '');

/**
 * A quantity of every row.
 * @typedef {object} Column
 * @property {string} key
 * @property {string} words
 * @property {string} short for where there is little room
 * @property {string} unit
 * @property {'swept' | 'observable' | 'quality'} role
 * @property {string[]} labels of the numbers 0, 1 and so on; empty for a quantity
 * @property {(row: number) => number} at
 * @property {[number, number]} ends of the rows that are ok
 * @property {boolean} log
 */
/** @type {Column[]} */
const COLUMNS = [];
/** @type {Uint8Array} */
let statuses = new Uint8Array(0);
/** @type {Uint8Array[]} */
let flagsOf = [];
/** Time, travel, force and indentation of the stored motions, one after the other. @type {Float32Array[]} */
let waveParts = [];

const isGrid = !START.list;
/** How many rows lie between two neighbours along each axis of a grid. */
const STRIDES = START.axes.map((_, n) =>
  START.axes.slice(n + 1).reduce((product, axis) => product * (axis.values?.length ?? 1), 1),
);
const lengthOf = (/** @type {number} */ axis) => START.axes[axis].values?.length ?? 1;
/** Along an axis, which of its places a row has. @param {number} row @param {number} axis */
const placeOf = (row, axis) => Math.floor(row / STRIDES[axis]) % lengthOf(axis);
/** @param {number[]} places one for each axis */
const rowOf = (places) => places.reduce((row, place, axis) => row + place * STRIDES[axis], 0);

/** Whether a row's numbers can be used. @param {number} row */
const isOk = (row) => statuses[row] === 0;

/** @param {Column} column @param {number} value */
function valueWords(column, value, digits = 4) {
  return column.labels.length ? (column.labels[value] ?? '–') : show(value, column.unit, digits);
}

/** @param {Omit<Column, 'ends' | 'log'>} one */
function addColumn(one) {
  let [low, high] = [Infinity, -Infinity];
  for (let row = 0; row < START.count; row++) {
    const value = one.at(row);
    if (!Number.isFinite(value) || (one.role !== 'swept' && !isOk(row))) continue;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  if (low > high) [low, high] = [0, 1];
  // Over more than a decade and a half the logarithm shows more.
  const log = low > 0 && high / low > 30 && one.labels.length === 0;
  COLUMNS.push({ ...one, ends: [low, high], log });
}

/** Where between its ends a value is, 0 to 1. @param {Column} column @param {number} value */
function shareOf(column, value) {
  const [low, high] = column.ends;
  if (high === low) return 0.5;
  return column.log ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
}

/** @param {Column} column @param {number} share */
function valueAtShare(column, share) {
  const [low, high] = column.ends;
  return column.log ? low * (high / low) ** share : low + (high - low) * share;
}

/** @param {string} key */
const columnOf = (key) => COLUMNS.find((one) => one.key === key) ?? COLUMNS[0];
const swept = () => COLUMNS.filter((one) => one.role === 'swept');
const observables = () => COLUMNS.filter((one) => one.role === 'observable');

/** Reads the pack: the columns, the waveforms, the statuses, the flags. */
async function readPack() {
  if (typeof DecompressionStream !== 'function') throw new Error('This browser has no DecompressionStream.');
  const unpacked = new Blob([bytesOf('pack')]).stream().pipeThrough(new DecompressionStream('gzip'));
  const pack = await new Response(unpacked).arrayBuffer();
  let at = 0;
  const numbers = (/** @type {number} */ count) => {
    at += 4 * count;
    return new Float32Array(pack, at - 4 * count, count);
  };
  const bytes = (/** @type {number} */ count) => {
    at += count;
    return new Uint8Array(pack, at - count, count);
  };
  const columns = START.columns.map(() => numbers(START.count));
  const { waves } = START;
  if (waves) {
    const all = waves.rows.length * waves.samples;
    waveParts = [numbers(waves.shared ? waves.samples : all), numbers(all), numbers(all), numbers(all)];
  }
  statuses = bytes(START.count);
  flagsOf = START.flags.map(() => bytes(START.count));
  if (isGrid) {
    START.axes.forEach(({ words, short, unit, labels, values }, n) => {
      const places = values ?? [];
      addColumn({ key: `axis-${n}`, words, short, unit, labels, role: 'swept', at: (row) => places[placeOf(row, n)] });
    });
  }
  START.columns.forEach((head, n) => {
    const labels = head.role === 'swept' ? (START.axes[n]?.labels ?? []) : [];
    addColumn({ ...head, labels, at: (row) => columns[n][row] });
  });
}
