// The tip's motion in the row that is looked at, stored in the file or just computed.

/** @typedef {{time: ArrayLike<number>, travel: ArrayLike<number>, force: ArrayLike<number>, depth: ArrayLike<number>}} Wave */
/** @type {{travel: Plot, force: Plot} | null} */
let wavePlots = null;

function makeWaves() {
  const line = (/** @type {string} */ name) => [{ width: 2, stroke: () => colour(name), points: { show: false } }];
  wavePlots = {
    travel: makePlot(element('w-travel'), line('tip'), { cursor: { show: false } }),
    force: makePlot(element('w-force'), line('force'), { cursor: { show: false } }),
  };
  element('next-wave').addEventListener('click', () => {
    const rows = START.waves?.rows ?? [];
    const next = rows.find((row) => row > choice.row) ?? rows[0];
    if (next !== undefined) choose(next);
  });
}

/** @param {number} row @returns {Wave | null} */
function storedWave(row) {
  const { waves } = START;
  const n = waves?.rows.indexOf(row) ?? -1;
  if (!waves || n < 0) return null;
  const own = (/** @type {Float32Array} */ part) => part.subarray(n * waves.samples, (n + 1) * waves.samples);
  const [time, travel, force, depth] = waveParts;
  return { time: waves.shared ? time : own(time), travel: own(travel), force: own(force), depth: own(depth) };
}

/** @param {Wave | null} live the motion of what was computed last, where that is shown */
function drawWaves(live) {
  const wave = live ?? storedWave(choice.row);
  const waves = START.waves;
  element('waves').hidden = !waves && !live;
  element('next-wave').hidden = !waves;
  element('waves').classList.toggle('empty', !wave);
  const few = waves && waves.rows.length < waves.stored ? `, ${waves.rows.length} of them in this page` : '';
  element('w-told').textContent = live
    ? 'The motion of the case between the rows, just computed.'
    : wave
      ? `The motion of row ${choice.row}, as the file has it.`
      : `The file has the motion of ${waves?.stored ?? 0} rows${few}; row ${choice.row} is none of them.`;
  if (!wave || !wavePlots) return;
  const time = Array.from(wave.time, (one) => one - wave.time[0]);
  const seconds = sharedPrefix(time, 's');
  const x = time.map((one) => timesTen(one, seconds.ten));
  for (const [plot, data, unit, id, words] of /** @type {[Plot, ArrayLike<number>, string, string, string][]} */ ([
    [wavePlots.travel, wave.travel, 'm', 'w-travel-words', "Tip's travel"],
    [wavePlots.force, wave.force, 'N', 'w-force-words', 'Force on the tip'],
  ])) {
    const all = Array.from(data);
    const prefix = sharedPrefix(all, unit);
    plot.setData([x, all.map((one) => timesTen(one, prefix.ten))]);
    element(id).textContent = `${words}, ${prefix.unit}, over time, ${seconds.unit}`;
  }
  drawForceLoop(wave);
}

/** @param {ArrayLike<number>} all @returns {[number, number]} */
function spread(all) {
  const known = Array.from(all).filter(Number.isFinite);
  const [low, high] = [Math.min(...known), Math.max(...known)];
  const edge = 0.06 * (high - low) || Math.abs(high) || 1;
  return [low - edge, high + edge];
}

/** Force over the indentation, near and in the sample. @param {Wave} wave */
function drawForceLoop(wave) {
  const here = surface('w-loop', { left: 60, right: 10, top: 8, bottom: 36 });
  const { paint, width, height } = here;
  const [low, high] = spread(wave.force);
  const most = Math.max(Math.abs(low), Math.abs(high));
  // Far from the surface nothing happens.
  const near = Array.from(wave.depth).filter((_, n) => Math.abs(wave.force[n]) > 0.02 * most);
  const [out, deep] = spread(near.length ? near : wave.depth);
  const across = (/** @type {number} */ depth) => ((depth - out) / (deep - out)) * width;
  if (out < 0 && deep > 0) {
    paint.fillStyle = colour('solid');
    paint.fillRect(across(0), 0, width - across(0), height);
  }
  paint.save();
  paint.beginPath();
  paint.rect(0, 0, width, height);
  paint.clip();
  paint.strokeStyle = colour('force');
  paint.lineWidth = 2;
  paint.beginPath();
  for (let n = 0; n < wave.force.length; n++) {
    const up = (1 - (wave.force[n] - low) / (high - low)) * height;
    paint.lineTo(across(wave.depth[n]), up);
  }
  paint.stroke();
  paint.restore();
  drawTicks(
    here,
    evenTicks((share) => show(out + share * (deep - out), 'm')),
    evenTicks((share) => show(low + share * (high - low), 'N')),
    'indentation; grey: in the sample',
  );
}
