// How the curve is drawn: lines, marks, the cursor, and the point that is chosen.

function makeCurvePlots() {
  const place = element('curves');
  CURVE_PLOTS.forEach(({ name, words }) => {
    const figure = document.createElement('figure');
    figure.innerHTML = `<figcaption id="c-${name}-words">${words}</figcaption>
      <div class="plot" data-height="185"></div>`;
    figure.id = `c-${name}`;
    place.append(figure);
    const here = /** @type {HTMLElement} */ (figure.lastElementChild);
    here.setAttribute('role', 'img');
    here.setAttribute('aria-label', `${words} over the gap; the numbers are told below and can be saved`);
    const line = { width: 2, points: { show: false }, gaps: jumpGaps };
    const plot = makePlot(
      here,
      [
        { ...line, label: 'approach', stroke: () => colour('approach') },
        { ...line, label: 'retract', stroke: () => colour('retract'), dash: [6, 4] },
        { ...line, label: 'searched', stroke: () => colour('searched'), width: 1, points: { show: true, size: 5 } },
      ],
      {
        cursor: { sync: { key: 'gap', setSeries: false } },
        hooks: { draw: [(u) => drawCurveMarks(u, name)], setCursor: [(u) => tellCursor(u)] },
      },
    );
    curvePlots.push(plot);
    followPointer(plot);
  });
}

/** The line is broken where the state jumped. @type {any} */
function jumpGaps(
  /** @type {Plot} */ u,
  /** @type {number} */ series,
  /** @type {number} */ _from,
  /** @type {number} */ _to,
  /** @type {[number, number][]} */ gaps,
) {
  const way = curve?.ways[series - 1];
  if (!curve || !way || curve.kind === 'searched') return gaps;
  const more = jumpPairs(way, series - 1).map(
    ([a, b]) =>
      /** @type {[number, number]} */ ([u.valToPos(u.data[0][a], 'x', true), u.valToPos(u.data[0][b], 'x', true)]),
  );
  return [...gaps, ...more].sort((a, b) => a[0] - b[0]);
}

/**
 * Neighbours between which the state jumped, by rising gap.
 * @param {Way} way @param {number} number @returns {[number, number][]}
 */
function jumpPairs(way, number) {
  const found = /** @type {[number, number][]} */ ([]);
  way.jump.forEach((jumped, n) => {
    if (!jumped) return;
    // The approach comes from the larger gap, the retract from the smaller one.
    if (number === 0 && n + 1 < way.jump.length) found.push([n, n + 1]);
    if (number === 1 && n > 0) found.push([n - 1, n]);
  });
  return found;
}

/** Points that are not ok, jumps, and the chosen point. @param {Plot} u @param {string} name */
function drawCurveMarks(u, name) {
  if (!curve) return;
  const here = curve;
  const { ctx } = u;
  const ratio = devicePixelRatio;
  const ten = curvePrefixes[CURVE_PLOTS.findIndex((one) => one.name === name)].ten;
  const toY = (/** @type {number} */ value) => u.valToPos(timesTen(value, ten), 'y', true);
  ctx.save();
  ctx.beginPath();
  ctx.rect(u.bbox.left - 6, u.bbox.top - 6, u.bbox.width + 12, u.bbox.height + 12);
  ctx.clip();
  here.ways.forEach((way, number) => {
    const values = way.values[name];
    ctx.lineWidth = ratio;
    ctx.strokeStyle = colour(way.name);
    ctx.setLineDash([1.5 * ratio, 3 * ratio]);
    for (const [a, b] of jumpPairs(way, number)) {
      if (values[a] === null || values[b] === null) continue;
      ctx.beginPath();
      ctx.moveTo(u.valToPos(u.data[0][a], 'x', true), toY(values[a]));
      ctx.lineTo(u.valToPos(u.data[0][b], 'x', true), toY(values[b]));
      ctx.stroke();
    }
    ctx.setLineDash([]);
    ctx.strokeStyle = colour('bad');
    ctx.lineWidth = 1.5 * ratio;
    way.status.forEach((status, n) => {
      if (status === 0) return;
      const value = values[n];
      const low = u.bbox.top + u.bbox.height - 4 * ratio;
      const y = value === null ? low : Math.min(low, Math.max(u.bbox.top, toY(value)));
      drawCross(u, u.valToPos(u.data[0][n], 'x', true), y, 3.5 * ratio);
    });
  });
  drawChosen(u, name, ten);
  ctx.restore();
}

