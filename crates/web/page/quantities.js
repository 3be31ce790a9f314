// Which quantities have a slider: those that mean something for the scene that the page was given.

/**
 * @typedef {object} Quantity
 * @property {string} id short, for links
 * @property {string} group
 * @property {string} path in the scene
 * @property {string} words
 * @property {string} unit SI
 * @property {number} from
 * @property {number} to
 * @property {boolean} log whether the slider is even in the logarithm
 * @property {boolean} zero whether the slider's lowest place is zero
 * @property {boolean} leaves whether the scene leaves the key out at zero
 * @property {boolean} holds whether it says where the sample stands
 * @property {number} start the value of the scene given
 */

const CANTILEVER = 'instrument.cantilever';

/**
 * What the scene given says of a path. It has every value but a loss that is none.
 * @param {string} path @param {string} unit @returns {number | null}
 */
function given(path, unit) {
  return parseQuantity(at(START.base, path) ?? (path === 'sample.loss_tangent' ? 0 : undefined), unit);
}

/** @type {Quantity[]} */
const QUANTITIES = [];

/**
 * @param {string} group @param {string} id @param {string} path @param {string} words @param {string} unit
 * @param {number} from @param {number} to
 * @param {{lin?: boolean, zero?: boolean, leaves?: boolean, holds?: boolean, start?: number}} [how]
 */
function addQuantity(group, id, path, words, unit, from, to, how = {}) {
  const start = how.start ?? given(path, unit);
  if (start === null) return;
  const log = !how.lin;
  // A value of the scene that lies outside the usual range widens it.
  const inside = !Number.isFinite(start) || (start === 0 && how.zero);
  const low = inside ? from : Math.min(from, log ? start / 3 : start);
  const high = inside ? to : Math.max(to, log ? start * 3 : start);
  QUANTITIES.push({
    id,
    group,
    path,
    words,
    unit,
    from: low,
    to: high,
    log,
    start,
    zero: how.zero ?? false,
    leaves: how.leaves ?? false,
    holds: how.holds ?? false,
  });
}

/** @param {string} path */
const has = (path) => at(START.base, path) !== undefined;

const leverModes = /** @type {Table[]} */ (at(START.base, `${CANTILEVER}.modes`) ?? []);
const calibrated = leverModes.length > 0 || has(`${CANTILEVER}.stiffness`);

/** The path of the first mode's natural frequency, where the scene tells it. */
const leverFrequencyPath = !calibrated
  ? null
  : leverModes.length
    ? `${CANTILEVER}.modes.0.frequency`
    : `${CANTILEVER}.frequency`;

function addLever() {
  if (leverModes.length) {
    leverModes.slice(0, 3).forEach((_, n) => {
      const of = leverModes.length > 1 ? ` of mode ${n + 1}` : '';
      const end = n ? String(n + 1) : '';
      addQuantity('Lever', `k${end}`, `${CANTILEVER}.modes.${n}.stiffness`, `Stiffness${of}`, 'N/m', 0.005, 200);
      addQuantity('Lever', `f${end}`, `${CANTILEVER}.modes.${n}.frequency`, `Frequency${of}`, 'Hz', 3e3, 3e6);
      addQuantity('Lever', `q${end}`, `${CANTILEVER}.modes.${n}.quality_factor`, `Quality factor${of}`, '1', 1, 5e3);
    });
    return;
  }
  if (calibrated) {
    addQuantity('Lever', 'k', `${CANTILEVER}.stiffness`, 'Stiffness', 'N/m', 0.005, 200);
    addQuantity('Lever', 'f', `${CANTILEVER}.frequency`, 'Frequency', 'Hz', 3e3, 3e6);
  } else {
    addQuantity('Lever', 'len', `${CANTILEVER}.length`, 'Length', 'm', 20e-6, 500e-6);
    addQuantity('Lever', 'th', `${CANTILEVER}.thickness`, 'Thickness', 'm', 0.3e-6, 20e-6);
  }
  const list = Array.isArray(at(START.base, `${CANTILEVER}.quality_factor`));
  addQuantity('Lever', 'q', `${CANTILEVER}.quality_factor${list ? '.0' : ''}`, 'Quality factor', '1', 1, 5e3);
  if (has('instrument.actuator.quality_factor')) {
    addQuantity('Lever', 'qr', 'instrument.actuator.quality_factor', "Rod's quality factor", '1', 1, 5e3);
  }
}

