// Parallel axes: every row is a line through its numbers. A brush on an axis keeps the rows that pass through it.

/** Lines that are drawn at most; of more rows, evenly chosen ones. */
const MOST_LINES = 3000;
const PARALLEL_MARGIN = { left: 46, right: 46, top: 48, bottom: 22 };

/** The quantities that have an axis: all swept ones and the first observables. */
function parallelColumns() {
  const most = element('parallel').clientWidth < 500 ? 5 : 10;
  const varied = swept().filter((one) => one.ends[0] < one.ends[1]);
  const shown = observables().filter((one) => one.ends[0] < one.ends[1] && one.key !== choice.of);
  return [...varied, columnOf(choice.of), ...shown].slice(0, Math.max(most, 2));
}

/** @param {Column[]} all @param {number} row @returns {number[] | null} null for a row without a number */
function lineOf(all, row) {
  const shares = all.map((column) => shareOf(column, column.at(row)));
  return isOk(row) && shares.every((share) => share >= 0 && share <= 1) ? shares : null;
}

function drawParallel() {
  const here = surface('parallel', PARALLEL_MARGIN);
  const { paint, width, height } = here;
  const all = parallelColumns();
  const step = width / Math.max(1, all.length - 1);
  const of = columnOf(choice.of);
  const line = (/** @type {number} */ row) => {
    const shares = lineOf(all, row);
    if (!shares) return;
    paint.beginPath();
    shares.forEach((share, n) => paint.lineTo(n * step, (1 - share) * height));
    paint.stroke();
  };
  let drawn = 0;
  paint.lineWidth = 1;
  for (const kept of [0, 1]) {
    const rows = kept ? withinCount : START.count - withinCount;
    const every = Math.max(1, Math.ceil(rows / (kept ? MOST_LINES : MOST_LINES / 4)));
    for (let row = 0, n = 0; row < START.count; row++) {
      if (within[row] !== kept || n++ % every) continue;
      paint.globalAlpha = kept ? 0.35 : 0.1;
      paint.strokeStyle = kept
        ? `rgb(${viridis(shareOf({ ...of, log: false }, of.at(row))).join(' ')})`
        : colour('surface');
      line(row);
      if (kept) drawn += 1;
    }
  }
  paint.globalAlpha = 1;
  paint.lineWidth = 2.5;
  paint.strokeStyle = colour('chosen');
  line(choice.row);
  all.forEach((column, n) => drawParallelAxis(here, column, n, step, all.length));
  tellWithin(drawn);
}

/** @param {Surface} here @param {Column} column @param {number} n @param {number} step @param {number} count */
function drawParallelAxis({ paint, height }, column, n, step, count) {
  const x = n * step;
  paint.strokeStyle = colour('ink');
  paint.lineWidth = 1;
  paint.beginPath();
  paint.moveTo(x, 0);
  paint.lineTo(x, height);
  paint.stroke();
  const brush = choice.brushes[column.key];
  if (brush) {
    paint.fillStyle = colour('accent');
    paint.globalAlpha = 0.35;
    paint.fillRect(x - 7, (1 - brush[1]) * height, 14, Math.max(2, (brush[1] - brush[0]) * height));
    paint.globalAlpha = 1;
  }
  paint.fillStyle = colour('ink');
  paint.textAlign = n === 0 ? 'left' : n === count - 1 ? 'right' : 'center';
  const at = n === 0 ? x - 40 : n === count - 1 ? x + 40 : x;
  // Neighbours' words stand in two rows.
  fitted(paint, column.short, at, n % 2 ? -21 : -35, 2 * step - 10);
  fitted(paint, valueWords(column, column.ends[1], 3), at, -6, step - 6);
  fitted(paint, valueWords(column, column.ends[0], 3), at, height + 14, step - 6);
}

/** @param {CanvasRenderingContext2D} paint @param {string} words @param {number} x @param {number} y @param {number} room */
function fitted(paint, words, x, y, room) {
  let text = words;
  while (text.length > 3 && paint.measureText(text).width > room) text = `${text.slice(0, -2)}…`;
  paint.fillText(text, x, y);
}

/** @param {number} drawn lines */
function tellWithin(drawn) {
  const brushes = Object.keys(choice.brushes).length;
  const rows = brushes
    ? `${withinCount} of ${START.count} rows lie within ${brushes === 1 ? 'the brush' : `all ${brushes} brushes`}`
    : `${START.count} rows`;
  const few = drawn < withinCount ? `; ${drawn} of them are drawn` : '';
  const how = brushes ? 'Click an axis to clear its brush' : 'Drag along an axis to keep the rows that pass there';
  element('parallel-told').textContent = `${rows}${few}. ${how}.`;
  /** @type {HTMLButtonElement} */ (element('unbrush')).disabled = brushes === 0;
}

/** Dragging up or down an axis brushes it. @param {() => void} changed */
function makeParallel(changed) {
  const canvas = element('parallel');
  /** @type {{key: string, from: number} | null} */
  let drag = null;
  const height = (/** @type {MouseEvent} */ event) => Math.min(1, Math.max(0, pointed('parallel', event, PARALLEL_MARGIN).y));
  canvas.addEventListener('pointerdown', (event) => {
    const all = parallelColumns();
    const n = Math.round(pointed('parallel', event, PARALLEL_MARGIN).x * (all.length - 1));
    const column = all[Math.min(all.length - 1, Math.max(0, n))];
    drag = { key: column.key, from: height(event) };
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener('pointermove', (event) => {
    if (!drag) return;
    const to = height(event);
    if (Math.abs(to - drag.from) < 0.01) return;
    choice.brushes[drag.key] = [Math.min(drag.from, to), Math.max(drag.from, to)];
    changed();
  });
  canvas.addEventListener('pointerup', (event) => {
    if (drag && Math.abs(height(event) - drag.from) < 0.01) delete choice.brushes[drag.key];
    drag = null;
    changed();
  });
  element('unbrush').addEventListener('click', () => {
    choice.brushes = {};
    changed();
  });
  makeBrushFields(changed);
}

/** The same by the keyboard: a quantity and its two ends. @param {() => void} changed */
function makeBrushFields(changed) {
  const select = /** @type {HTMLSelectElement} */ (element('brush-of'));
  select.replaceChildren(...COLUMNS.filter((one) => one.labels.length === 0).map((one) => new Option(one.words, one.key)));
  const fields = ['brush-0', 'brush-1'].map((id) => /** @type {HTMLInputElement} */ (element(id)));
  const ends = () => choice.brushes[select.value] ?? [0, 1];
  const fill = () => {
    const column = columnOf(select.value);
    ends().forEach((share, n) => {
      fields[n].value = show(valueAtShare(column, share), column.unit, 4);
    });
  };
  fields.forEach((field, n) =>
    field.addEventListener('change', () => {
      const column = columnOf(select.value);
      const value = parseQuantity(field.value, column.unit, prefixFor(column.ends[1], column.unit).unit || '1');
      const share = value === null ? NaN : shareOf(column, value);
      if (!Number.isNaN(share)) {
        const next = /** @type {[number, number]} */ ([...ends()]);
        next[n] = share;
        choice.brushes[column.key] = [Math.min(...next), Math.max(...next)];
        changed();
      }
      fill();
    }),
  );
  select.addEventListener('change', fill);
  fill();
}
