// What the user has chosen.

/** @typedef {'gap' | 'setpoint' | 'force'} Hold */
/** @typedef {{x: string, y: string, of: string, ranges: Record<string, [number, number]>}} MapChoice */

/** How the sample's place is held: the key of the scene, the slider, and the words. */
const HOLDS = {
  gap: { key: 'gap', id: 'g', words: 'gap' },
  setpoint: { key: 'setpoint', id: 's', words: 'set-point' },
  force: { key: 'force_setpoint', id: 'F', words: 'largest force' },
};

const LAWS = { hertz: 'Hertz', dmt: 'DMT', jkr: 'JKR', auto: "auto, by Tabor's parameter" };

/** Without a place in the scene it is a gap, where the amplitude tells a sensible one. @type {Hold} */
const givenHold = has('approach.force_setpoint')
  ? 'force'
  : has('approach.gap') || (hasQuantity('a') && !has('approach.setpoint'))
    ? 'gap'
    : 'setpoint';

/**
 * @returns {{values: Record<string, number>, law: string, resonance: boolean, hold: Hold, branch: string,
 *   way: 0 | 1, map: MapChoice}}
 */
function startState() {
  return {
    values: {},
    law: at(START.base, 'contact.law') ?? 'auto',
    resonance: givenFrequency === null,
    hold: givenHold,
    branch: at(START.base, 'approach.setpoint_branch') ?? 'any',
    way: 0,
    map: { x: HOLDS[givenHold].id, y: 'e', of: 'phase', ranges: {} },
  };
}

const state = startState();

/** @param {Quantity} one */
const valueOf = (one) => state.values[one.id] ?? one.start;

/** @param {string} id @param {number} value */
function setValue(id, value) {
  if (value === quantity(id).start) delete state.values[id];
  else state.values[id] = value;
}

/** Told by an engine, where the scene does not give it. @type {number | null} */
let probedAmplitude = null;

/** @returns {number | null} */
function freeAmplitude() {
  return hasQuantity('a') ? valueOf(quantity('a')) : probedAmplitude;
}

/** The drive's frequency as the scene has it, or null where the page does not touch it. */
function driveFrequency() {
  if (!hasQuantity('d')) return null;
  if (state.resonance) return 'resonance';
  const one = quantity('d');
  if (one.unit === 'Hz') return null;
  if (state.values.d === undefined && givenFrequency !== null && !('f' in state.values)) return null;
  return written(Number((valueOf(one) * leverFrequency()).toPrecision(9)), 'Hz');
}

/** The natural frequency of the lever's first mode. */
const leverFrequency = () => valueOf(quantity('f'));

const losesEnergy = () => ['lt', 'eta', 'tr'].some((id) => hasQuantity(id) && valueOf(quantity(id)) > 0);

/**
 * Why a law or a loss cannot be chosen now: the program knows no such contact.
 * @param {string} law
 * @returns {string} empty where it can be chosen
 */
function lawRefused(law) {
  if (law === 'hertz') return '';
  const lossy = losesEnergy();
  if (law === 'dmt') {
    return ['paraboloid', 'sphere'].includes(tipShape) ? '' : 'DMT knows the paraboloid and the sphere alone.';
  }
  if (lossy) return 'A viscous contact is not known with JKR. Set the loss to zero first.';
  if (relaxing) return 'A sample that relaxes is known with Hertz and DMT only.';
  if (remembers) return 'A force that remembers is known with Hertz and DMT only.';
  if (otherForces && law === 'auto') return "Tabor's parameter knows the contact's adhesion alone.";
  if (tipShape !== 'paraboloid') return 'JKR knows the paraboloid alone.';
  if (has('sample.thickness')) return 'A layer is known with Hertz and DMT only.';
  if (has('sample.hamaker') && law === 'jkr') return 'A Hamaker constant goes with DMT only.';
  return '';
}

/** @param {Quantity} one @returns {string} why its slider cannot be moved now; empty where it can */
function sliderRefused(one) {
  const loss = ['lt', 'eta', 'tr'].includes(one.id) && valueOf(one) === 0;
  return loss && ['jkr', 'auto'].includes(state.law)
    ? 'A loss goes with Hertz or DMT. Choose one of these laws first.'
    : '';
}

/** @param {Quantity} one @returns {string} what is to know about it now */
function sliderNote(one) {
  if ((one.id === 'w' || one.id === 'H') && state.law === 'hertz' && valueOf(one) !== 0)
    return 'Hertz leaves adhesion out.';
  if (one.path.endsWith('quality_factor') && valueOf(one) === Infinity)
    return 'Undamped: its motion never settles. Give it a quality factor.';
  return '';
}

/** Where on its slider a value is, 0 to 1. @param {Quantity} one @param {number} value */
function placeOf(one, value) {
  const [from, to] = rangeOf(one);
  if (one.zero && value <= 0) return 0;
  const place = one.log ? Math.log(value / from) / Math.log(to / from) : (value - from) / (to - from);
  return Math.min(1, Math.max(one.zero ? 0.01 : 0, place));
}

/** The value at a place, rounded to three or four digits. @param {Quantity} one @param {number} place */
function valueAt(one, place) {
  const [from, to] = rangeOf(one);
  if (one.zero && place < 0.005) return 0;
  if (one.log) return Number((from * (to / from) ** place).toPrecision(3));
  // Even steps of a linear slider have round values.
  const digits = Math.max(0, Math.ceil(Math.log10(1000 / (to - from))));
  const value = from + (to - from) * place;
  return Number(value.toFixed(Math.min(20, digits)));
}

/** The ends of a slider; those of the gap go with the amplitude. @param {Quantity} one @returns {[number, number]} */
function rangeOf(one) {
  if (one.id === 'g') {
    const free = freeAmplitude() ?? 20e-9;
    return [valueOf(quantity('near')) * free, valueOf(quantity('far')) * free];
  }
  if (one.id === 'd' && one.unit === '1' && hasQuantity('q')) {
    // Some four half-widths of the resonance to either side.
    const width = Math.min(0.6, Math.max(0.002, 2 / valueOf(quantity('q'))));
    return [1 - width, 1 + width];
  }
  return [one.from, one.to];
}
