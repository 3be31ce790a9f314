// What is shown: the row that is looked at, the axes of the pictures, the brushes; and the link that holds them.

/**
 * @typedef {object} Choice
 * @property {number} row
 * @property {string} of the observable
 * @property {string} x
 * @property {string} y
 * @property {string} curves the swept quantity whose values are curves in one picture
 * @property {Record<string, [number, number]>} brushes by column, as shares of its ends
 */
/** @type {Choice} */
const choice = { row: 0, of: '', x: '', y: '', curves: '', brushes: {} };

/** Rows within all brushes. @type {Uint8Array} */
let within = new Uint8Array(0);
let withinCount = 0;

/** The first choice: the two longest axes of a grid; of a list its first quantity and the observable. */
function startChoice() {
  const byLength = swept()
    .map((one, n) => ({ key: one.key, length: isGrid ? lengthOf(n) : 0 }))
    .sort((a, b) => b.length - a.length);
  const first = observables()[0]?.key ?? COLUMNS[0].key;
  choice.of = first;
  choice.x = byLength[0]?.key ?? first;
  choice.y = isGrid ? (byLength[1]?.key ?? choice.x) : first;
  choice.curves = choice.y;
  choice.brushes = {};
  choice.row = isGrid ? rowOf(START.axes.map((_, n) => Math.floor((lengthOf(n) - 1) / 2))) : 0;
  if (!isOk(choice.row)) choice.row = Math.max(0, statuses.indexOf(0));
}

/** The number of an axis of a grid. @param {string} key */
const axisOf = (key) => COLUMNS.findIndex((one) => one.key === key);

/** The row beside the chosen one, with these places along some axes. @param {[number, number][]} moved */
function rowWith(...moved) {
  const places = START.axes.map((_, n) => placeOf(choice.row, n));
  for (const [axis, place] of moved) places[axis] = place;
  return rowOf(places);
}

function findWithin() {
  within = new Uint8Array(START.count).fill(1);
  for (const [key, [low, high]] of Object.entries(choice.brushes)) {
    const column = columnOf(key);
    for (let row = 0; row < START.count; row++) {
      const share = shareOf(column, column.at(row));
      // What is no number lies in no brush.
      if (!(share >= low && share <= high)) within[row] = 0;
    }
  }
  withinCount = within.reduce((sum, one) => sum + one, 0);
}

/** The address holds the choice. */
function writeLink() {
  const brushes = Object.entries(choice.brushes).map(([key, ends]) => `b.${key}=${ends.map((one) => one.toFixed(4)).join('~')}`);
  const parts = [`row=${choice.row}`, `of=${choice.of}`, `x=${choice.x}`, `y=${choice.y}`, `curves=${choice.curves}`, ...brushes];
  try {
    history.replaceState(null, '', `#${parts.join('&')}`);
  } catch {
    // Without the address the page is the same.
  }
}

/** Takes what a link says over the first choice. What it says and this page does not know is passed over. */
function readLink() {
  startChoice();
  for (const part of location.hash.replace(/^#/, '').split('&')) {
    const [key, value = ''] = part.split('=');
    const row = Number(value);
    if (key === 'row' && value !== '' && Number.isInteger(row) && row >= 0 && row < START.count) choice.row = row;
    const known = COLUMNS.find((one) => one.key === value);
    if (known && (key === 'of' || key === 'x' || key === 'y' || key === 'curves')) {
      if (key === 'of' || !isGrid || known.role === 'swept') choice[key] = value;
    }
    const ends = value.split('~').map(Number);
    const brushed = key.startsWith('b.') && COLUMNS.some((one) => one.key === key.slice(2));
    if (brushed && ends.length === 2 && ends.every(Number.isFinite)) choice.brushes[key.slice(2)] = [ends[0], ends[1]];
  }
  if (isGrid && choice.x === choice.y) choice.y = swept().find((one) => one.key !== choice.x)?.key ?? choice.y;
}
