// The rows of a list as points over two quantities, coloured by a third.

/** Half the width of a point, in CSS pixels. */
const POINT = 1.5;

/** @param {Column} column */
const cloudTick = (column) => (/** @type {number} */ share) =>
  valueWords(column, column.labels.length ? Math.round(valueAtShare(column, share)) : valueAtShare(column, share), 3);

function drawCloud() {
  const here = surface('map');
  const { paint, width, height } = here;
  const [x, y, of] = [columnOf(choice.x), columnOf(choice.y), columnOf(choice.of)];
  const size = START.count > 20_000 ? 1 : 2 * POINT;
  const bad = colour('bad');
  const colours = Array.from({ length: 65 }, (_, n) => `rgb(${viridis(n / 64).join(' ')})`);
  // What is brushed away lies below what is not.
  for (const brushed of [0, 1]) {
    paint.globalAlpha = brushed ? 1 : 0.12;
    for (let row = 0; row < START.count; row++) {
      if (within[row] !== brushed) continue;
      const [across, up] = [shareOf(x, x.at(row)), shareOf(y, y.at(row))];
      if (!(across >= 0 && across <= 1 && up >= 0 && up <= 1)) continue;
      const share = shareOf({ ...of, log: false }, of.at(row));
      const known = isOk(row) && !Number.isNaN(share);
      paint.fillStyle = known ? colours[Math.round(64 * Math.min(1, Math.max(0, share)))] : bad;
      paint.fillRect(across * width - size / 2, (1 - up) * height - size / 2, size, size);
    }
  }
  paint.globalAlpha = 1;
  drawBar(here, of.ends, of.unit);
  drawTicks(here, evenTicks(cloudTick(x)), evenTicks(cloudTick(y)), x.words);
  drawTarget(here, shareOf(x, x.at(choice.row)) * width, (1 - shareOf(y, y.at(choice.row))) * height);
  element('map-words').textContent = `${y.words} over ${lower(x.words)}, coloured by ${lower(of.words)}`;
}

/** The row whose point is nearest. @param {{x: number, y: number}} place as shares */
function rowInCloud(place) {
  const [x, y] = [columnOf(choice.x), columnOf(choice.y)];
  let [best, nearest] = [-1, 0.0025];
  for (let row = 0; row < START.count; row++) {
    if (!within[row]) continue;
    const away = (shareOf(x, x.at(row)) - place.x) ** 2 + (shareOf(y, y.at(row)) - place.y) ** 2;
    if (away < nearest) [best, nearest] = [row, away];
  }
  return best < 0 ? null : best;
}
