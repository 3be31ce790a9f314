// node explore.mjs GRID.html LIST.html NAMED.html: drives pages of results in Chromium by clicks, drags and keys: of a grid, of a
// list, and of a grid with an axis of names. They have the engine in them. It needs what browser.mjs needs. Each check prints a line. It ends with 1 if one fails.
import { createRequire } from 'node:module';
import { resolve } from 'node:path';
import { readFileSync } from 'node:fs';
import { SWITCHES } from './switches.mjs';

const require = createRequire(import.meta.url);
const { chromium } = require('playwright-core');
const axe = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');

let failed = 0;
const check = (words, good, found = '') => {
  console.log(`${good ? 'ok    ' : 'FAILED'} ${words}${found === '' ? '' : `: ${found}`}`);
  if (!good) failed += 1;
};

const browser = await chromium.launch({ executablePath: '/usr/bin/chromium', args: SWITCHES });
const complaints = [];

/** A page in a window of that width. */
const open = async (file, width = 1400, dark = false) => {
  const context = await browser.newContext({
    viewport: { width, height: 1000 },
    colorScheme: dark ? 'dark' : 'light',
  });
  const page = await context.newPage();
  page.on('console', (one) => {
    if (one.type() === 'error') complaints.push(one.text());
  });
  page.on('pageerror', (one) => complaints.push(String(one)));
  page.on('request', (one) => {
    if (!/^(file|blob|data):/.test(one.url())) complaints.push(`network: ${one.url()}`);
  });
  const begun = Date.now();
  await page.goto(`file://${resolve(file)}`);
  await page.waitForFunction(() => document.getElementById('case-told')?.textContent !== '');
  return { page, ms: Date.now() - begun };
};
const told = (page, id) => page.textContent(`#${id}`);
const chosen = (page) => page.evaluate(() => window.afmsweep.choice.row);
/** Drawn pixels of a canvas that are neither clear nor grey. */
const coloured = (page, id) =>
  page.evaluate((name) => {
    const canvas = document.getElementById(name);
    const all = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
    let count = 0;
    for (let n = 0; n < all.length; n += 4)
      if (all[n + 3] > 60 && Math.max(all[n], all[n + 1], all[n + 2]) - Math.min(all[n], all[n + 1], all[n + 2]) > 40)
        count += 1;
    return count;
  }, id);
/** Once what was asked for is drawn. */
const drawn = (page) => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
const accessible = async (page, words) => {
  await page.evaluate(axe);
  const found = await page.evaluate(async () =>
    (await window.axe.run()).violations.map((one) => `${one.id} ${one.nodes[0].html.slice(0, 80)}`),
  );
  check(`axe finds nothing: ${words}`, found.length === 0, found.join('; '));
};

// A grid.
let { page, ms } = await open(process.argv[2]);
check('the grid has its numbers', /^Row \d+: .*estimated error \d/.test(await told(page, 'case-told')), `${ms} ms`);
check('its statuses and errors are told', /rows: .*ok.*error: median \d.*largest \d/.test(await told(page, 'all-told')));
check('the map has colours', (await coloured(page, 'map')) > 5000);
check('the parallel axes have lines', (await coloured(page, 'parallel')) > 500);
check(
  'the curves have lines',
  await page.evaluate(() => {
    const canvas = document.querySelector('#lines-plot canvas');
    const all = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
    return all.filter((one, n) => n % 4 === 3 && one > 100).length > 500;
  }),
);
let before = await chosen(page);
await page.focus('#a-0');
await page.keyboard.press('ArrowRight');
await drawn(page);
let now = await chosen(page);
const stride = await page.evaluate(() =>
  window.afmsweep.start.axes.slice(1).reduce((product, axis) => product * axis.values.length, 1),
);
check('a key on a slider moves one place along its axis', Math.abs(now - before) === stride, `${before} to ${now}`);
before = now;
await page.click('#map', { position: { x: 200, y: 100 } });
await drawn(page);
now = await chosen(page);
check('a click on the map chooses its row', now !== before && (await told(page, 'case-told')).startsWith(`Row ${now}:`));
await page.hover('#map', { position: { x: 300, y: 200 } });
check('the map is read where the pointer is', /^Row \d+: /.test(await told(page, 'map-told')));
await page.focus('#map');
before = await chosen(page);
await page.keyboard.press('ArrowUp');
await drawn(page);
check('an arrow key moves on the map', (await chosen(page)) !== before);
before = await told(page, 'map-words');
await page.selectOption('#of', { index: 1 });
await page.selectOption('#x', { index: 0 });
await drawn(page);
check('another observable and another axis are drawn', (await told(page, 'map-words')) !== before, await told(page, 'map-words'));
const box = await page.locator('#parallel').boundingBox();
const drag = async (share, from, to) => {
  await page.mouse.move(box.x + 46 + share * (box.width - 92), box.y + 34 + from * (box.height - 56));
  await page.mouse.down();
  await page.mouse.move(box.x + 46 + share * (box.width - 92), box.y + 34 + to * (box.height - 56), { steps: 5 });
  await page.mouse.up();
  await drawn(page);
};
await page.locator('#parallel').scrollIntoViewIfNeeded();
Object.assign(box, await page.locator('#parallel').boundingBox());
await drag(0, 0.4, 0.9);
const brushed = await page.evaluate(() => {
  const { choice, columns, start } = window.afmsweep;
  const [key, ends] = Object.entries(choice.brushes)[0] ?? ['', [0, 1]];
  const column = columns.find((one) => one.key === key);
  const share = (value) =>
    column.log
      ? Math.log(value / column.ends[0]) / Math.log(column.ends[1] / column.ends[0])
      : (value - column.ends[0]) / (column.ends[1] - column.ends[0]);
  let count = 0;
  for (let row = 0; row < start.count; row++) {
    const place = share(column.at(row));
    if (place >= ends[0] && place <= ends[1]) count += 1;
  }
  return count;
});
const words = await told(page, 'parallel-told');
check('a drag along an axis brushes the rows that pass there', words.startsWith(`${brushed} of `) && brushed > 0, words);
await page.reload();
await page.waitForFunction(() => document.getElementById('case-told')?.textContent !== '');
check('the link holds the choice', (await told(page, 'parallel-told')).startsWith(`${brushed} of `));
await page.click('#unbrush');
await drawn(page);
check('the brushes are cleared', /^\d+ rows.*Drag along/.test(await told(page, 'parallel-told')));

