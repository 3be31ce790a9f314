// The page: what was chosen is drawn, and what is pointed at is told.

/** @param {number} row */
function choose(row) {
  choice.row = row;
  draw();
}

let drawDue = false;
/** Draws all, once a frame. */
function draw() {
  if (drawDue) return;
  drawDue = true;
  requestAnimationFrame(() => {
    drawDue = false;
    findWithin();
    showChoices();
    if (isGrid) drawSlice();
    else drawCloud();
    if (isGrid) drawLines();
    drawParallel();
    drawWaves(betweenOn ? (betweenAnswer?.wave ?? null) : null);
    tellCase();
    writeLink();
  });
}

/** The numbers of a row in words. @param {number} row */
function rowWords(row) {
  const places = swept().map((one) => `${one.words} ${valueWords(one, one.at(row))}`);
  const of = columnOf(choice.of);
  const word = START.words[statuses[row]];
  const error = COLUMNS.find((one) => one.key === 'error_estimate');
  const told = error ? `, estimated error ${showError(error.at(row))}` : '';
  const status = isOk(row) ? 'ok' : `${word?.word}: ${word?.reason}`;
  return `Row ${row}: ${places.join(', ')}; ${of.words} ${valueWords(of, of.at(row))}${told}; ${status}`;
}

function tellCase() {
  const row = choice.row;
  element('case-told').textContent = rowWords(row);
  const table = element('case-table');
  const live = betweenOn ? (betweenAnswer?.answer ?? null) : null;
  const head = ['Quantity', `row ${row}`, ...(betweenOn ? ['between the rows'] : [])];
  const lines = COLUMNS.filter((one) => one.role !== 'swept').map((one) => {
    const now = live?.variables?.[one.key]?.data[0];
    return [one.words, valueWords(one, one.at(row)), ...(betweenOn ? [now === undefined ? '–' : show(now, one.unit, 4)] : [])];
  });
  const flags = START.flags.map((flag, n) => {
    const code = flagsOf[n][row];
    const words = flag.bits ? flag.meanings.filter((_, k) => (code >> k) & 1).join(', ') : flag.meanings[code];
    return [flag.words, words || 'none', ...(betweenOn ? [''] : [])];
  });
  const cells = (/** @type {string[]} */ all, /** @type {string} */ tag) => {
    const tr = document.createElement('tr');
    tr.append(...all.map((text) => Object.assign(document.createElement(tag), { textContent: text })));
    return tr;
  };
  table.replaceChildren(cells(head, 'th'), ...[...lines, ...flags].map((one) => cells(one, 'td')));
  element('between-told').textContent = betweenWords();
}

/** @param {string} id @param {Column[]} all @param {string} value */
function fillSelect(id, all, value) {
  const select = /** @type {HTMLSelectElement} */ (element(id));
  if (select.options.length !== all.length) select.replaceChildren(...all.map((one) => new Option(one.words, one.key)));
  select.value = value;
}

function showChoices() {
  const axes = isGrid ? swept() : COLUMNS;
  fillSelect('of', COLUMNS.filter((one) => one.role !== 'swept'), choice.of);
  fillSelect('x', axes, choice.x);
  fillSelect('y', axes, choice.y);
  fillSelect('curves', axes, choice.curves);
  if (!isGrid) {
    for (const id of ['row', 'row-number']) /** @type {HTMLInputElement} */ (element(id)).value = String(choice.row);
    return;
  }
  START.axes.forEach((_, n) => {
    const place = placeOf(choice.row, n);
    /** @type {HTMLInputElement} */ (element(`a-${n}`)).value = String(place);
    element(`p-${n}`).textContent = valueWords(COLUMNS[n], START.axes[n].values?.[place] ?? NaN);
  });
}

