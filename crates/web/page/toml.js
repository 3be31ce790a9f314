// Tables of a scene and their text in TOML.

/** @typedef {{[key: string]: any}} Table */

/** @param {Table} table @param {string} path @returns {any} */
function at(table, path) {
  return path.split('.').reduce((here, key) => here?.[key], table);
}

/** @param {Table} table @param {string} path @param {unknown} value */
function put(table, path, value) {
  const keys = path.split('.');
  const last = /** @type {string} */ (keys.pop());
  const place = keys.reduce((here, key) => (here[key] ??= {}), table);
  if (value === undefined) delete place[last];
  else place[last] = value;
}

/** @param {string} key */
const tomlKey = (key) => (/^[A-Za-z0-9_-]+$/.test(key) ? key : JSON.stringify(key));

/** @param {unknown} value @returns {string} */
function tomlValue(value) {
  if (Array.isArray(value)) return `[${value.map(tomlValue).join(', ')}]`;
  if (value !== null && typeof value === 'object') {
    const parts = Object.entries(value).map(([key, one]) => `${tomlKey(key)} = ${tomlValue(one)}`);
    return `{ ${parts.join(', ')} }`;
  }
  if (typeof value === 'number') return Number.isFinite(value) ? String(value) : 'inf';
  return JSON.stringify(value);
}

/** @param {unknown} value */
const isTable = (value) => value !== null && typeof value === 'object' && !Array.isArray(value);

/** @param {Table} table @param {string[]} [place] @returns {string} */
function toml(table, place = []) {
  const all = Object.entries(table).filter(([, value]) => value !== undefined);
  const lines = all
    .filter(([, value]) => !isTable(value))
    .map(([key, value]) => `${tomlKey(key)} = ${tomlValue(value)}`);
  const head = place.length && lines.length ? [`[${place.map(tomlKey).join('.')}]`] : [];
  const below = all.filter(([, value]) => isTable(value)).map(([key, value]) => toml(value, [...place, key]));
  return [[...head, ...lines].join('\n'), ...below].filter((text) => text !== '').join('\n\n');
}
