// Taking things along: the scene, the picture and the numbers.

/** The scene of a picture as a file of the program. @param {string} which @returns {Table} */
function sceneToSave(which) {
  if (which === 'motion') return heldScene();
  if (which === 'map') {
    const { x, y, of } = mapChoice();
    const axes = [mapAxis(x, COLUMNS), mapAxis(y, ROWS)];
    return mapScene(
      axes[0],
      axes[1],
      axes[1].values.map((_, n) => n),
      of,
    );
  }
  return followedScene(freeAmplitude() === null ? [] : curveGaps(), 'none');
}

/** @param {string} which */
const sceneText = (which) =>
  `# From the page of afmsweep live: the scene of its ${which}. Run it with: afmsweep run scene.toml\n` +
  `${toml(sceneToSave(which))}\n`;

/** @param {string} name @param {Blob} content */
function download(name, content) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

async function copyScene() {
  const text = sceneText(/** @type {HTMLSelectElement} */ (element('scene-of')).value);
  const area = /** @type {HTMLTextAreaElement} */ (element('scene-text'));
  area.value = text;
  try {
    await navigator.clipboard.writeText(text);
    setText('saved', 'The scene is in the clipboard.');
  } catch {
    // A page from disk may be refused the clipboard. The text can be taken by hand.
    element('scene-box').hidden = false;
    area.focus();
    area.select();
    setText('saved', 'The browser refuses the clipboard. Copy the text below.');
  }
}

/** @returns {string} the curve's numbers, with the scene that they belong to */
function numbersText() {
  if (!curve) return '';
  const units = {
    amplitude: 'm',
    phase: 'degree',
    force_max: 'N',
    force_min: 'N',
    indentation_max: 'm',
    contact_time: '1',
    dissipation: 'J',
  };
  const names = /** @type {(keyof typeof units)[]} */ (CURVE_OBSERVABLES);
  const head = [
    'way',
    'gap [m]',
    ...names.map((name) => `${name} [${units[name]}]`),
    'error_estimate [1]',
    'status',
    'branch',
    'jump',
  ];
  const old =
    curve.round !== rounds.curve
      ? '# These numbers belong to older positions of the sliders than the page shows.\n'
      : '';
  const lines = curve.ways.flatMap(
    (way) =>
      curve?.gaps.map((gap, n) =>
        [
          way.name,
          gap,
          ...names.map((name) => way.values[name][n] ?? 'nan'),
          way.error[n] ?? 'nan',
          curve?.words[way.status[n]]?.word ?? way.status[n],
          way.branch[n],
          way.jump[n] ? 1 : 0,
        ].join(','),
      ) ?? [],
  );
  const scene = toml({ ...curve.scene, output: output(CURVE_OBSERVABLES) })
    .split('\n')
    .map((line) => `# ${line}`)
    .join('\n');
  return (
    `${old}# From the page of afmsweep live. By "afmsweep run" the scene gives them within their errors:\n` +
    `${scene}\n${head.join(',')}\n${lines.join('\n')}\n`
  );
}

/** What stands above the plots of a saved picture. @returns {string[]} */
function pictureLines() {
  const held = HOLDS[state.hold].id;
  const moved = QUANTITIES.filter((one) => one.path !== '' && (!one.holds || one.id === held));
  const values = moved.map((one) => `${lower(one.words)} ${show(valueOf(one), one.unit)}`);
  const drive = state.resonance ? 'driven at the resonance' : `driven at ${show(valueOf(quantity('d')), '1', 5)}`;
  return [
    `Law ${state.law}; ${values.join(', ')}; ${hasQuantity('d') ? drive : 'driven as the scene says'}`,
    element('told-values').textContent ?? '',
    ['told-curve', 'told-motion', 'told-map', 'told-asked'].map((id) => element(id).textContent).join(';  '),
    'Blue: approach; orange, dashed: retract; grey, thin: each gap searched by itself; ×: not ok; ring: motion shown.',
  ];
}

/** @param {CanvasRenderingContext2D} paint @param {string} text @param {number} width @returns {string[]} */
function brokenLines(paint, text, width) {
  const lines = [''];
  for (const word of text.split(' ')) {
    const longer = `${lines[lines.length - 1]} ${word}`.trim();
    if (paint.measureText(longer).width > width) lines.push(word);
    else lines[lines.length - 1] = longer;
  }
  return lines;
}

/** All plots on one sheet, with the title, the key values and their errors. @returns {HTMLCanvasElement} */
function picture() {
  const ratio = devicePixelRatio;
  const sheet = document.createElement('canvas');
  const paint = /** @type {CanvasRenderingContext2D} */ (sheet.getContext('2d'));
  const sections = ['curve', 'motion', 'map'].map((id) => element(id));
  const edge = 12;
  const width = Math.max(...sections.map((one) => one.clientWidth)) + 2 * edge;
  const small = '12px system-ui, sans-serif';
  paint.font = small;
  const lines = pictureLines().flatMap((line) => brokenLines(paint, line, width - 2 * edge));
  const head = 40 + 17 * lines.length;
  sheet.width = width * ratio;
  sheet.height = (head + sections.reduce((sum, one) => sum + one.clientHeight + edge, 0)) * ratio;
  // A new size has taken the settings away.
  paint.scale(ratio, ratio);
  paint.fillStyle = colour('paper');
  paint.fillRect(0, 0, sheet.width, sheet.height);
  paint.fillStyle = colour('ink');
  paint.font = '600 16px system-ui, sans-serif';
  paint.fillText(START.title, edge, 22);
  paint.font = small;
  lines.forEach((line, n) => paint.fillText(line, edge, 42 + 17 * n));
  let below = head;
  for (const section of sections) {
    const from = section.getBoundingClientRect();
    for (const one of section.querySelectorAll('h2, figcaption, canvas')) {
      const box = one.getBoundingClientRect();
      const [x, y] = [box.left - from.left + edge, box.top - from.top + below];
      if (one instanceof HTMLCanvasElement) {
        if (box.width > 0) paint.drawImage(one, x, y, box.width, box.height);
      } else {
        paint.font = one.tagName === 'H2' ? '600 14px system-ui, sans-serif' : small;
        paint.fillText(one.textContent ?? '', x, y + 13);
      }
    }
    below += section.clientHeight + edge;
  }
  return sheet;
}

function makeSaves() {
  const name =
    START.title
      .toLowerCase()
      .replace(/[^a-z0-9]+/g, '_')
      .replace(/^_|_$/g, '')
      .slice(0, 40) || 'afmsweep';
  element('copy-scene').addEventListener('click', copyScene);
  element('save-scene').addEventListener('click', () => {
    const which = /** @type {HTMLSelectElement} */ (element('scene-of')).value;
    download(`${name}_${which}.toml`, new Blob([sceneText(which)], { type: 'application/toml' }));
  });
  element('save-numbers').addEventListener('click', () =>
    download(`${name}.csv`, new Blob([numbersText()], { type: 'text/csv' })),
  );
  element('save-picture').addEventListener('click', () =>
    picture().toBlob((blob) => {
      if (blob) download(`${name}.png`, blob);
    }),
  );
  element('copy-link').addEventListener('click', async () => {
    writeHash();
    try {
      await navigator.clipboard.writeText(location.href);
      setText('saved', 'The link is in the clipboard.');
    } catch {
      setText('saved', 'The browser refuses the clipboard. The link is the address of this page.');
    }
  });
  element('reset').addEventListener('click', () => {
    hashToState('');
    unknownWords = '';
    showControls();
    change();
  });
}
