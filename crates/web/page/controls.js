// The left column: sliders with fields for exact values, choices, and presets.

/** Typical values for teaching. Samples differ: measure yours. */
const MATERIALS = [
  { name: 'Polystyrene', modulus: 3e9, poisson: 0.34 },
  { name: 'PMMA', modulus: 3e9, poisson: 0.37 },
  { name: 'Polyethylene, low density', modulus: 200e6, poisson: 0.45 },
  { name: 'PDMS', modulus: 2e6, poisson: 0.49 },
  { name: 'Hydrated gel', modulus: 20e3, poisson: 0.5 },
  { name: 'Graphite, across its layers', modulus: 36e9, poisson: 0.2 },
  { name: 'Mica', modulus: 60e9, poisson: 0.25 },
  { name: 'Silica', modulus: 72e9, poisson: 0.17 },
];
const SURROUNDINGS = [
  { name: 'Air', quality: 400 },
  { name: 'Liquid', quality: 3 },
];

const SLIDER_STEPS = 400;

/** @param {Quantity} one */
function makeRow(one) {
  const row = document.createElement('div');
  row.className = 'row';
  row.id = `row-${one.id}`;
  row.innerHTML = `<label for="q-${one.id}">${one.words}</label>
    <input type="text" id="t-${one.id}" aria-label="${one.words}, exact value with unit"
      autocomplete="off" spellcheck="false">
    <input type="range" id="q-${one.id}" min="0" max="${SLIDER_STEPS}" step="1"><p class="why" id="w-${one.id}"></p>`;
  const [field, slider] = /** @type {HTMLInputElement[]} */ ([...row.querySelectorAll('input')]);
  slider.setAttribute('aria-describedby', `w-${one.id}`);
  slider.addEventListener('input', () => take(one, valueAt(one, Number(slider.value) / SLIDER_STEPS)));
  field.addEventListener('change', () => {
    const value = fieldValue(one, field.value);
    if (value === null || Number.isNaN(value)) {
      element(`w-${one.id}`).textContent =
        `"${field.value}" is no ${lower(one.words)}: give a number and a unit, as ${show(one.start, one.unit)}.`;
      field.setAttribute('aria-invalid', 'true');
      return;
    }
    take(one, value);
  });
  return row;
}

/**
 * A number without a unit counts in the unit that is shown; where only the SI unit makes sense of it, in that.
 * @param {Quantity} one @param {string} text
 */
function fieldValue(one, text) {
  const usual = parseQuantity(text, one.unit, prefixFor(valueOf(one), one.unit).unit || '1');
  const plain = parseQuantity(text, one.unit);
  const fits = (/** @type {number | null} */ value) =>
    value !== null && value >= Math.min(one.from / 10, 10 * one.from) && value <= 10 * one.to;
  return !fits(usual) && fits(plain) ? plain : usual;
}

/** A new value of a slider. @param {Quantity} one @param {number} value */
function take(one, value) {
  setValue(one.id, value);
  if (one.id === 'd') state.resonance = false;
  showControls();
  change();
}

function makeControls() {
  const place = element('sliders');
  const groups = [...new Set(QUANTITIES.map((one) => one.group))];
  for (const group of groups) {
    const set = document.createElement('fieldset');
    set.id = `group-${group.toLowerCase().replace(/ /g, '-')}`;
    set.innerHTML = `<legend>${group}</legend>`;
    if (group === 'Drive' && hasQuantity('d')) {
      set.insertAdjacentHTML(
        'beforeend',
        '<label class="tick"><input type="checkbox" id="resonance"> Drive at the resonance</label>',
      );
    }
    if (group === 'Approach') set.append(element('hold-choice'));
    for (const one of QUANTITIES.filter((each) => each.group === group)) set.append(makeRow(one));
    if (group === 'Sample') place.append(set, element('law-choice'));
    else place.append(set);
  }
  document.getElementById('resonance')?.addEventListener('change', (event) => {
    state.resonance = /** @type {HTMLInputElement} */ (event.target).checked;
    showControls();
    change();
  });
  makeChoice('law', (value) => {
    state.law = value;
    change();
  });
  makeChoice('hold', (value) => {
    state.hold = /** @type {Hold} */ (value);
    change();
  });
  makeChoice('branch', (value) => {
    state.branch = value;
    change();
  });
  makeChoice('way', (value) => {
    state.way = value === '1' ? 1 : 0;
    change();
  });
  makePresets();
}

/** @param {string} id @param {(value: string) => void} taken */
function makeChoice(id, taken) {
  const select = /** @type {HTMLSelectElement} */ (element(id));
  if (id === 'law') {
    if (!(state.law in LAWS)) select.append(new Option(`${state.law}, as the scene has it`, state.law));
    for (const [law, words] of Object.entries(LAWS)) select.append(new Option(words, law));
  }
  select.addEventListener('change', () => {
    taken(select.value);
    showControls();
  });
}

