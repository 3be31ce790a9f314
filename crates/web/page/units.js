// Quantities as the scene file writes them: a decimal number and a unit, each unit a power of ten of SI.

/** @type {Record<string, number>} */
const PREFIXES = {
  y: -24,
  z: -21,
  a: -18,
  f: -15,
  p: -12,
  n: -9,
  u: -6,
  µ: -6,
  μ: -6,
  m: -3,
  c: -2,
  k: 3,
  M: 6,
  G: 9,
  T: 12,
  P: 15,
  E: 18,
};

/**
 * Powers of metre, kilogram, second, ampere and degree, and the power of ten.
 * @type {Record<string, {powers: number[], ten: number}>}
 */
const SYMBOLS = {
  m: { powers: [1, 0, 0, 0, 0], ten: 0 },
  g: { powers: [0, 1, 0, 0, 0], ten: -3 },
  s: { powers: [0, 0, 1, 0, 0], ten: 0 },
  A: { powers: [0, 0, 0, 1, 0], ten: 0 },
  Hz: { powers: [0, 0, -1, 0, 0], ten: 0 },
  N: { powers: [1, 1, -2, 0, 0], ten: 0 },
  Pa: { powers: [-1, 1, -2, 0, 0], ten: 0 },
  bar: { powers: [-1, 1, -2, 0, 0], ten: 5 },
  J: { powers: [2, 1, -2, 0, 0], ten: 0 },
  V: { powers: [2, 1, -3, -1, 0], ten: 0 },
  C: { powers: [0, 0, 1, 1, 0], ten: 0 },
  F: { powers: [-2, -1, 4, 2, 0], ten: 0 },
};

/** These take no prefix. @type {Record<string, {powers: number[], ten: number}>} */
const WHOLE_WORDS = {
  Å: { powers: [1, 0, 0, 0, 0], ten: -10 },
  angstrom: { powers: [1, 0, 0, 0, 0], ten: -10 },
  deg: { powers: [0, 0, 0, 0, 1], ten: 0 },
  degree: { powers: [0, 0, 0, 0, 1], ten: 0 },
  '°': { powers: [0, 0, 0, 0, 1], ten: 0 },
};

/** @param {string} word */
function unitSymbol(word) {
  const plain = WHOLE_WORDS[word] ?? SYMBOLS[word];
  if (plain) return plain;
  const symbol = SYMBOLS[word.slice(1)];
  const prefix = PREFIXES[word[0]];
  return symbol && prefix !== undefined ? { powers: symbol.powers, ten: symbol.ten + prefix } : null;
}

/**
 * A slash divides by the next symbol only, as in the scene file.
 * @param {string} text
 * @returns {{powers: number[], ten: number} | null} null for what is no unit
 */
