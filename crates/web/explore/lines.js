// Curves of the observable along one axis of a grid, one for each of some places of another.

/** Curves at most, beside that of the chosen row. */
const MOST_CURVES = 6;
/** @type {Plot | null} */
let linesPlot = null;

function makeLines() {
  const series = Array.from({ length: MOST_CURVES }, (_, n) => ({
    width: 1.5,
    stroke: () => `rgb(${viridis(0.9 * (n / (MOST_CURVES - 1))).join(' ')})`,
    points: { show: false },
  }));
  const chosen = { width: 3, stroke: () => colour('chosen'), dash: [6, 3], points: { show: false } };
  const label = (/** @type {Plot} */ _, /** @type {number[]} */ shares) =>
    shares.map((share) => {
      const column = columnOf(choice.x);
      const value = valueAtShare(column, share);
      return share < -0.001 || share > 1.001 ? '' : column.labels.length ? (column.labels[value] ?? '') : show(value, column.unit);
    });
  linesPlot = makePlot(element('lines-plot'), [...series, chosen], { scales: { x: { range: () => [-0.02, 1.02] } } });
  linesPlot.axes[0].values = label;
  element('lines-plot').addEventListener('click', () => {
    const share = linesPlot?.posToVal(linesPlot.cursor.left ?? -1, 'x') ?? -1;
    const axis = axisOf(choice.x);
    const column = COLUMNS[axis];
    const away = (/** @type {number} */ place) => Math.abs(shareOf(column, START.axes[axis].values?.[place] ?? NaN) - share);
    const places = Array.from({ length: lengthOf(axis) }, (_, n) => n);
    choose(rowWith([axis, places.reduce((best, one) => (away(one) < away(best) ? one : best), 0)]));
  });
}

/** Evenly spread places of an axis, the first and the last among them. @param {number} axis */
function someOf(axis) {
  const count = lengthOf(axis);
  if (count <= MOST_CURVES) return Array.from({ length: count }, (_, n) => n);
  return Array.from({ length: MOST_CURVES }, (_, n) => Math.round((n * (count - 1)) / (MOST_CURVES - 1)));
}

function drawLines() {
  if (!linesPlot) return;
  const x = axisOf(choice.x);
  const curves = choice.curves === choice.x ? -1 : axisOf(choice.curves);
  const of = columnOf(choice.of);
  // From left to right: an axis may fall.
  const places = Array.from({ length: lengthOf(x) }, (_, n) => n);
  const share = (/** @type {number} */ n) => shareOf(COLUMNS[x], START.axes[x].values?.[n] ?? NaN);
  places.sort((a, b) => share(a) - share(b));
  const prefix = prefixFor(Math.max(Math.abs(of.ends[0]), Math.abs(of.ends[1])), of.unit);
  const curve = (/** @type {[number, number][]} */ moved) =>
    places.map((n) => {
      const row = rowWith(...moved, [x, n]);
      const value = of.at(row);
      return isOk(row) && !Number.isNaN(value) ? timesTen(value, prefix.ten) : null;
    });
  const shown = curves < 0 ? [] : someOf(curves);
  const all = Array.from({ length: MOST_CURVES }, (_, n) =>
    n < shown.length ? curve([[curves, shown[n]]]) : places.map(() => null),
  );
  linesPlot.setData(/** @type {any} */ ([places.map(share), ...all, curve([])]));
  const values = shown.map((n) => valueWords(COLUMNS[curves], START.axes[curves].values?.[n] ?? NaN, 3)).join(', ');
  element('lines-words').textContent =
    `${of.words}${prefix.unit ? `, ${prefix.unit},` : ''} over ${lower(COLUMNS[x].words)}` +
    (shown.length ? `; from dark to light ${lower(COLUMNS[curves].short)} ${values}; dashed: the chosen row's` : '');
}
