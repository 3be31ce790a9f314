// The link: what differs from the scene given, in the address after '#'.

/** @returns {string} */
function stateToHash() {
  const start = startState();
  const parts = Object.entries(state.values).map(([id, value]) => `${id}=${value}`);
  for (const key of /** @type {const} */ (['law', 'hold', 'branch', 'way'])) {
    if (state[key] !== start[key]) parts.push(`${key}=${state[key]}`);
  }
  if (state.resonance !== start.resonance) parts.push(`res=${state.resonance ? 1 : 0}`);
  for (const key of /** @type {const} */ (['x', 'y', 'of'])) {
    if (state.map[key] !== start.map[key]) parts.push(`m${key}=${state.map[key]}`);
  }
  for (const [id, range] of Object.entries(state.map.ranges)) parts.push(`m.${id}=${range.join('~')}`);
  return parts.join('&');
}

/** Words that are not known, as of another scene's link, are passed over and told. @param {string} hash */
function hashToState(hash) {
  Object.assign(state, startState());
  /** @type {string[]} */
  const unknown = [];
  for (const part of hash
    .replace(/^#/, '')
    .split('&')
    .filter((one) => one !== '')) {
    const [key, value = ''] = part.split('=');
    if (!takeWord(key, decoded(value))) unknown.push(part);
  }
  return unknown;
}

/** A text that is no valid encoding stays as it is. @param {string} text */
function decoded(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

/** @param {string} key @param {string} value @returns {boolean} whether it was understood */
function takeWord(key, value) {
  const number = Number(value);
  if (hasQuantity(key)) {
    if (value === '' || Number.isNaN(number)) return false;
    setValue(key, number);
    return true;
  }
  if (key.startsWith('m.')) {
    const ends = value.split('~').map(Number);
    const good = hasQuantity(key.slice(2)) && ends.length === 2 && ends.every(Number.isFinite) && ends[0] !== ends[1];
    if (good) state.map.ranges[key.slice(2)] = [ends[0], ends[1]];
    return good;
  }
  if (key === 'law' && value in LAWS) state.law = value;
  else if (key === 'hold' && value in HOLDS) state.hold = /** @type {Hold} */ (value);
  else if (key === 'branch' && ['any', 'attractive', 'repulsive'].includes(value)) state.branch = value;
  else if (key === 'way' && (value === '0' || value === '1')) state.way = value === '0' ? 0 : 1;
  else if (key === 'res' && hasQuantity('d')) state.resonance = value === '1';
  else if ((key === 'mx' || key === 'my') && hasQuantity(value)) state.map[key === 'mx' ? 'x' : 'y'] = value;
  else if (key === 'mof' && value in MAP_OBSERVABLES) state.map.of = value;
  else return false;
  return true;
}

let lastHash = '';
/** @type {number | undefined} */
let hashTimer;

/** The address follows a moment later: browsers refuse many changes a second. */
function followHash() {
  clearTimeout(hashTimer);
  hashTimer = setTimeout(writeHash, 300);
}

function writeHash() {
  clearTimeout(hashTimer);
  lastHash = stateToHash();
  try {
    history.replaceState(null, '', lastHash === '' ? location.pathname + location.search : `#${lastHash}`);
  } catch {
    location.hash = lastHash;
  }
}
