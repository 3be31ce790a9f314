// What all plots share: colours, a plot that fits its place, numbers with a prefix, and the mark of old numbers.

/** @param {string} id @returns {HTMLElement} */
function element(id) {
  const found = document.getElementById(id);
  if (!found) throw new Error(`The page lacks "${id}".`);
  return found;
}

/** @param {string} words */
const lower = (words) => words[0].toLowerCase() + words.slice(1);

/** A colour of the style sheet; it changes with light and dark. @param {string} name */
const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

/** The prefix for numbers that share an axis. @param {(number | null)[]} all @param {string} unit */
function sharedPrefix(all, unit) {
  const largest = all.reduce((most, one) => Math.max(most ?? 0, Math.abs(one ?? 0)), 0) ?? 0;
  return prefixFor(largest, unit);
}

/** Called when light and dark change places, for what is no plot. */
let onScheme = () => {};

/** Every plot, to fit and to draw anew. @type {{plot: Plot, place: HTMLElement}[]} */
const allPlots = [];

/** @param {HTMLElement} place */
const plotSize = (place) => ({
  width: Math.max(120, place.clientWidth),
  height: place.clientWidth < 260 ? 130 : Number(place.dataset.height ?? 170),
});

/**
 * @param {HTMLElement} place
 * @param {PlotSeries[]} series
 * @param {Partial<PlotOptions>} more
 * @returns {Plot}
 */
function makePlot(place, series, more) {
  const axis = {
    stroke: () => colour('ink'),
    grid: { stroke: () => colour('grid'), width: 1 },
    ticks: { stroke: () => colour('grid'), width: 1, size: 4 },
    font: '11px system-ui, sans-serif',
    gap: 3,
  };
  const options = /** @type {PlotOptions} */ ({
    ...plotSize(place),
    legend: { show: false },
    padding: [8, 8, 0, 0],
    axes: [
      { ...axis, size: 22 },
      { ...axis, size: 46 },
    ],
    series: [{}, ...series],
    ...more,
    scales: { ...more.scales, x: { time: false, ...more.scales?.x } },
    cursor: { drag: { x: false, y: false }, points: { size: 6 }, ...more.cursor },
  });
  const plot = new uPlot(options, /** @type {any} */ ([[], ...series.map(() => [])]), place);
  allPlots.push({ plot, place });
  new ResizeObserver(() => {
    const size = plotSize(place);
    if (size.width !== plot.width || size.height !== plot.height) plot.setSize(size);
  }).observe(place);
  return plot;
}

matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
  for (const { plot } of allPlots) plot.redraw(false);
  onScheme();
});

/** Dims a picture whose numbers belong to older positions, and says so. @param {string} id @param {boolean} old */
function markOld(id, old) {
  element(id).classList.toggle('old', old);
}

/** @param {Plot} plot @param {number} x @param {number} y in canvas pixels @param {number} size */
function drawCross(plot, x, y, size) {
  const { ctx } = plot;
  ctx.beginPath();
  ctx.moveTo(x - size, y - size);
  ctx.lineTo(x + size, y + size);
  ctx.moveTo(x - size, y + size);
  ctx.lineTo(x + size, y - size);
  ctx.stroke();
}

/** Middle and largest of estimated errors. @param {(number | null)[]} all */
function errorSpread(all) {
  const known = all.filter((one) => one !== null).sort((a, b) => a - b);
  if (!known.length) return { median: null, largest: null };
  return { median: known[Math.floor((known.length - 1) / 2)], largest: known[known.length - 1] };
}

/** @typedef {{word: string, reason: string}} StatusWord */

/** How many of each status: "97 ok, 1 not_steady". @param {number[]} status @param {Record<number, StatusWord>} words */
function statusCounts(status, words) {
  /** @type {Map<number, number>} */
  const counts = new Map();
  for (const one of status) counts.set(one, (counts.get(one) ?? 0) + 1);
  return [...counts]
    .sort((a, b) => a[0] - b[0])
    .map(([code, count]) => ({
      count,
      code,
      word: words[code]?.word ?? `status ${code}`,
      reason: words[code]?.reason ?? '',
    }));
}
