// node browser.mjs PAGE.html [ENGINE.wasm]: drives the assembled page in Chromium by clicks, drags and keys.
//
// It needs the packages playwright-core and axe-core (where NODE_PATH or this folder has them) and /usr/bin/chromium.
// Each check prints a line. It ends with 1 if one fails.
import { createRequire } from 'node:module';
import { resolve } from 'node:path';
import { readFileSync } from 'node:fs';
import { SWITCHES } from './switches.mjs';

const require = createRequire(import.meta.url);
const { chromium } = require('playwright-core');
const axe = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');
const address = `file://${resolve(process.argv[2])}`;

let failed = 0;
const check = (words, good, found = '') => {
  console.log(`${good ? 'ok    ' : 'FAILED'} ${words}${found === '' ? '' : `: ${found}`}`);
  if (!good) failed += 1;
};

const browser = await chromium.launch({ executablePath: '/usr/bin/chromium', args: SWITCHES });
const context = await browser.newContext({
  viewport: { width: 1400, height: 1000 },
  permissions: ['clipboard-read', 'clipboard-write'],
});
const page = await context.newPage();
const complaints = [];
page.on('console', (one) => {
  if (one.type() === 'error') complaints.push(one.text());
});
page.on('pageerror', (one) => complaints.push(String(one)));
page.on('request', (one) => {
  if (!/^(file|blob|data):/.test(one.url())) complaints.push(`network: ${one.url()}`);
});

const idle = () => page.evaluate(() => window.afmsweep.idle());
/** The curve and the motion are there; the map may still be on its way. */
const shown = () =>
  page.waitForFunction(() => window.afmsweep.times.curve !== null && window.afmsweep.times.motion !== null);
const told = (id) => page.textContent(`#${id}`);
const numbers = () =>
  page.evaluate(() => {
    const { curve, motion, map, times, rounds } = window.afmsweep;
    return {
      kind: curve.kind,
      gaps: curve.gaps.length,
      amplitude: curve.ways[0].values.amplitude,
      status: curve.ways.flatMap((one) => one.status),
      errors: curve.ways.flatMap((one) => one.error),
      gap: motion.gap,
      motion: motion.values,
      source: motion.source,
      rows: map.done,
      mapStatus: map.status,
      mapValue: map.value,
      times: { ...times },
      rounds: { ...rounds },
    };
  });
const middle = (all) => all[all.length >> 1];

// The first picture.
await page.goto(address);
await idle();
let now = await numbers();
check(
  'the followed curve appears with both ways',
  now.kind === 'followed' && now.gaps >= 49 && now.status.length === 2 * now.gaps,
  `${now.gaps} gaps`,
);
check(
  'its numbers are ok and have errors',
  now.status.every((one) => one === 0) && now.errors.every((one) => one !== null && one < 1e-3),
);
check(
  'the amplitude rises with the gap',
  now.amplitude[0] > 1e-9 && middle(now.amplitude) > now.amplitude[0],
  `${now.amplitude[0].toExponential(2)} m`,
);
check('the map is whole', now.rows === 24 && now.mapStatus.every((one) => one >= 0));
check(
  'errors, statuses and warnings are told',
  /98 ok; error median .*largest/.test(await told('told-curve')) &&
    /\d+ warnings? of the program/.test(await told('warnings-count')),
  await told('told-curve'),
);
check(
  'the canvas has a line',
  await page.evaluate(() => {
    const canvas = document.querySelector('#c-amplitude canvas');
    const all = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
    let blue = 0;
    for (let n = 0; n < all.length; n += 4) if (all[n + 2] > all[n] + 60 && all[n + 3] > 100) blue += 1;
    return blue > 200;
  }),
);

// A key on a slider, and the mark of old numbers meanwhile.
const before = now;
await page.focus('#q-e');
const marked = await page.evaluate(() => {
  const slider = document.getElementById('q-e');
  slider.value = String(Number(slider.value) + 1);
  slider.dispatchEvent(new Event('input', { bubbles: true }));
  return ['curves', 'map', 'motion', 'told-curve', 'told-map'].every((id) =>
    document.getElementById(id).classList.contains('old'),
  );
});
check('old numbers are marked at once', marked);
await page.keyboard.press('ArrowRight');
await idle();
now = await numbers();
check(
  'a key moves a slider and the numbers',
  middle(now.amplitude) !== middle(before.amplitude) && now.rounds.curve > before.rounds.curve,
  await page.inputValue('#t-e'),
);
check('nothing is marked old at rest', (await page.evaluate(() => document.querySelectorAll('.old').length)) === 0);

