// Cases between the rows: the scene of the file with other values, computed by the engine in the page.

/** Values of the swept quantities, by column. @type {Record<string, number>} */
const betweenValues = {};
/** @type {{answer: Answer, wave: Wave | null} | null} */
let betweenAnswer = null;
let betweenOn = false;
/** @type {() => void} */
let betweenChanged = () => {};

/** Whether an axis is a quantity of a scene: the way along a curve and the numbers of samples are none. @param {Axis} axis */
const isOfScene = (axis) => /^(instrument|sample|contact|drive|approach)\./.test(axis.path);

/** Quantities that may be moved: those of the scene that are no words. */
const movable = () =>
  swept().filter((column, n) => column.labels.length === 0 && isOfScene(START.axes[n]) && column.ends[0] < column.ends[1]);

/** The scene of one case. @returns {Table} */
function betweenScene() {
  const scene = structuredClone(START.live?.base ?? {});
  scene.title = START.live?.title;
  START.axes.forEach((axis, n) => {
    const column = swept()[n];
    for (const { path, unit, values } of axis.together) put(scene, path, written(values[placeOf(choice.row, n)], unit));
    if (!isOfScene(axis)) return;
    const label = axis.labels[column.at(choice.row)];
    const value = axis.labels.length ? label : written(betweenValues[column.key] ?? column.at(choice.row), axis.unit);
    put(scene, axis.path, value);
  });
  const known = observables().map((one) => one.key);
  const waveforms = { instances: [0], samples_per_period: 512, periods: 1 };
  const observed = known.filter(isComputed);
  // The indentation follows from the travel and the gap.
  if (parseQuantity(at(scene, 'approach.gap'), 'm') === null && !observed.includes('gap')) observed.push('gap');
  return { ...scene, output: { observables: observed, waveforms } };
}

/** Harmonics and second states have a dash in their keys. @param {string} key */
const isComputed = (key) => !key.includes('-');

function askBetween() {
  dropTasks(['motion']);
  betweenAnswer = null;
  if (!betweenOn) return betweenChanged();
  const scene = betweenScene();
  ask({
    kind: 'motion',
    brief: true,
    scene,
    done: (answer) => {
      const waves = answer.waveforms;
      const gap = parseQuantity(at(scene, 'approach.gap'), 'm') ?? answer.variables?.gap?.data[0] ?? NaN;
      const travel = /** @type {Float64Array | undefined} */ (waves?.tip_travel[0]);
      const wave = travel && { time: waves.time[0], travel, force: waves.force[0], depth: travel.map((one) => -one - gap) };
      betweenAnswer = { answer, wave: wave ?? null };
      betweenChanged();
    },
  });
  betweenChanged();
}

/** Takes over the values of the chosen row. */
function betweenAtRow() {
  for (const column of movable()) betweenValues[column.key] = column.at(choice.row);
  showBetween();
  if (betweenOn) askBetween();
}

function showBetween() {
  for (const column of movable()) {
    const value = betweenValues[column.key] ?? column.at(choice.row);
    const slider = /** @type {HTMLInputElement} */ (element(`s-${column.key}`));
    if (document.activeElement !== slider) slider.value = String(Math.round(1000 * shareOf(column, value)));
    element(`v-${column.key}`).textContent = show(value, column.unit, 4);
  }
}

/** @param {() => void} changed */
function makeBetween(changed) {
  betweenChanged = changed;
  if (!START.live || !movable().length) return;
  element('between').hidden = false;
  const box = element('between-sliders');
  for (const column of movable()) {
    const row = document.createElement('div');
    row.className = 'row';
    const label = document.createElement('label');
    label.htmlFor = `s-${column.key}`;
    label.textContent = column.words;
    const value = document.createElement('output');
    value.id = `v-${column.key}`;
    const slider = document.createElement('input');
    Object.assign(slider, { type: 'range', id: `s-${column.key}`, min: '0', max: '1000', step: '1' });
    slider.addEventListener('input', () => {
      betweenValues[column.key] = Number(valueAtShare(column, Number(slider.value) / 1000).toPrecision(4));
      setBetween(true);
      showBetween();
      askBetween();
    });
    row.append(label, value, slider);
    box.append(row);
  }
  element('between-row').addEventListener('click', betweenAtRow);
  const tick = /** @type {HTMLInputElement} */ (element('between-on'));
  tick.addEventListener('change', () => {
    setBetween(tick.checked);
    askBetween();
  });
}

/** @param {boolean} on */
function setBetween(on) {
  betweenOn = on;
  /** @type {HTMLInputElement} */ (element('between-on')).checked = on;
}

/** What stands below the sliders. */
function betweenWords() {
  if (!betweenOn) return '';
  if (!betweenAnswer) return 'at work';
  const { answer } = betweenAnswer;
  if (answer.error) return answer.error;
  const word = answer.words[answer.status[0]];
  const error = answer.variables.error_estimate?.data[0];
  return `${word.word === 'ok' ? 'ok' : `${word.word}: ${word.reason}`}; estimated error ${showError(error)}`;
}
