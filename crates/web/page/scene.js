// The scene: what the page was given, with what the sliders say in its place, and the texts that engines take.

/** @typedef {{preset: string, model: string, stiffness: number, frequency: number, radius: number}} Lever */

/** @type {{title: string, base: Table, levers: Lever[]}} */
const START = JSON.parse(document.getElementById('start')?.textContent ?? '');

const CURVE_OBSERVABLES = [
  'amplitude',
  'phase',
  'force_max',
  'force_min',
  'indentation_max',
  'contact_time',
  'dissipation',
];
/** Samples of the motion at all points of a curve, and at one. */
const FEW_SAMPLES = 128,
  MANY_SAMPLES = 512;

/**
 * The scene without a place of the sample: what the page was given, and the sliders' values that differ from it.
 * @returns {Table}
 */
function commonScene() {
  /** @type {Table} */
  const scene = { title: START.title, ...structuredClone(START.base) };
  for (const one of QUANTITIES) {
    const value = valueOf(one);
    if (!one.holds && value !== one.start)
      put(scene, one.path, one.zero && value === 0 && one.leaves ? undefined : written(value, one.unit));
  }
  put(scene, 'contact.law', state.law);
  // How a viscous contact is told means nothing while the sample loses nothing, and would be refused.
  if (scene.contact.viscosity_model && !losesEnergy()) delete scene.contact.viscosity_model;
  const frequency = driveFrequency();
  if (frequency !== null) put(scene, 'drive.frequency', frequency);
  delete scene.approach;
  // The page shows periodic states, which are searched for and followed.
  scene.run = { ...scene.run, steady: 'search' };
  delete scene.run.start;
  delete scene.run.branches;
  return scene;
}

/** What the page cannot keep of the scene that it was given. */
function leftOut() {
  const run = START.base.run ?? {};
  const found = [];
  if (run.start === 'rest') found.push('run.start = "rest"');
  if (run.steady === 'wait') found.push('run.steady = "wait"');
  if (run.branches === 'both') found.push('run.branches = "both"');
  return found;
}

/** @param {string[]} observables @param {'none' | 'all' | number} [waves] which instances' motion is kept */
function output(observables, waves = 'none') {
  if (waves === 'none') return { observables };
  const all = waves === 'all';
  const samples = all ? FEW_SAMPLES : MANY_SAMPLES;
  return { observables, waveforms: { instances: all ? 'all' : [waves], samples_per_period: samples, periods: 1 } };
}

/** Each gap searched by itself. @param {number[]} gaps @returns {Table} */
function searchedScene(gaps) {
  const values = gaps.map((gap) => written(gap, 'm'));
  return { ...commonScene(), sweep: { 'approach.gap': { values } }, output: output(CURVE_OBSERVABLES) };
}

/**
 * There and back, with the motion at some points.
 * @param {number[]} gaps from far to near @param {'none' | 'all' | number} waves
 */
function followedScene(gaps, waves) {
  const values = gaps.map((gap) => written(gap, 'm'));
  const curve = { quantity: 'approach.gap', values, direction: 'both' };
  return { ...commonScene(), curve, output: output(CURVE_OBSERVABLES, waves) };
}

/** Where the sample stands: the gap, or the set-point. @returns {Table} */
function approachTable() {
  const kept = START.base.approach ?? {};
  const place = HOLDS[state.hold];
  /** @type {Table} */
  const table = { [place.key]: written(valueOf(quantity(place.id)), quantity(place.id).unit) };
  if (state.hold === 'gap') return table;
  if (kept.deepest !== undefined) table.deepest = kept.deepest;
  if (state.hold === 'setpoint' && kept.setpoint_of !== undefined) table.setpoint_of = kept.setpoint_of;
  if (state.branch !== 'any') table.setpoint_branch = state.branch;
  return table;
}

/** One place, with the motion there. @returns {Table} */
function heldScene() {
  const observables = state.hold === 'gap' ? CURVE_OBSERVABLES : [...CURVE_OBSERVABLES, 'gap'];
  return { ...commonScene(), approach: approachTable(), output: output(observables, 0) };
}

/** Far away, where the amplitude is the free one. @returns {Table} */
function probeScene() {
  return { ...commonScene(), approach: { gap: '1 mm' }, output: output(['amplitude']) };
}

/**
 * A part of the map, or all of it.
 * @param {MapAxis} x @param {MapAxis} y @param {number[]} rows @param {string} observable
 * @returns {Table}
 */
function mapScene(x, y, rows, observable) {
  const scene = { ...commonScene(), approach: approachTable() };
  /** @type {Table} */
  const sweep = {};
  const both = /** @type {[MapAxis, number[]][]} */ ([
    [y, rows],
    [x, x.values.map((_, n) => n)],
  ]);
  for (const [axis, places] of both) {
    sweep[axis.path] = { values: places.map((n) => written(axis.values[n], axis.unit)) };
  }
  // An axis takes the place of the quantity, or of the held place, that it varies.
  if (sweep['approach.gap'] || sweep['approach.setpoint'] || sweep['approach.force_setpoint']) {
    const { gap, setpoint, force_setpoint, ...rest } = scene.approach;
    scene.approach = rest;
  }
  return { ...scene, sweep, output: output([observable]) };
}
