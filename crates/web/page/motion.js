// The tip's motion in one period: travel and force over time, force over distance, and a dot that goes along.

/**
 * @typedef {object} Motion
 * @property {number} round
 * @property {number | null} gap
 * @property {ArrayLike<number>} time
 * @property {ArrayLike<number>} travel
 * @property {ArrayLike<number>} force
 * @property {Record<string, number | null>} values
 * @property {number | null} error
 * @property {number} status
 * @property {StatusWord[]} words
 * @property {string} branch
 * @property {string[]} warnings
 * @property {string} source how the state was found
 * @property {number} ms
 * @property {Table} scene
 * @property {number} place number of the instance in the scene
 * @property {boolean} detailed whether the motion has all of its samples
 */

/** @type {Motion | null} */
let motion = null;
/** @type {{travel: Plot, force: Plot, distance: Plot} | null} */
let motionPlots = null;
/** Drawn in the order of time, which a line over a sorted axis cannot be. @type {[number, number][]} */
let loop = [];
/** Period shown, as a share. */
let phaseShown = 0;
let playing = !matchMedia('(prefers-reduced-motion: reduce)').matches;
/** Seconds in which the dot goes through a period. */
const SHOWN_PERIOD = 4;

/** @param {Answer} answer @param {number} round @param {number} ms @param {Table} scene @returns {Motion} */
function motionFrom(answer, round, ms, scene) {
  const waves = answer.waveforms;
  const names = Object.keys(answer.variables);
  const values = Object.fromEntries(names.map((name) => [name, answer.variables[name].data[0]]));
  const gap = state.hold === 'gap' ? valueOf(quantity('g')) : values.gap;
  const flag = answer.flags.branch;
  return {
    round,
    ms,
    scene,
    gap,
    values,
    time: waves?.time[0] ?? [],
    travel: waves?.tip_travel[0] ?? [],
    force: waves?.force[0] ?? [],
    error: values.error_estimate,
    status: answer.status[0],
    words: answer.words,
    branch: flag.meanings[flag.data[0]],
    warnings: answer.warnings,
    source: 'searched',
    place: 0,
    detailed: true,
  };
}

function makeMotionPlots() {
  const make = (
    /** @type {string} */ id,
    /** @type {PlotSeries[]} */ series,
    /** @type {Partial<PlotOptions>} */ more,
  ) => {
    const place = element(id);
    const plot = makePlot(place, series, { cursor: { show: false }, ...more });
    const dot = document.createElement('div');
    dot.className = 'dot';
    plot.over.append(dot);
    return plot;
  };
  const line = { width: 2, points: { show: false } };
  motionPlots = {
    travel: make(
      'm-travel',
      [
        // The tip is drawn over the sample that it sinks into.
        {
          ...line,
          width: 1,
          stroke: () => colour('surface'),
          fill: () => colour('solid'),
          fillTo: (u) => u.scales.y.min ?? 0,
        },
        { ...line, stroke: () => colour('tip') },
      ],
      { scales: { y: { range: travelRange } } },
    ),
    force: make('m-force', [{ ...line, stroke: () => colour('force') }], {}),
    distance: make('m-distance', [{ ...line, width: 0 }], {
      scales: { x: { range: () => loopRange(0) }, y: { range: () => loopRange(1) } },
      hooks: { draw: [drawLoop] },
    }),
  };
  const slider = /** @type {HTMLInputElement} */ (element('m-phase'));
  slider.addEventListener('input', () => {
    setPlaying(false);
    showPhase(Number(slider.value) / 360);
  });
  element('m-play').addEventListener('click', () => setPlaying(!playing));
  matchMedia('(prefers-reduced-motion: reduce)').addEventListener('change', (event) => setPlaying(!event.matches));
  setPlaying(playing);
}

/** @param {Plot} _u @param {number} low @param {number} high @returns {[number, number]} */
const travelRange = (_u, low, high) => [low - 0.12 * (high - low), high + 0.05 * (high - low)];