const tipShape = at(START.base, 'instrument.tip.shape') ?? 'paraboloid';

/** The scene has a radius and a half-angle where they belong to the tip's shape. */
function addTip() {
  const radius = tipShape === 'punch' ? "Face's radius" : 'Tip radius';
  addQuantity('Tip', 'r', 'instrument.tip.radius', radius, 'm', 1e-9, 300e-9);
  addQuantity('Tip', 'ha', 'instrument.tip.half_angle', 'Half-angle', 'degree', 5, 80, { lin: true });
}

const otherForces = has('contact.outside') || has('contact.table');
/** Whether one of them acts only from where it forms to where it breaks. */
const remembers =
  has('contact.table.force_retract') ||
  /** @type {Table[]} */ (at(START.base, 'contact.outside') ?? []).some((one) => one.force === 'capillary');
const relaxing = has('sample.instantaneous_modulus');
/** Whether the sample may lose energy by a loss tangent. */
const takesLoss =
  tipShape === 'paraboloid' &&
  !remembers &&
  !relaxing &&
  !has('sample.thickness') &&
  at(START.base, 'contact.law') !== 'table';

function addSample() {
  addQuantity('Sample', 'e', 'sample.youngs_modulus', 'Modulus', 'Pa', 1e3, 300e9);
  addQuantity('Sample', 'nu', 'sample.poisson_ratio', 'Poisson ratio', '1', 0, 0.5, { lin: true });
  if (has('sample.hamaker')) {
    addQuantity('Sample', 'H', 'sample.hamaker', 'Hamaker constant', 'J', 1e-22, 1e-18, { zero: true });
  } else {
    addQuantity('Sample', 'w', 'sample.surface_energy', 'Work of adhesion', 'J/m^2', 1e-4, 1, { zero: true });
  }
  if (has('sample.thickness')) addQuantity('Sample', 'h', 'sample.thickness', 'Thickness', 'm', 10e-9, 100e-6);
  if (relaxing) {
    addQuantity('Sample', 'e0', 'sample.instantaneous_modulus', 'Modulus at once', 'Pa', 1e3, 300e9);
    addQuantity('Sample', 'T', 'sample.relaxation_time', 'Relaxation time', 's', 1e-8, 1);
  } else if (has('sample.viscosity')) {
    addQuantity('Sample', 'eta', 'sample.viscosity', 'Viscosity', 'Pa s', 1e-3, 1e5, { zero: true, leaves: true });
  } else if (has('sample.retardation_time')) {
    addQuantity('Sample', 'tr', 'sample.retardation_time', 'Retardation time', 's', 1e-10, 1e-3, {
      zero: true,
      leaves: true,
    });
  } else if (takesLoss) {
    addQuantity('Sample', 'lt', 'sample.loss_tangent', 'Loss tangent', '1', 1e-3, 1, { zero: true, leaves: true });
  }
}

/** Quantities of other forces, with their units. @type {Record<string, string>} */
const OUTSIDE = {
  bias: 'V',
  contact_potential: 'V',
  cut_off: 'm',
  tip_charge: 'C/m^2',
  sample_charge: 'C/m^2',
  screening_length: 'm',
  pressure: 'Pa',
  strength: 'N',
  decay_length: 'm',
  period: 'm',
};

function addOtherForces() {
  const all = /** @type {Table[]} */ (at(START.base, 'contact.outside') ?? []);
  all.forEach((force, n) => {
    for (const key of Object.keys(OUTSIDE).filter((one) => force[one] !== undefined)) {
      const path = `contact.outside.${n}.${key}`;
      const value = given(path, OUTSIDE[key]) ?? 0;
      const words = `${force.force}: ${key.replace(/_/g, ' ')}`;
      const signed = /bias|potential|charge|pressure|strength/.test(key);
      const size = Math.abs(value) * 3 || 3;
      if (signed) addQuantity('Other forces', `o${n}${key}`, path, words, OUTSIDE[key], -size, size, { lin: true });
      else addQuantity('Other forces', `o${n}${key}`, path, words, OUTSIDE[key], value / 10, value * 10);
    }
  });
}

