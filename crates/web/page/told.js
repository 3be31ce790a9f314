// The lines that stay in sight: errors, statuses, warnings, times, and what the engine says against a scene.

let deadTold = '';

/** @returns {number} */
const askedError = () => valueOf(quantity('acc'));

/**
 * @param {string} id @param {string} words @param {{old: boolean, status: number[], words: StatusWord[],
 *   error: (number | null)[], ms: number | null} | null} all
 */
function tellPart(id, words, all) {
  const place = element(id);
  const busy = { curve: ['probe', 'coarse', 'curve', 'fine'], motion: ['motion'], map: ['map'] }[words] ?? [];
  place.classList.toggle('old', all === null || all.old);
  const failed = failures[words] !== '' ? 'none for these; the reason stands at the controls' : '';
  if (!all) {
    place.textContent = `${words}: ${failed || (isBusyWith(busy) ? `at work${workedFor(words)}` : 'waiting')}`;
    return;
  }
  const { median, largest } = errorSpread(all.error.filter((_, n) => all.status[n] === 0));
  const counts = statusCounts(all.status, all.words)
    .map((one) => `${one.count} ${one.word}`)
    .join(', ');
  const error =
    all.error.length > 1
      ? `error median ${showError(median)}, largest ${showError(largest)}`
      : `error ${showError(all.error[0])}`;
  const old = all.old ? ` — of older positions; ${failed || `at work${workedFor(words)}`}` : '';
  place.textContent = `${words}: ${counts}; ${error}${all.ms === null ? '' : `; ${Math.round(all.ms)} ms`}${old}`;
}

/** After a second it is told how long a picture takes. @param {string} part */
function workedFor(part) {
  const passed = Math.floor((performance.now() - changedAt[part]) / 1000);
  return passed > 0 ? `, ${passed} s` : '';
}

setInterval(() => {
  if (!isQuiet()) tell();
}, 1000);

function tell() {
  const good = curve?.ways ?? [];
  tellPart(
    'told-curve',
    'curve',
    curve && {
      old: curve.round !== rounds.curve,
      status: good.flatMap((way) => way.status),
      words: curve.words,
      error: good.flatMap((way) => way.error),
      ms: times.curve ?? times.first,
    },
  );
  tellPart(
    'told-motion',
    'motion',
    motion && {
      old: motion.round !== rounds.motion,
      status: [motion.status],
      words: motion.words,
      error: [motion.error],
      ms: times.motion,
    },
  );
  const done = chart ? chart.status.filter((one) => one >= 0) : [];
  tellPart(
    'told-map',
    'map',
    chart && {
      old: chart.round !== rounds.map,
      status: done,
      words: chart.words,
      error: chart.error.filter((_, n) => chart && chart.status[n] >= 0),
      ms: times.map,
    },
  );
  element('told-asked').textContent = `error asked for ${showError(askedError())}`;
  tellKeyValues();
  tellFailures();
  tellWarnings();
  tellAloud();
}

/** Where a branch was asked for and is not there. @param {Motion} of */
function branchNote({ branch, round }) {
  const missed = round === rounds.motion && state.hold !== 'gap' && state.branch !== 'any' && branch !== state.branch;
  return missed ? `: no ${state.branch} state was found here` : '';
}

function tellKeyValues() {
  const place = element('told-values');
  place.classList.toggle('old', motion?.round !== rounds.motion);
  if (!motion || motion.gap === null) {
    place.textContent = motion ? `No gap holds this ${HOLDS[state.hold].words}.` : '';
    return;
  }
  const { values } = motion;
  place.textContent =
    `Gap ${show(motion.gap, 'm')} · amplitude ${show(values.amplitude, 'm')}` +
    ` · phase lag ${show(values.phase, 'degree')}` +
    ` · force ${show(values.force_min, 'N')} to ${show(values.force_max, 'N')} · ${motion.branch}${branchNote(motion)}`;
}