function makePresets() {
  /** @type {[string, {words: string, values: Record<string, number>}[]][]} */
  const all = [
    [
      'lever',
      START.levers.map((one) => ({
        words: one.model,
        values: { k: one.stiffness, f: one.frequency, r: one.radius },
      })),
    ],
    ['material', MATERIALS.map((one) => ({ words: one.name, values: { e: one.modulus, nu: one.poisson } }))],
    ['surroundings', SURROUNDINGS.map((one) => ({ words: one.name, values: { q: one.quality } }))],
  ];
  for (const [id, presets] of all) {
    const select = /** @type {HTMLSelectElement} */ (element(`preset-${id}`));
    select.append(...presets.map((one, n) => new Option(one.words, String(n))));
    const lacking = Object.keys(presets[0]?.values ?? {}).filter((key) => !hasQuantity(key));
    if (!presets.length || lacking.length) {
      select.disabled = true;
      element(`preset-${id}-why`).textContent = 'This scene tells these quantities in another way.';
    }
    select.addEventListener('change', () => {
      const chosen = presets[Number(select.value)];
      if (select.value === '' || !chosen) return;
      for (const [key, value] of Object.entries(chosen.values)) setValue(key, value);
      showControls();
      change();
    });
  }
}

/** Puts every control where the state is, and says why one is of no use now. */
function showControls() {
  const held = HOLDS[state.hold].id;
  for (const one of QUANTITIES) {
    const value = valueOf(one);
    const slider = /** @type {HTMLInputElement} */ (element(`q-${one.id}`));
    const field = /** @type {HTMLInputElement} */ (element(`t-${one.id}`));
    const place = Math.round(placeOf(one, value) * SLIDER_STEPS);
    if (Number(slider.value) !== place && document.activeElement !== slider) slider.value = String(place);
    if (
      document.activeElement === slider &&
      Math.round(placeOf(one, valueAt(one, Number(slider.value) / SLIDER_STEPS)) * SLIDER_STEPS) !== place
    ) {
      slider.value = String(place);
    }
    const told = one.id === 'd' && state.resonance ? 'resonance' : show(value, one.unit, one.id === 'd' ? 6 : 4);
    field.value = told;
    field.removeAttribute('aria-invalid');
    slider.setAttribute('aria-valuetext', told);
    const why = sliderRefused(one);
    element(`w-${one.id}`).textContent = why || sliderNote(one);
    slider.disabled = why !== '' || (one.id === 'd' && state.resonance);
    field.disabled = slider.disabled;
    element(`row-${one.id}`).hidden = ['g', 's', 'F'].includes(one.id) && one.id !== held;
  }
  const box = /** @type {HTMLInputElement | null} */ (document.getElementById('resonance'));
  if (box) box.checked = state.resonance;
  showLaw();
  /** @type {HTMLSelectElement} */ (element('hold')).value = state.hold;
  /** @type {HTMLSelectElement} */ (element('branch')).value = state.branch;
  /** @type {HTMLSelectElement} */ (element('way')).value = String(state.way);
  element('branch-row').hidden = state.hold === 'gap';
  element('way-row').hidden = state.hold !== 'gap';
  showPresets();
  showMapChoices();
}

function showLaw() {
  const select = /** @type {HTMLSelectElement} */ (element('law'));
  /** @type {Map<string, string[]>} */
  const reasons = new Map();
  for (const option of select.options) {
    const why = lawRefused(option.value);
    // The law that is chosen stays; the engine then says what is wrong.
    option.disabled = why !== '' && option.value !== state.law;
    if (why) reasons.set(why, [...(reasons.get(why) ?? []), option.text.split(',')[0]]);
  }
  select.value = state.law;
  element('law-why').textContent = [...reasons].map(([why, laws]) => `Not ${laws.join(', ')}: ${why}`).join(' ');
}

/** A preset is shown while its values are the sliders'. */
function showPresets() {
  const lever = START.levers.findIndex(
    (one) =>
      hasQuantity('k') &&
      hasQuantity('f') &&
      hasQuantity('r') &&
      valueOf(quantity('k')) === one.stiffness &&
      valueOf(quantity('f')) === one.frequency &&
      valueOf(quantity('r')) === one.radius,
  );
  const material = MATERIALS.findIndex(
    (one) => valueOf(quantity('e')) === one.modulus && valueOf(quantity('nu')) === one.poisson,
  );
  const around = SURROUNDINGS.findIndex((one) => valueOf(quantity('q')) === one.quality);
  for (const [id, n] of /** @type {[string, number][]} */ ([
    ['lever', lever],
    ['material', material],
    ['surroundings', around],
  ])) {
    /** @type {HTMLSelectElement} */ (element(`preset-${id}`)).value = n < 0 ? '' : String(n);
  }
}