// Cases between the rows: at a row's own values the engine finds the row's own numbers.
await page.click('#between-row');
await page.check('#between-on');
await page.waitForFunction(() => window.afmsweep.between());
/** How far the engine's answer for the chosen row is from the file's numbers. */
const compared = () => {
  const { choice, columns } = window.afmsweep;
  const { answer } = window.afmsweep.between();
  // Where the sample takes no energy, the dissipation is rounding alone.
  const all = columns.filter(
    (one) => one.role === 'observable' && one.key !== 'dissipation' && answer.variables?.[one.key],
  );
  const apart = all.map((one) => {
    const live = answer.variables[one.key].data[0];
    const size = Math.max(...one.ends.map(Math.abs));
    return Math.abs(live - one.at(choice.row)) / size;
  });
  return { count: all.length, apart: Math.max(...apart), error: answer.error ?? '', status: answer.status?.[0] };
};
let same = await page.evaluate(compared);
check(
  'at a row the engine finds what the file has',
  same.count >= 3 && same.apart < 2e-3 && same.status === 0,
  `${same.count} observables within ${same.apart.toExponential(1)} ${same.error}`,
);
const first = await page.evaluate(() => JSON.stringify(window.afmsweep.between().answer.variables));
await page.locator('#between-sliders input').first().focus();
await page.keyboard.press('ArrowLeft');
await page.waitForFunction((old) => {
  const now = window.afmsweep.between();
  return now && JSON.stringify(now.answer.variables) !== old;
}, first);
await drawn(page);
check('a key moves a case between the rows', /estimated error \d/.test(await told(page, 'between-told')));
await drawn(page);
check('the motion between the rows is drawn', (await coloured(page, 'w-loop')) > 50);
await accessible(page, 'grid');
await accessible((await open(process.argv[2], 400, true)).page, 'grid, 400 pixels, dark');
const narrow = (await open(process.argv[2], 400)).page;
check(
  'nothing is wider than 400 pixels',
  await narrow.evaluate(() => document.documentElement.scrollWidth <= 400),
);

// A list.
({ page, ms } = await open(process.argv[3]));
check('the list has its numbers', /^Row \d+: /.test(await told(page, 'case-told')), `${ms} ms`);
check('its points have colours', (await coloured(page, 'map')) > 5 * (await page.evaluate(() => window.afmsweep.start.count)));
check('it has no curves', await page.locator('#lines').isHidden());
await page.fill('#row-number', '5');
await page.keyboard.press('Enter');
await page.locator('#row-number').blur();
await drawn(page);
check('a row is chosen by its number', (await told(page, 'case-told')).startsWith('Row 5:'));
check('its stored motion is drawn', /as the file has it/.test(await told(page, 'w-told')) && (await coloured(page, 'w-loop')) > 50);
await page.click('#next-wave');
await drawn(page);
check('the next stored motion is chosen', (await chosen(page)) === 0);
const place = await page.evaluate(() => {
  const { choice, columns } = window.afmsweep;
  const share = (key, row) => {
    const column = columns.find((one) => one.key === key);
    const [low, high] = column.ends;
    return column.log
      ? Math.log(column.at(row) / low) / Math.log(high / low)
      : (column.at(row) - low) / (high - low);
  };
  return { x: share(choice.x, 3), y: share(choice.y, 3) };
});
const cloud = await page.locator('#map').boundingBox();
await page.click('#map', {
  position: { x: 58 + place.x * (cloud.width - 132), y: 8 + (1 - place.y) * (cloud.height - 42) },
});
await drawn(page);
check('a click chooses the nearest point', (await chosen(page)) === 3);
await page.selectOption('#brush-of', { index: 0 });
await page.fill('#brush-0', await page.inputValue('#brush-1'));
await page.locator('#brush-0').blur();
await drawn(page);
check('fields brush as the pointer does', /^1 of \d+ rows/.test(await told(page, 'parallel-told')), await told(page, 'parallel-told'));
await accessible(page, 'list');

// Names stand for several quantities: those of the last row are not the scene's first ones.
({ page } = await open(process.argv[4]));
await page.evaluate(() => {
  location.hash = `#row=${window.afmsweep.start.count - 1}`;
});
await page.waitForFunction(() => window.afmsweep.choice.row === window.afmsweep.start.count - 1);
await page.click('#between-row');
await page.check('#between-on');
await page.waitForFunction(() => window.afmsweep.between());
same = await page.evaluate(compared);
check(
  'at the last name the engine finds what the file has',
  same.count >= 2 && same.apart < 2e-3 && same.status === 0,
  `${same.count} observables within ${same.apart.toExponential(1)} ${same.error}`,
);

check('no error and no network', complaints.length === 0, complaints.join('; '));
await browser.close();
if (failed) {
  console.log(`${failed} failed`);
  process.exit(1);
}