// A field with a unit, and one with none such.
await page.fill('#t-r', '0.02 um');
await page.press('#t-r', 'Enter');
await shown();
check('a field takes another unit', (await page.inputValue('#t-r')) === '20 nm', await page.inputValue('#t-r'));
await page.fill('#t-r', '5 kPa');
await page.press('#t-r', 'Enter');
check('a field refuses a wrong unit in words', /no tip radius/.test(await told('w-r')), await told('w-r'));

// A drag on the curve.
const over = await page.locator('#c-force_max .u-over').boundingBox();
await page.mouse.move(over.x + over.width * 0.3, over.y + over.height / 2);
await page.mouse.down();
await page.mouse.move(over.x + over.width * 0.5, over.y + over.height / 2, { steps: 4 });
await page.mouse.up();
await shown();
const dragged = await numbers();
check(
  'the motion follows a drag on the curve',
  dragged.gap !== now.gap && /on the (approach|retract)/.test(dragged.source),
  `${dragged.gap} m`,
);
check('the cursor reads the curve', /Gap .*approach .*error/.test(await told('cursor-told')));

// A quick drag of a slider: the last position counts.
await page.locator('#q-a').scrollIntoViewIfNeeded();
const box = await page.locator('#q-a').boundingBox();
await page.mouse.move(box.x + box.width * 0.5, box.y + box.height / 2);
await page.mouse.down();
for (let n = 0; n < 30; n++) await page.mouse.move(box.x + box.width * (0.5 + n * 0.003), box.y + box.height / 2);
await page.mouse.up();
await shown();
now = await numbers();
const free = await page.evaluate(() => window.afmsweep.state.values.a);
check('after a drag the last position is shown', Math.abs(Math.max(...now.amplitude) / free - 1) < 0.05, `${free} m`);

// A set-point.
await page.selectOption('#hold', 'setpoint');
await page.fill('#t-s', '0.7');
await page.press('#t-s', 'Enter');
await idle();
now = await numbers();
check(
  'a set-point is held',
  Math.abs(now.motion.amplitude / free - 0.7) < 1e-3,
  `${(now.motion.amplitude / free).toFixed(4)}`,
);

// The link.
const hash = await page.evaluate(() => new Promise((done) => setTimeout(() => done(location.hash), 400)));
const other = await context.newPage();
await other.goto(address + hash);
await other.evaluate(() => window.afmsweep.idle());
check(
  'the link brings back state and numbers',
  (await other.evaluate(() => window.afmsweep.motion.gap)) === now.gap,
  hash,
);
await other.evaluate(() => {
  location.hash = '#law=hertz&nonsense=3&way=%E0%';
});
await other.waitForTimeout(50);
await other.evaluate(() => window.afmsweep.idle());
check('a changed link changes the page', (await other.inputValue('#law')) === 'hertz');
check('words of a link that are not known are told', /nonsense=3, way=%E0%/.test(await other.textContent('#note')));
await other.close();

// The scene.
if (process.argv[3]) {
  const { instance } = await WebAssembly.instantiate(readFileSync(process.argv[3]), {
    page: { now: () => performance.now() },
  });
  const engine = instance.exports;
  for (const which of ['curve', 'motion', 'map']) {
    await page.selectOption('#scene-of', which);
    await page.click('#copy-scene');
    await page.waitForTimeout(50);
    const text = new TextEncoder().encode(await page.evaluate(() => navigator.clipboard.readText()));
    const room = engine.room(text.length);
    new Uint8Array(engine.memory.buffer, room, text.length).set(text);
    const answer = engine.run(room, text.length, 0);
    const length = new DataView(engine.memory.buffer).getUint32(answer, true);
    const { error, status } = JSON.parse(
      new TextDecoder().decode(new Uint8Array(engine.memory.buffer, answer + 4, length)),
    );
    check(`the copied scene of the ${which} runs`, !error && status.length > 0, error ?? `${status.length} instances`);
  }
}

// What the program refuses.
await page.selectOption('#law', 'dmt');
await page.fill('#t-lt', '0.1');
await page.press('#t-lt', 'Enter');
check(
  'JKR cannot be chosen with a loss, and the page says why',
  (await page.locator('#law option[value=jkr]').isDisabled()) &&
    /viscous contact is not known with JKR/.test(await told('law-why')),
);
await page.fill('#t-lt', '0');
await page.press('#t-lt', 'Enter');
await page.fill('#t-k', '1e9 N/m');
await page.press('#t-k', 'Enter');
await idle();
check(
  "the engine's own words are shown",
  (await page.isVisible('#failure')) && /stiffness.*impossible/.test(await told('failure')),
);
check(
  'and the pictures are marked old',
  await page.evaluate(() => document.getElementById('curves').classList.contains('old')),
);
await page.fill('#t-k', '26 N/m');
await page.press('#t-k', 'Enter');
await shown();
check('and they go away', !(await page.isVisible('#failure')));

