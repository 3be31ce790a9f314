// Pictures on a canvas of their own: colours, cells, ticks, colour bar, and where the pointer is.

/** Viridis, whose lightness rises evenly: it reads without colours, too. */
const VIRIDIS = ['440154', '482878', '3e4989', '31688e', '26828e', '1f9e89', '35b779', '6ece58', 'b5de2b', 'fde725'];

/** @param {number} share @returns {[number, number, number]} */
function viridis(share) {
  const place = Math.min(1, Math.max(0, share)) * (VIRIDIS.length - 1);
  const n = Math.min(VIRIDIS.length - 2, Math.floor(place));
  const parts = (/** @type {string} */ hex) => [0, 2, 4].map((k) => parseInt(hex.slice(k, k + 2), 16));
  const [low, high] = [parts(VIRIDIS[n]), parts(VIRIDIS[n + 1])];
  const mix = low.map((one, k) => Math.round(one + (high[k] - one) * (place - n)));
  return [mix[0], mix[1], mix[2]];
}

/** @typedef {{paint: CanvasRenderingContext2D, width: number, height: number}} Surface */

const MARGIN = { left: 58, right: 74, top: 8, bottom: 34 };
const TICKS = [0, 0.25, 0.5, 0.75, 1];

/** The canvas in CSS pixels, its origin within the margins. @param {string} id @returns {Surface} */
function surface(id, margin = MARGIN) {
  const canvas = /** @type {HTMLCanvasElement} */ (element(id));
  const ratio = devicePixelRatio;
  const all = [Math.max(200, canvas.clientWidth), Math.max(160, canvas.clientHeight)];
  canvas.width = Math.round(all[0] * ratio);
  canvas.height = Math.round(all[1] * ratio);
  const paint = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
  paint.scale(ratio, ratio);
  paint.translate(margin.left, margin.top);
  paint.font = '11px system-ui, sans-serif';
  return {
    paint,
    width: all[0] - margin.left - margin.right,
    height: all[1] - margin.top - margin.bottom,
  };
}

/** Where a pointer is, as shares of the picture, upwards. @param {string} id @param {MouseEvent} event */
function pointed(id, event, margin = MARGIN) {
  const canvas = element(id);
  const box = canvas.getBoundingClientRect();
  const width = Math.max(200, canvas.clientWidth) - margin.left - margin.right;
  const height = Math.max(160, canvas.clientHeight) - margin.top - margin.bottom;
  return {
    x: (event.clientX - box.left - margin.left) / width,
    y: 1 - (event.clientY - box.top - margin.top) / height,
  };
}

/** @typedef {{share: number, words: string}} Tick */

/** Ticks at even shares of a picture. @param {(share: number) => string} words @returns {Tick[]} */
const evenTicks = (words) => TICKS.map((share) => ({ share, words: words(share) }));

/** @param {Surface} here @param {Tick[]} across @param {Tick[]} up @param {string} words below */
function drawTicks({ paint, width, height }, across, up, words) {
  paint.fillStyle = colour('ink');
  // Where there is little room, every second one.
  for (const { share, words: text } of width < 260 ? across.filter((_, n) => n % 2 === 0) : across) {
    paint.textAlign = share === 0 ? 'left' : share === 1 ? 'right' : 'center';
    paint.fillText(text, share * width, height + 13);
  }
  paint.textAlign = 'right';
  for (const { share, words: text } of up) {
    paint.textBaseline = share === 0 ? 'bottom' : share === 1 ? 'top' : 'middle';
    paint.fillText(text, -5, (1 - share) * height);
  }
  paint.textBaseline = 'alphabetic';
  paint.textAlign = 'center';
  paint.fillText(words, width / 2, height + 28);
}

/**
 * A cell of a map: where its value is between the ends, NaN for none that can be used; whether its status is ok; whether it
 * fades.
 * @typedef {{share: number, ok: boolean, faded?: boolean}} Cell
 */

/** @param {Surface} here @param {number} columns @param {number} rows @param {(column: number, row: number) => Cell | null} at */
function drawCells({ paint, width, height }, columns, rows, at) {
  // Whole pixels: cells have no seams.
  const edge = (/** @type {number} */ place) => Math.round(place * devicePixelRatio) / devicePixelRatio;
  for (let row = 0; row < rows; row++) {
    const [top, bottom] = [edge(height - ((row + 1) * height) / rows), edge(height - (row * height) / rows)];
    for (let column = 0; column < columns; column++) {
      const cell = at(column, row);
      if (!cell) continue;
      const [left, right] = [edge((column * width) / columns), edge(((column + 1) * width) / columns)];
      const known = !Number.isNaN(cell.share);
      paint.globalAlpha = known && cell.faded ? 0.2 : 1;
      paint.fillStyle = known ? `rgb(${viridis(cell.share).join(' ')})` : colour('solid');
      paint.fillRect(left, top, right - left, bottom - top);
      paint.globalAlpha = 1;
      if (known) continue;
      // A cell without a number that can be used has a stroke; a measured nothing has a pale one.
      paint.strokeStyle = colour(cell.ok ? 'grid' : 'bad');
      paint.lineWidth = 1;
      paint.beginPath();
      paint.moveTo(left + 1, bottom - 1);
      paint.lineTo(right - 1, top + 1);
      paint.stroke();
    }
  }
}

/** @param {Surface} here @param {[number, number]} ends @param {string} unit */
function drawBar({ paint, width, height }, ends, unit) {
  const left = width + 10;
  for (let n = 0; n < 64; n++) {
    paint.fillStyle = `rgb(${viridis(n / 63).join(' ')})`;
    paint.fillRect(left, height - ((n + 1) * height) / 64, 12, height / 64 + 0.5);
  }
  paint.fillStyle = colour('ink');
  paint.textAlign = 'left';
  const prefix = sharedPrefix(ends, unit);
  for (const share of TICKS) {
    paint.textBaseline = share === 0 ? 'bottom' : share === 1 ? 'top' : 'middle';
    const value = shortNumber(timesTen(ends[0] + (ends[1] - ends[0]) * share, prefix.ten), 3);
    paint.fillText(value, left + 15, (1 - share) * height);
  }
  paint.textBaseline = 'alphabetic';
  paint.fillText(prefix.unit, left, height + 13);
}

/** A cross that marks the chosen place. @param {Surface} here @param {number} x @param {number} y in its pixels */
function drawTarget({ paint }, x, y) {
  for (const [stroke, line] of /** @type {[string, number][]} */ ([
    ['#000', 4],
    ['#fff', 2],
  ])) {
    paint.strokeStyle = stroke;
    paint.lineWidth = line;
    paint.beginPath();
    paint.moveTo(x - 8, y);
    paint.lineTo(x + 8, y);
    paint.moveTo(x, y - 8);
    paint.lineTo(x, y + 8);
    paint.stroke();
  }
}