/** A ring where the motion is shown. @param {Plot} u @param {string} name @param {number} ten */
function drawChosen(u, name, ten) {
  // An older motion has no place on this curve; one of a neighbouring gap has.
  if (motion && motion.round !== rounds.motion && motion.round !== -1) return;
  const value = motion?.values[name];
  if (!motion || motion.gap === null || value === null || value === undefined || Number.isNaN(value)) return;
  const x = u.valToPos(timesTen(motion.gap, curveTen), 'x', true);
  const y = u.valToPos(timesTen(name === 'phase' ? nearTurn(value) : value, ten), 'y', true);
  if (x < u.bbox.left - 1 || x > u.bbox.left + u.bbox.width + 1) return;
  u.ctx.strokeStyle = colour('chosen');
  u.ctx.lineWidth = 2.5 * devicePixelRatio;
  u.ctx.beginPath();
  u.ctx.arc(x, y, 6 * devicePixelRatio, 0, 2 * Math.PI);
  u.ctx.stroke();
}

/** The phase's turn that the curve is drawn in. @param {number} phase */
function nearTurn(phase) {
  const known = curve?.ways[0].values.phase.find((one) => one !== null) ?? phase;
  return phase - 360 * Math.round((phase - known) / 360);
}

/** @param {string} name @param {string} unit */
function okValues(name, unit) {
  const here = /** @type {Curve} */ (curve);
  const ok = here.ways.map((way) => way.values[name].map((value, n) => (way.status[n] === 0 ? value : null)));
  const all = ok.flat();
  const prefix = sharedPrefix(all, unit);
  return { prefix, ok: ok.map((way) => way.map((value) => (value === null ? null : timesTen(value, prefix.ten)))) };
}

function drawCurve() {
  if (!curve) return;
  const here = curve;
  const gap = sharedPrefix(here.gaps, 'm');
  curveTen = gap.ten;
  const x = here.gaps.map((one) => timesTen(one, gap.ten));
  const nothing = x.map(() => null);
  const shown = CURVE_PLOTS.map(({ name, unit }) => okValues(name, unit));
  curvePrefixes = shown.map((one) => one.prefix);
  curvePlots.forEach((plot, n) => {
    const { prefix, ok } = shown[n];
    const data = here.kind === 'followed' ? [x, ok[0], ok[1], nothing] : [x, nothing, nothing, ok[0]];
    plot.setData(/** @type {any} */ (data));
    const unit = prefix.unit === '' ? '' : `, ${prefix.unit}`;
    // A tip that never touches has no indentation.
    const some = ok.flat().some((value) => value !== null);
    element(`c-${CURVE_PLOTS[n].name}-words`).textContent = some
      ? `${CURVE_PLOTS[n].words}${unit}, over the gap, ${gap.unit}`
      : `${CURVE_PLOTS[n].words}: none anywhere on this curve`;
  });
  markOld('curves', here.round !== rounds.curve);
  element('curve-kind').textContent =
    here.kind === 'followed'
      ? `followed there and back, ${here.gaps.length} gaps`
      : `for now ${here.gaps.length} gaps, each searched by itself`;
}

/** The numbers under the cursor. @param {Plot} u */
function tellCursor(u) {
  const n = u.cursor.idx;
  const place = element('cursor-told');
  if (!curve || n === null || n === undefined || (u.cursor.left ?? -1) < 0) {
    place.textContent = 'Point at a curve to read it. Click or drag to see the motion there.';
    return;
  }
  const here = curve;
  const parts = here.ways.map((way) => {
    const told = CURVE_PLOTS.map(
      ({ name, unit, words }) => `${words.toLowerCase()} ${show(way.values[name][n], unit, 4)}`,
    );
    const word = here.words[way.status[n]];
    const status = way.status[n] === 0 ? 'ok' : `${word?.word}: ${word?.reason}`;
    const jumped = way.jump[n] ? ', after a jump' : '';
    return `${way.name} (${way.branch[n]}${jumped}): ${told.join(', ')}, error ${showError(way.error[n])}, ${status}`;
  });
  place.textContent = `Gap ${show(here.gaps[n], 'm', 4)} – ${parts.join('. ')}`;
}

/** A press or a drag on a picture chooses the point whose motion is shown. @param {Plot} plot */
function followPointer(plot) {
  const over = plot.over;
  over.style.touchAction = 'pan-y';
  let pressed = false;
  const choose = (/** @type {PointerEvent} */ event) => {
    if (!curve) return;
    const box = over.getBoundingClientRect();
    const n = plot.posToIdx(event.clientX - box.left);
    const y = event.clientY - box.top;
    const far = (/** @type {number} */ way) => {
      const value = plot.data[way + 1]?.[n];
      return value === null || value === undefined ? Infinity : Math.abs(plot.valToPos(value, 'y') - y);
    };
    choosePoint(
      curve.gaps[n],
      curve.kind === 'followed' && far(1) < far(0) - 3
        ? 1
        : curve.kind === 'followed' && far(0) < far(1) - 3
          ? 0
          : state.way,
    );
  };
  over.addEventListener('pointerdown', (event) => {
    pressed = true;
    over.setPointerCapture(event.pointerId);
    choose(event);
  });
  over.addEventListener('pointermove', (event) => {
    if (pressed) choose(event);
  });
  for (const end of ['pointerup', 'pointercancel'])
    over.addEventListener(end, () => {
      pressed = false;
    });
}
