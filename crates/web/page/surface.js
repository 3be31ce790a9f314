// Pictures that are painted point by point: their frame, ticks and colour bar.

/** @typedef {{paint: CanvasRenderingContext2D, canvas: HTMLCanvasElement, width: number, height: number}} Surface */

const MARGIN = { left: 64, right: 84, top: 10, bottom: 36 };
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
    canvas,
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
  for (const { share, words: text } of width < 280 ? across.filter((_, n) => n % 2 === 0) : across) {
    paint.textAlign = share === 0 ? 'left' : share === 1 ? 'right' : 'center';
    paint.fillText(text, share * width, height + 14);
  }
  paint.textAlign = 'right';
  for (const { share, words: text } of up) {
    paint.textBaseline = share === 0 ? 'bottom' : share === 1 ? 'top' : 'middle';
    paint.fillText(text, -5, (1 - share) * height);
  }
  paint.textBaseline = 'alphabetic';
  paint.textAlign = 'center';
  paint.fillText(words, width / 2, height + 29);
}

/** @param {Surface} here @param {Column} column @param {[number, number]} ends */
function drawBar({ paint, width, height }, column, ends) {
  const left = width + 10;
  for (let n = 0; n < 64; n++) {
    paint.fillStyle = `rgb(${viridis(n / 63).join(' ')})`;
    paint.fillRect(left, height - ((n + 1) * height) / 64, 12, height / 64 + 0.5);
  }
  paint.fillStyle = colour('ink');
  paint.textAlign = 'left';
  for (const share of TICKS) {
    paint.textBaseline = share === 0 ? 'bottom' : share === 1 ? 'top' : 'middle';
    paint.fillText(show(ends[0] + (ends[1] - ends[0]) * share, column.unit), left + 16, (1 - share) * height);
  }
  paint.textBaseline = 'alphabetic';
}

/** The place of the chosen row. @param {Surface} here @param {number} x @param {number} y in its pixels */
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