// The map.
await page.selectOption('#hold', 'gap');
await page.selectOption('#map-of', 'force_max');
await idle();
now = await numbers();
check('the map shows another observable', now.rows === 24 && now.mapValue.some((one) => one > 1e-9));
await page.locator('#map-canvas').scrollIntoViewIfNeeded();
const map = await page.locator('#map-canvas').boundingBox();
await page.mouse.move(map.x + map.width * 0.4, map.y + map.height * 0.4);
check(
  'the map is read at the pointer',
  /Largest force|largest force/.test(await told('map-told')) && /estimated error/.test(await told('map-told')),
  await told('map-told'),
);
const modulus = await page.inputValue('#t-e');
await page.mouse.click(map.x + map.width * 0.4, map.y + map.height * 0.4);
await idle();
check(
  'a click on the map moves the sliders',
  (await page.inputValue('#t-e')) !== modulus,
  await page.inputValue('#t-e'),
);
await page.focus('#map-canvas');
await page.keyboard.press('ArrowUp');
check('keys move on the map', /: largest force/.test(await told('map-told')));

// Presets, savings.
await page.selectOption('#preset-lever', '1');
await page.selectOption('#preset-surroundings', '1');
await idle();
check(
  'presets move the sliders',
  (await page.inputValue('#t-k')) === '2.8 N/m' && (await page.inputValue('#t-q')) === '3',
);
for (const [button, ending] of [
  ['save-scene', '.toml'],
  ['save-numbers', '.csv'],
  ['save-picture', '.png'],
]) {
  const [file] = await Promise.all([page.waitForEvent('download'), page.click(`#${button}`)]);
  const content = readFileSync(await file.path());
  const good =
    ending === '.csv'
      ? /^way,gap \[m\],.*status/m.test(content) && content.toString().split('\n').length > 98
      : content.length > 300;
  check(
    `${button} gives a file`,
    file.suggestedFilename().endsWith(ending) && good,
    `${file.suggestedFilename()}, ${content.length} bytes`,
  );
}

// Tours.
await page.click('#reset');
await idle();
const begun = await page.evaluate(() => JSON.stringify(window.afmsweep.state));
for (const tour of await page
  .locator('#tour-choice option')
  .evaluateAll((all) => all.slice(1).map((one) => one.value))) {
  await page.selectOption('#tour-choice', tour);
  let steps = 1;
  while ((await page.textContent('#tour-next')) !== 'End') {
    await page.click('#tour-next');
    steps += 1;
  }
  const pointed = await page.locator('.pointed').count();
  await page.click('#tour-back');
  const back = await told('tour-step');
  await page.click('#tour-leave');
  check(
    `tour ${tour} steps through`,
    steps >= 4 && steps <= 6 && pointed === 1 && back.startsWith(String(steps - 1)),
    `${steps} steps`,
  );
}
check(
  'leaving a tour brings the sliders back',
  (await page.evaluate(() => JSON.stringify(window.afmsweep.state))) === begun,
);
await page.selectOption('#tour-choice', '0');
await page.click('#tour-next');
await idle();
check(
  "a tour's numbers are those of the page",
  /lag is 111°/.test(await told('tour-text')) && /phase lag 111\.\d°/.test(await told('m-told')),
);
await page.click('#tour-leave');
await idle();

// Everybody.
for (const scheme of ['light', 'dark']) {
  await page.emulateMedia({ colorScheme: scheme });
  await page.evaluate(axe);
  const found = await page.evaluate(() =>
    window.axe
      .run()
      .then((all) => all.violations.map((one) => `${one.id} (${one.nodes.length}: ${one.nodes[0].html.slice(0, 80)})`)),
  );
  check(`axe-core finds nothing, ${scheme}`, found.length === 0, found.join('; '));
}
await page.setViewportSize({ width: 400, height: 800 });
await page.waitForTimeout(200);
const widths = await page.evaluate(() => [document.documentElement.scrollWidth, window.innerWidth]);
check('400 pixels need no horizontal scrolling', widths[0] <= widths[1], widths.join(' of '));
await page.emulateMedia({ reducedMotion: 'reduce' });
await page.waitForTimeout(100);
check('less motion stops the dot', (await page.textContent('#m-play')) === 'Play');
check('the console is silent', complaints.length === 0, complaints.join(' | '));
await browser.close();
console.log(failed ? `${failed} checks failed` : 'all checks passed');
process.exit(failed ? 1 : 0);