/**
 * Far from the surface nothing happens, so the picture shows where the force is.
 * @param {0 | 1} axis @returns {[number, number]}
 */
function loopRange(axis) {
  if (!loop.length) return [0, 1];
  const most = Math.max(...loop.map(([, f]) => Math.abs(f)));
  const near = Math.min(...loop.map(([d]) => d));
  const far = Math.max(...loop.map(([d]) => d));
  if (axis === 0) {
    const felt = Math.max(...loop.filter(([, f]) => Math.abs(f) >= 0.02 * most).map(([d]) => d));
    const end = Math.min(far, Math.max(felt, near + 0.08 * (far - near)));
    const edge = 0.08 * (end - near) || 1;
    return [near - edge, end + edge];
  }
  const low = Math.min(...loop.map(([, f]) => f));
  const high = Math.max(...loop.map(([, f]) => f));
  const edge = 0.08 * (high - low) || 1;
  return [low - edge, high + edge];
}

/** @param {Plot} u */
function drawLoop(u) {
  const { ctx } = u;
  ctx.save();
  ctx.beginPath();
  ctx.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
  ctx.clip();
  // Where the tip is in the sample.
  const zero = u.valToPos(0, 'x', true);
  ctx.fillStyle = colour('solid');
  if (zero > u.bbox.left) ctx.fillRect(u.bbox.left, u.bbox.top, zero - u.bbox.left, u.bbox.height);
  const lowest = loop.reduce((least, [d], n) => (d < loop[least][0] ? n : least), 0);
  // The way in is drawn solid, the way out dashed.
  const part = (/** @type {number} */ from, /** @type {number} */ count, /** @type {number[]} */ dash) => {
    ctx.setLineDash(dash.map((one) => one * devicePixelRatio));
    ctx.beginPath();
    for (let n = 0; n <= count; n++) {
      const [d, f] = loop[(from + n + loop.length) % loop.length];
      ctx.lineTo(u.valToPos(d, 'x', true), u.valToPos(f, 'y', true));
    }
    ctx.stroke();
  };
  if (loop.length) {
    const half = Math.floor(loop.length / 2);
    ctx.strokeStyle = colour('force');
    ctx.lineWidth = 2 * devicePixelRatio;
    part(lowest - half, half, []);
    part(lowest, half, [5, 4]);
  }
  ctx.restore();
}

function drawMotion() {
  if (!motionPlots) return;
  const here = motion;
  const has = here !== null && here.gap !== null && here.time.length > 1;
  element('motion').classList.toggle('empty', !has);
  markOld('motion', here !== null && here.round !== rounds.motion);
  element('m-told').textContent = toldMotion();
  if (!has) return;
  const gap = /** @type {number} */ (here.gap);
  const time = Array.from(here.time, (one) => one - here.time[0]);
  const seconds = sharedPrefix(time, 's');
  const travel = lowestInTheMiddle(here.travel, here.travel);
  const length = sharedPrefix([...travel, gap], 'm');
  const force = lowestInTheMiddle(here.force, here.travel);
  const newton = sharedPrefix(force, 'N');
  const far = travel.map((one) => gap + one);
  const apart = sharedPrefix(far, 'm');
  const x = time.map((one) => timesTen(one, seconds.ten));
  loop = far.map((one, n) => [timesTen(one, apart.ten), timesTen(force[n], newton.ten)]);
  const surface = timesTen(-gap, length.ten);
  motionPlots.travel.setData([x, x.map(() => surface), travel.map((one) => timesTen(one, length.ten))]);
  motionPlots.force.setData([x, loop.map(([, f]) => f)]);
  motionPlots.distance.setData([loop.map(([d]) => d).sort((a, b) => a - b), loop.map(([, f]) => f)]);
  element('m-travel-words').textContent = `Tip's travel, ${length.unit}, over time, ${seconds.unit}; grey: the sample`;
  element('m-force-words').textContent = `Force on the tip, ${newton.unit}, over time, ${seconds.unit}`;
  element('m-distance-words').textContent =
    `Force, ${newton.unit}, over distance, ${apart.unit}; dashed: on the way out`;
  showPhase(phaseShown);
}