/** One slider for each axis of a grid; of a list one for the row. */
function makeSliders() {
  const box = element('axes');
  const add = (/** @type {string} */ id, /** @type {string} */ words, /** @type {number} */ most, /** @type {HTMLElement} */ value) => {
    const row = document.createElement('div');
    row.className = 'row';
    const label = Object.assign(document.createElement('label'), { htmlFor: id, textContent: words });
    const slider = Object.assign(document.createElement('input'), { type: 'range', id, min: '0', max: String(most), step: '1' });
    row.append(label, value, slider);
    box.append(row);
    return slider;
  };
  if (isGrid) {
    START.axes.forEach((axis, n) => {
      const value = Object.assign(document.createElement('output'), { id: `p-${n}` });
      const slider = add(`a-${n}`, axis.words, lengthOf(n) - 1, value);
      slider.addEventListener('input', () => choose(rowWith([n, Number(slider.value)])));
    });
    return;
  }
  const field = Object.assign(document.createElement('input'), { type: 'text', id: 'row-number' });
  field.setAttribute('aria-label', 'Row number');
  const slider = add('row', 'Row', START.count - 1, field);
  slider.addEventListener('input', () => choose(Number(slider.value)));
  field.addEventListener('change', () => {
    const row = Number(field.value);
    if (Number.isInteger(row) && row >= 0 && row < START.count) choose(row);
    else showChoices();
  });
}

function makeChoices() {
  for (const id of /** @type {const} */ (['of', 'x', 'y', 'curves'])) {
    element(id).addEventListener('change', (event) => {
      const value = /** @type {HTMLSelectElement} */ (event.target).value;
      // The other axis's quantity chosen: the two change places.
      if (isGrid && id === 'x' && choice.y === value) choice.y = choice.x;
      if (isGrid && id === 'y' && choice.x === value) choice.x = choice.y;
      choice[id] = value;
      draw();
    });
  }
  const canvas = element('map');
  const find = (/** @type {MouseEvent} */ event) => (isGrid ? rowInSlice : rowInCloud)(pointed('map', event));
  canvas.addEventListener('pointermove', (event) => {
    const row = find(event);
    element('map-told').textContent = row === null ? MAP_HINT : rowWords(row);
  });
  canvas.addEventListener('pointerleave', () => {
    element('map-told').textContent = MAP_HINT;
  });
  canvas.addEventListener('click', (event) => {
    const row = find(event);
    if (row !== null) choose(row);
  });
  canvas.addEventListener('keydown', (event) => {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (!step) return;
    event.preventDefault();
    if (!isGrid) return choose(Math.min(START.count - 1, Math.max(0, choice.row + step[0] + step[1])));
    const [x, y] = [axisOf(choice.x), axisOf(choice.y)];
    const moved = (/** @type {number} */ axis, /** @type {number} */ by) =>
      Math.min(lengthOf(axis) - 1, Math.max(0, placeOf(choice.row, axis) + by));
    choose(rowWith([x, moved(x, step[0])], [y, moved(y, step[1])]));
  });
}

const MAP_HINT = 'Point at the picture to read it. A click or the arrow keys choose the row.';

function tellAll() {
  const counts = statusCounts(Array.from(statuses), START.words)
    .map((one) => `${one.count} ${one.word}`)
    .join(', ');
  const column = COLUMNS.find((one) => one.key === 'error_estimate');
  const known = (/** @type {number} */ row) => (column && isOk(row) && Number.isFinite(column.at(row)) ? column.at(row) : null);
  const { median, largest } = errorSpread(Array.from(statuses, (_, row) => known(row)));
  element('all-told').textContent =
    `${START.count} rows: ${counts}; estimated error: median ${showError(median)}, largest ${showError(largest)}`;
}

async function begin() {
  document.title = `${START.title} – explore`;
  element('title').textContent = START.title;
  element('file').textContent = START.file;
  element('map-told').textContent = MAP_HINT;
  await readPack();
  readLink();
  tellAll();
  element('lines').hidden = !isGrid;
  element('curves-choice').hidden = !isGrid;
  makeSliders();
  makeChoices();
  if (isGrid) makeLines();
  makeWaves();
  makeParallel(draw);
  makeBetween(draw);
  onScheme = draw;
  window.addEventListener('resize', draw);
  window.addEventListener('hashchange', () => {
    readLink();
    draw();
  });
  window.afmsweep = { choice, columns: COLUMNS, start: START, isOk, idle: isIdle, between: () => betweenAnswer };
  if (START.live) {
    onDead = (why) => {
      element('between-told').textContent = `The engine does not start: ${why}`;
    };
    await startEngines().catch((error) => onDead(error instanceof Error ? error.message : String(error)));
    betweenAtRow();
  }
  draw();
}

begin().catch((error) => {
  element('failure').hidden = false;
  element('failure').textContent = `This page cannot show its numbers: ${error instanceof Error ? error.message : error}`;
});
