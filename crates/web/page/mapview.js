// The map's axes, colour bar, cross and readout, and the choice of a place by pointer and keys.

/** @param {MapAxis} axis @param {number} value */
function axisShare(axis, value) {
  const from = axis.values[0];
  const to = axis.values[axis.values.length - 1];
  return axis.log ? Math.log(value / from) / Math.log(to / from) : (value - from) / (to - from);
}

/** @param {Surface} place @param {Chart} here */
function drawMapAxes(place, here) {
  const ticks = (/** @type {MapAxis} */ axis) =>
    evenTicks((share) => {
      const [from, to] = [axis.values[0], axis.values[axis.values.length - 1]];
      const value = axis.log ? from * (to / from) ** share : from + (to - from) * share;
      return show(value, axis.unit, axis.id === 'd' ? 4 : 3);
    });
  drawTicks(place, ticks(here.x), ticks(here.y), here.x.words);
  element('map-words').textContent =
    `${MAP_OBSERVABLES[here.of].words} over ${lower(here.x.words)} and ${lower(here.y.words)}; ` +
    `each place is searched by itself, for ${
      state.branch === 'any' || state.hold === 'gap' ? 'the state that is met first' : `a state on the ${state.branch} branch`
    }`;
}

/** A cross where the sliders are, a frame where the pointer is. @param {Surface} place @param {Chart} here */
function drawMapCross(place, here) {
  const { paint, width, height } = place;
  const now = (/** @type {MapAxis} */ axis) => {
    const value = valueOf(quantity(axis.id));
    return axisShare(
      axis,
      axis.id === 'd' && axis.unit === 'Hz' && quantity('d').unit === '1' ? value * leverFrequency() : value,
    );
  };
  // A cell's middle is the place of its value.
  const toX = (/** @type {number} */ share) => ((share * (COLUMNS - 1) + 0.5) / COLUMNS) * width;
  const toY = (/** @type {number} */ share) => height - ((share * (ROWS - 1) + 0.5) / ROWS) * height;
  const [x, y] = [now(here.x), now(here.y)];
  if (x >= -0.02 && x <= 1.02 && y >= -0.03 && y <= 1.03) {
    drawTarget(place, toX(x), toY(y));
  }
  if (mapCell) {
    paint.strokeStyle = '#fff';
    paint.lineWidth = 2;
    const top = height - ((mapCell.row + 1) * height) / ROWS;
    paint.strokeRect((mapCell.column * width) / COLUMNS, top, width / COLUMNS, height / ROWS);
  }
}

function tellMapCell() {
  const place = element('map-told');
  if (!chart) return;
  const { value, error, status, words, unit, x, y } = chart;
  if (!mapCell) {
    const { median, largest } = errorSpread(error.filter((_, n) => status[n] === 0));
    const counts = statusCounts(
      status.filter((one) => one >= 0),
      words,
    )
      .map((one) => `${one.count} ${one.word}`)
      .join(', ');
    place.textContent =
      `${chart.done} of ${ROWS} rows; ${counts || 'nothing yet'}; estimated error: median ${showError(median)}, ` +
      `largest ${showError(largest)}. Point at the map to read it. A click moves the sliders there.`;
    return;
  }
  const n = mapCell.row * COLUMNS + mapCell.column;
  const across = `${x.words} ${show(x.values[mapCell.column], x.unit, 4)}`;
  const where = `${across}, ${lower(y.words)} ${show(y.values[mapCell.row], y.unit, 4)}`;
  const shown = `${lower(MAP_OBSERVABLES[chart.of].words)} ${show(value[n], unit, 4)}`;
  const word = words[status[n]];
  const told =
    status[n] < 0
      ? 'not computed yet'
      : `${shown}, estimated error ${showError(error[n])}, ` +
        (status[n] === 0 ? 'ok' : `${word?.word}: ${word?.reason}`);
  place.textContent = `${where}: ${told}`;
}

/** Moves both sliders to the cell. */
function goToCell() {
  if (!chart || !mapCell) return;
  for (const [axis, n] of /** @type {[MapAxis, number][]} */ ([
    [chart.x, mapCell.column],
    [chart.y, mapCell.row],
  ])) {
    if (axis.id === 'd') state.resonance = false;
    const relative = axis.id === 'd' && quantity('d').unit === '1';
    const value = relative ? axis.values[n] / leverFrequency() : axis.values[n];
    setValue(axis.id, Number(value.toPrecision(relative ? 8 : 4)));
  }
  showControls();
  change();
}