/** How strong the drive is, as the scene says it. */
const driveKey =
  ['free_amplitude', 'force', 'base_amplitude', 'voltage'].find((key) => has(`drive.${key}`)) ?? 'voltage';

/** The drive's frequency, where the scene gives one. */
const givenFrequency = at(START.base, 'drive.frequency') === 'resonance' ? null : given('drive.frequency', 'Hz');

function addDrive() {
  const wide =
    given(
      `drive.${driveKey}`,
      { free_amplitude: 'm', force: 'N', base_amplitude: 'm', voltage: 'V' }[driveKey] ?? '1',
    ) ?? 1;
  if (driveKey === 'free_amplitude')
    addQuantity('Drive', 'a', 'drive.free_amplitude', 'Free amplitude', 'm', 1e-9, 300e-9);
  if (driveKey === 'force') addQuantity('Drive', 'df', 'drive.force', 'Force of the drive', 'N', wide / 30, wide * 30);
  if (driveKey === 'base_amplitude')
    addQuantity('Drive', 'db', 'drive.base_amplitude', "Base's amplitude", 'm', wide / 30, wide * 30);
  if (driveKey === 'voltage') addQuantity('Drive', 'dv', 'drive.voltage', 'Voltage', 'V', wide / 30, wide * 30);
  // Relative to the lever's own frequency where that is known, so that it stays detuned when the lever changes.
  const lever = leverFrequencyPath ? given(leverFrequencyPath, 'Hz') : null;
  if (lever) {
    addQuantity('Drive', 'd', 'drive.frequency', "Frequency, of the lever's own", '1', 0.9, 1.1, {
      lin: true,
      holds: true,
      start: givenFrequency === null ? 1 : Number((givenFrequency / lever).toPrecision(12)),
    });
  } else if (givenFrequency !== null) {
    addQuantity('Drive', 'd', 'drive.frequency', 'Frequency', 'Hz', givenFrequency / 1.2, givenFrequency * 1.2);
  }
}

function addApproach() {
  const amplitude = given('drive.free_amplitude', 'm') ?? 20e-9;
  const gap = given('approach.gap', 'm') ?? Number((0.8 * amplitude).toPrecision(3));
  const how = { lin: true, holds: true };
  const phase = at(START.base, 'approach.setpoint_of') === 'phase';
  addQuantity('Approach', 'g', 'approach.gap', 'Gap', 'm', 0, 1.1 * amplitude, { ...how, start: gap });
  addQuantity(
    'Approach',
    's',
    'approach.setpoint',
    phase ? 'Phase held' : 'Set-point, of the free amplitude',
    '1',
    phase ? 1 : 0.05,
    phase ? 359 : 0.99,
    { ...how, start: given('approach.setpoint', '1') ?? (phase ? 60 : 0.8) },
  );
  addQuantity('Approach', 'F', 'approach.force_setpoint', 'Largest force held', 'N', 10e-12, 1e-6, {
    holds: true,
    start: given('approach.force_setpoint', 'N') ?? 5e-9,
  });
  addQuantity('Approach', 'far', '', 'Curve from gap, of the free amplitude', '1', 0.6, 3, { ...how, start: 1.1 });
  addQuantity('Approach', 'near', '', 'Curve to gap, of the free amplitude', '1', -10, 0.9, { ...how, start: 0.2 });
}

addLever();
addTip();
addSample();
addOtherForces();
addDrive();
addApproach();
addQuantity('Accuracy', 'acc', 'run.accuracy', 'Error asked for', '1', 1e-5, 0.1);

/** @param {string} id @returns {Quantity} */
function quantity(id) {
  const found = QUANTITIES.find((one) => one.id === id);
  if (!found) throw new Error(`There is no quantity "${id}" here.`);
  return found;
}

/** @param {string} id */
const hasQuantity = (id) => QUANTITIES.some((one) => one.id === id);