function parseUnit(text) {
  const powers = [0, 0, 0, 0, 0];
  let ten = 0;
  const plain = text.replace(/²/g, '^2').replace(/³/g, '^3').trim();
  if (plain === '' || plain === '1') return { powers, ten };
  let sign = 1;
  for (const part of plain.split(/(\s*\/\s*|\s*[*·]\s*|\s+)/)) {
    if (part.trim() === '/') sign = -1;
    if (/^\s*[/*·]?\s*$/.test(part)) continue;
    // "J/m2" is meant as "J/m^2".
    const [word, power = '1'] = part.replace(/^([a-zA-Z]+)(\d)$/, '$1^$2').split('^');
    const symbol = unitSymbol(word);
    if (!symbol || !/^-?\d$/.test(power)) return null;
    const times = sign * Number(power);
    symbol.powers.forEach((one, n) => {
      powers[n] += one * times;
    });
    ten += symbol.ten * times;
    sign = 1;
  }
  return { powers, ten };
}

/**
 * A quantity in SI. A number alone counts in the unit `usual`.
 * @param {unknown} given a text or a number
 * @param {string} unit the SI unit that it has to have
 * @param {string} [usual]
 * @returns {number | null} null for what is no such quantity
 */
function parseQuantity(given, unit, usual = unit) {
  if (typeof given === 'number') return given;
  if (typeof given !== 'string') return null;
  // A comma between digits is a decimal point.
  const plain = given.replace(/−/g, '-').replace(/(\d),(\d)/, '$1.$2');
  const found = /^\s*([+-]?(?:\d+\.?\d*|\.\d+|inf))(?:[eE]([+-]?\d+))?\s*(.*?)\s*$/.exec(plain);
  if (!found) return null;
  if (found[1].endsWith('inf')) return found[1][0] === '-' ? -Infinity : Infinity;
  const told = parseUnit(found[3] === '' ? usual : found[3]);
  const wanted = parseUnit(unit);
  if (!told || !wanted || told.powers.some((one, n) => one !== wanted.powers[n])) return null;
  // The digits and the power of ten are read together, so that "30 nm" is the double nearest to 3e-8.
  return Number(`${found[1]}e${Number(found[2] ?? 0) + told.ten - wanted.ten}`);
}

const SHOWN_PREFIXES = ['y', 'z', 'a', 'f', 'p', 'n', 'µ', 'm', '', 'k', 'M', 'G', 'T', 'P', 'E'];

/** Whether the first symbol of the SI unit takes a prefix. @param {string} unit */
function takesPrefix(unit) {
  return unit !== '1' && unit !== '' && !unit.startsWith('degree') && !unit.startsWith('kg');
}

/**
 * The prefix that leaves 1 to 1000 before the unit.
 * @param {number} value
 * @param {string} unit
 * @returns {{ten: number, unit: string}} what to multiply by, as a power of ten, and the unit with its prefix
 */
function prefixFor(value, unit) {
  if (unit === '1' || unit === '') return { ten: 0, unit: '' };
  if (unit === 'degree') return { ten: 0, unit: '°' };
  if (!takesPrefix(unit) || value === 0 || !Number.isFinite(value)) return { ten: 0, unit };
  const rounded = Number(Math.abs(value).toPrecision(4));
  const third = Math.max(-8, Math.min(6, Math.floor(Math.log10(rounded) / 3 + 1e-12)));
  return { ten: -3 * third, unit: SHOWN_PREFIXES[third + 8] + unit };
}

/** @param {number} value @param {number} digits */
function shortNumber(value, digits) {
  if (!Number.isFinite(value)) return value > 0 ? 'inf' : String(value);
  const text = String(Number(value.toPrecision(digits)));
  return text.replace('e+', 'e');
}

/** @param {number} value @param {number} ten */
const timesTen = (value, ten) => {
  const [digits, power = '0'] = String(value).split('e');
  return Number.isFinite(value) ? Number(`${digits}e${Number(power) + ten}`) : value;
};

/**
 * For people: "12.4 nN".
 * @param {number | null | undefined} value in SI
 * @param {string} unit
 */
function show(value, unit, digits = 3) {
  if (value === null || value === undefined || Number.isNaN(value)) return '–';
  const prefix = prefixFor(value, unit);
  const number = shortNumber(timesTen(value, prefix.ten), digits).replace('-', '−');
  if (unit === 'degree') return `${number}°`;
  return prefix.unit === '' ? number : `${number} ${prefix.unit.replace('^2', '²').replace('^3', '³')}`;
}

/**
 * For a scene: every digit, and a bare number where there is no unit.
 * @param {number} value in SI
 * @param {string} unit
 * @returns {string | number}
 */
function written(value, unit) {
  if (unit === '1') return Number.isFinite(value) ? value : 'inf';
  const prefix = prefixFor(value, unit);
  return `${shortNumber(timesTen(value, prefix.ten), 15)} ${prefix.unit.replace('µ', 'u')}`;
}

/** An estimated error: "2.4e-4". @param {number | null | undefined} value */
function showError(value) {
  if (value === null || value === undefined || Number.isNaN(value)) return 'not known';
  return value === 0 ? '0' : value.toExponential(1);
}