function makeMap() {
  const canvas = /** @type {HTMLCanvasElement} */ (element('map-canvas'));
  const point = (/** @type {PointerEvent | MouseEvent} */ event) => {
    const { x, y } = pointed('map-canvas', event);
    const [column, row] = [Math.floor(x * COLUMNS), Math.floor(y * ROWS)];
    mapCell = column >= 0 && column < COLUMNS && row >= 0 && row < ROWS ? { column, row } : null;
    drawMap();
    tellMapCell();
  };
  canvas.addEventListener('pointermove', point);
  canvas.addEventListener('pointerleave', () => leaveMap());
  canvas.addEventListener('blur', () => leaveMap());
  canvas.addEventListener('click', (event) => {
    point(event);
    goToCell();
  });
  canvas.addEventListener('keydown', (event) => {
    const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    const step = steps[/** @type {keyof typeof steps} */ (event.key)];
    if (step) {
      const from = mapCell ?? { column: COLUMNS >> 1, row: ROWS >> 1 };
      mapCell = {
        column: Math.min(COLUMNS - 1, Math.max(0, from.column + step[0])),
        row: Math.min(ROWS - 1, Math.max(0, from.row + step[1])),
      };
      drawMap();
      tellMapCell();
    } else if (event.key === 'Enter') goToCell();
    else return;
    event.preventDefault();
  });
  new ResizeObserver(() => drawMap()).observe(canvas);
  makeMapChoices();
}

function leaveMap() {
  mapCell = null;
  drawMap();
  tellMapCell();
}

/** What the axes are, from where to where, and what is shown. */
function makeMapChoices() {
  for (const key of /** @type {const} */ (['x', 'y', 'of'])) {
    element(`map-${key}`).addEventListener('change', (event) => {
      const value = /** @type {HTMLSelectElement} */ (event.target).value;
      const other = key === 'x' ? 'y' : key === 'y' ? 'x' : null;
      // Choosing the other axis's quantity swaps the two.
      if (other && mapChoice()[other] === value) state.map[other] = mapChoice()[/** @type {'x' | 'y'} */ (key)];
      state.map[key] = value;
      showMapChoices();
      change();
    });
  }
  for (const key of /** @type {const} */ (['x', 'y'])) {
    for (const end of /** @type {const} */ ([0, 1])) {
      element(`map-${key}${end}`).addEventListener('change', (event) => {
        const one = quantity(mapChoice()[key]);
        const range = mapRange(one);
        const value = parseQuantity(
          /** @type {HTMLInputElement} */ (event.target).value,
          one.unit,
          prefixFor(range[end], one.unit).unit,
        );
        if (value !== null && Number.isFinite(value) && value !== range[1 - end]) {
          state.map.ranges[one.id] = end ? [range[0], value] : [value, range[1]];
        }
        const refused = value === null || !Number.isFinite(value) || value === range[1 - end];
        /** @type {HTMLInputElement} */ (event.target).setAttribute('aria-invalid', String(refused));
        change();
      });
    }
  }
}

function showMapChoices() {
  const chosen = mapChoice();
  const fill = (/** @type {string} */ id, /** @type {[string, string][]} */ all, /** @type {string} */ value) => {
    const select = /** @type {HTMLSelectElement} */ (element(id));
    const same = select.options.length === all.length && all.every(([key], n) => select.options[n].value === key);
    if (!same) select.replaceChildren(...all.map(([key, words]) => new Option(words, key)));
    select.value = value;
  };
  const names = mapQuantities().map((one) => /** @type {[string, string]} */ ([one.id, one.words]));
  fill('map-x', names, chosen.x);
  fill('map-y', names, chosen.y);
  const shown = Object.entries(MAP_OBSERVABLES).filter(([key]) => key !== 'gap' || state.hold !== 'gap');
  fill(
    'map-of',
    shown.map(([key, one]) => [key, one.words]),
    chosen.of,
  );
  for (const key of /** @type {const} */ (['x', 'y'])) {
    const one = quantity(chosen[key]);
    mapRange(one).forEach((value, end) => {
      const field = /** @type {HTMLInputElement} */ (element(`map-${key}${end}`));
      if (document.activeElement !== field) field.value = show(value, one.unit, 6);
    });
  }
}