/**
 * The period, turned so that the tap is not cut in two.
 * @param {ArrayLike<number>} all @param {ArrayLike<number>} travel
 */
function lowestInTheMiddle(all, travel) {
  const count = travel.length;
  const lowest = Array.from(travel).reduce((best, one, n) => (one < travel[best] ? n : best), 0);
  return Array.from(travel, (_, n) => all[(n + lowest - (count >> 1) + count) % count]);
}

/** The same motion with more samples, once there is time for it. @param {Motion} of @param {Answer} answer */
function takeDetail(of, answer) {
  const { time, tip_travel: travel, force } = answer.waveforms;
  if (motion === of) motion = { ...of, time: time[0], travel: travel[0], force: force[0], detailed: true };
}

/** A loss below its error is none that is known. @param {Motion} of */
function toldLoss({ values, error }) {
  const unsure = Math.max(error ?? 0, 1e-12) * (values.drive_work ?? 0);
  if (Math.abs(values.dissipation ?? 0) <= unsure) return `loss none within its error of ${show(unsure, 'J', 2)}`;
  return `loss ${show(values.dissipation, 'J')} per period`;
}

/** What tells the branches apart. @type {Record<string, string>} */
const MEAN_FORCE = { attractive: ' (the mean force pulls)', repulsive: ' (the mean force pushes)' };

function toldMotion() {
  if (!motion) return 'The motion comes with the first numbers.';
  const { values, words, status } = motion;
  const word = words[status];
  if (status === 7 || motion.gap === null) return `No motion to show: ${word?.word ?? ''}: ${word?.reason ?? ''}.`;
  const parts = [
    `Gap ${show(motion.gap, 'm', 4)}, ${motion.source}, ${motion.branch}${MEAN_FORCE[motion.branch] ?? ''}`,
    `amplitude ${show(values.amplitude, 'm', 4)}`,
    `phase lag ${show(values.phase, 'degree', 4)}`,
    `force ${show(values.force_min, 'N')} to ${show(values.force_max, 'N')}`,
    `indentation ${show(values.indentation_max, 'm')}`,
    `in contact ${show((values.contact_time ?? NaN) * 100, '1')} % of the time`,
    toldLoss(motion),
    `estimated error ${showError(motion.error)}`,
  ];
  return `${parts.join('; ')}${status === 0 ? '; ok' : `; ${word?.word}: ${word?.reason}`}.`;
}

/** Puts the dots at a share of the period. @param {number} share */
function showPhase(share) {
  phaseShown = share;
  if (!motionPlots || !loop.length) return;
  const n = Math.min(loop.length - 1, Math.floor(share * loop.length));
  const { travel, force, distance } = motionPlots;
  const place = (/** @type {Plot} */ plot, /** @type {number} */ x, /** @type {number} */ y) => {
    const dot = /** @type {HTMLElement} */ (plot.over.querySelector('.dot'));
    const left = plot.valToPos(x, 'x');
    dot.hidden = !(left >= 0 && left <= plot.over.clientWidth + 1);
    dot.style.transform = `translate(${left}px, ${plot.valToPos(y, 'y')}px)`;
  };
  place(travel, travel.data[0][n], /** @type {number} */ (travel.data[2][n]));
  place(force, force.data[0][n], loop[n][1]);
  place(distance, loop[n][0], loop[n][1]);
  /** @type {HTMLInputElement} */ (element('m-phase')).value = String(Math.round(share * 360));
}

/** @param {boolean} on */
function setPlaying(on) {
  playing = on;
  const button = element('m-play');
  button.textContent = on ? 'Pause' : 'Play';
  if (on) requestAnimationFrame(nextFrame);
}

let lastFrame = 0;
/** @param {number} now */
function nextFrame(now) {
  if (!playing) return;
  const passed = Math.min(100, now - lastFrame);
  lastFrame = now;
  showPhase((phaseShown + passed / 1000 / SHOWN_PERIOD) % 1);
  requestAnimationFrame(nextFrame);
}
