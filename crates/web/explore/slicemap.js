// The map of a grid over two of its axes, at the chosen places along the others, with contours.

/** Contours between the ends, where both axes have so many places. */
const LEVELS = 7;
const LEAST_PLACES = 4;

/**
 * @typedef {{x: number, y: number, first: number, columns: number, rows: number, value: Float64Array,
 *   ends: [number, number] | null}} Slice
 */

/** @returns {Slice} */
function slice() {
  const [x, y] = [axisOf(choice.x), axisOf(choice.y)];
  const [columns, rows] = [lengthOf(x), lengthOf(y)];
  const value = new Float64Array(columns * rows);
  const column = columnOf(choice.of);
  const first = rowWith([x, 0], [y, 0]);
  let [low, high] = [Infinity, -Infinity];
  for (let r = 0; r < rows; r++) {
    for (let c = 0; c < columns; c++) {
      const row = first + c * STRIDES[x] + r * STRIDES[y];
      const one = isOk(row) ? column.at(row) : NaN;
      value[r * columns + c] = one;
      if (one < low) low = one;
      if (one > high) high = one;
    }
  }
  return { x, y, first, columns, rows, value, ends: low <= high ? [low, high] : null };
}

/** Up to five places of an axis, each at the middle of its cells. @param {number} axis @returns {Tick[]} */
function placeTicks(axis) {
  const count = lengthOf(axis);
  const some = Math.min(5, count);
  return Array.from({ length: some }, (_, n) => {
    const place = some === 1 ? 0 : Math.round((n * (count - 1)) / (some - 1));
    const words = valueWords(COLUMNS[axis], START.axes[axis].values?.[place] ?? NaN, 3);
    return { share: (place + 0.5) / count, words };
  });
}

function drawSlice() {
  const here = surface('map');
  const all = slice();
  const { columns, rows, value, ends } = all;
  drawCells(here, columns, rows, (column, row) => {
    const one = value[row * columns + column];
    const place = all.first + column * STRIDES[all.x] + row * STRIDES[all.y];
    const share = ends ? (one - ends[0]) / (ends[1] - ends[0] || 1) : NaN;
    return { share, ok: isOk(place), faded: !within[place] };
  });
  if (ends) {
    if (Math.min(columns, rows) >= LEAST_PLACES) drawContours(here, all, ends);
    drawBar(here, ends, columnOf(choice.of).unit);
  }
  drawTicks(here, placeTicks(all.x), placeTicks(all.y), COLUMNS[all.x].words);
  const [c, r] = [placeOf(choice.row, all.x), placeOf(choice.row, all.y)];
  drawTarget(here, ((c + 0.5) / columns) * here.width, (1 - (r + 0.5) / rows) * here.height);
  element('map-words').textContent = `${columnOf(choice.of).words} over ${lower(COLUMNS[all.x].words)} and ${lower(COLUMNS[all.y].words)}`;
}

/**
 * Where the value crosses a level, between the middles of four neighbouring cells.
 * @param {Surface} here @param {Slice} all @param {[number, number]} ends
 */
function drawContours({ paint, width, height }, { columns, rows, value }, ends) {
  const [wide, high] = [width / columns, height / rows];
  paint.lineWidth = 1;
  paint.strokeStyle = 'rgb(255 255 255 / 75%)';
  paint.beginPath();
  for (let n = 1; n <= LEVELS; n++) {
    const level = ends[0] + ((ends[1] - ends[0]) * n) / (LEVELS + 1);
    for (let r = 0; r + 1 < rows; r++) {
      for (let c = 0; c + 1 < columns; c++) {
        const at = (/** @type {number} */ x, /** @type {number} */ y) => value[(r + y) * columns + c + x] - level;
        const corners = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
        if (corners.some(Number.isNaN)) continue;
        const places = [[0, 0], [1, 0], [1, 1], [0, 1]];
        /** @type {[number, number][]} */
        const crossed = [];
        corners.forEach((one, k) => {
          const next = (k + 1) % 4;
          if (one < 0 === corners[next] < 0) return;
          const share = one / (one - corners[next]);
          const [from, to] = [places[k], places[next]];
          const across = c + 0.5 + from[0] + share * (to[0] - from[0]);
          crossed.push([across * wide, height - (r + 0.5 + from[1] + share * (to[1] - from[1])) * high]);
        });
        for (let k = 0; k + 1 < crossed.length; k += 2) {
          paint.moveTo(...crossed[k]);
          paint.lineTo(...crossed[k + 1]);
        }
      }
    }
  }
  paint.stroke();
}

/** The row of the map's cell there; null outside. @param {{x: number, y: number}} place as shares */
function rowInSlice({ x, y }) {
  if (!(x >= 0 && x < 1 && y >= 0 && y < 1)) return null;
  const [across, up] = [axisOf(choice.x), axisOf(choice.y)];
  return rowWith([across, Math.floor(x * lengthOf(across))], [up, Math.floor(y * lengthOf(up))]);
}