/** What the engine says, near the controls and above the picture that it is about. */
function tellFailures() {
  const all = Object.entries(failures).filter(([, words]) => words !== '');
  const texts = all.map(([part, words]) => `No ${part} for these positions: ${words}`);
  const left = leftOut();
  const notes = left.length
    ? [`The page searches for steady states. It leaves out ${left.join(' and ')} of the scene.`]
    : [];
  const shown = [...new Set(all.map(([, words]) => words))].length === 1 ? texts.slice(0, 1) : texts;
  // What the engine speaks of is marked at its field.
  const refused = all.map(([, words]) => words).join(' ');
  for (const one of QUANTITIES.filter((each) => each.path !== '' && refused.includes(`\`${each.path}\``))) {
    element(`t-${one.id}`).setAttribute('aria-invalid', 'true');
  }
  setText('failure', [deadTold, ...shown].filter((one) => one !== '').join('\n'));
  setText('note', [...notes, unknownWords].filter((one) => one !== '').join(' '));
}

let unknownWords = '';

/**
 * Words that stay are not put anew, or a screen reader would read them again.
 * @param {string} id @param {string} text
 */
function setText(id, text) {
  const place = element(id);
  if (place.textContent !== text) place.textContent = text;
  place.hidden = text === '';
}

/** All warnings of the program and the reasons of statuses, each with the picture that it is about. */
function tellWarnings() {
  const from = /** @type {[string, string[]][]} */ ([
    ['Curve', curve?.warnings ?? []],
    ['Motion', motion?.warnings ?? []],
    ['Map', joinedWarnings(chart?.warnings ?? [])],
  ]);
  const lines = from.flatMap(([name, all]) => [...all].map((one) => `${name}: ${one}`));
  const marked = /** @type {[string, number[], StatusWord[]][]} */ ([
    ['Curve', (curve?.ways ?? []).flatMap((way) => way.status), curve?.words ?? []],
    ['Motion', motion ? [motion.status] : [], motion?.words ?? []],
    ['Map', (chart?.status ?? []).filter((one) => one >= 0), chart?.words ?? []],
  ]);
  const bad = marked.flatMap(([name, status, words]) =>
    statusCounts(status, words)
      .filter((one) => one.code !== 0)
      .map((one) => `${name}: ${one.count} ${one.word}: ${one.reason}`),
  );
  const list = element('warnings-list');
  const all = [...bad, ...lines];
  setText(
    'warnings-count',
    `${lines.length} ${lines.length === 1 ? 'warning' : 'warnings'} of the program` +
      (bad.length ? '; why some points are not ok' : ''),
  );
  if (list.dataset.text === all.join('\n')) return;
  list.dataset.text = all.join('\n');
  list.replaceChildren(
    ...all.map((one) => {
      const item = document.createElement('li');
      item.textContent = one;
      return item;
    }),
  );
}

/** A map comes in parts. What each part warns of is told once, for all of them. @param {string[]} all */
function joinedWarnings(all) {
  /** @type {Map<string, {some: number, of: number, rest: string}>} */
  const kinds = new Map();
  for (const one of all) {
    const found = /^(\d+) of (\d+) instances, instance \d+ first: (.*)$/s.exec(one);
    const rest = found ? found[3] : one;
    const kind = rest.replace(/[\d.e-]+/g, '#');
    const before = kinds.get(kind) ?? { some: 0, of: 0, rest };
    kinds.set(kind, {
      ...before,
      some: before.some + Number(found?.[1] ?? 0),
      of: before.of + Number(found?.[2] ?? 0),
    });
  }
  return [...kinds.values()].map(({ some, of, rest }) =>
    of ? `${some} of ${of} instances, as this one: ${rest}` : rest,
  );
}

/** @type {number | undefined} */
let aloudTimer;
/** A screen reader is told once all is at rest, not at every step. */
function tellAloud() {
  clearTimeout(aloudTimer);
  aloudTimer = setTimeout(() => {
    if (isQuiet()) setText('aloud', `${element('told-values').textContent}. ${element('told-curve').textContent}`);
  }, 600);
}
