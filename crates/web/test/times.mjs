// node times.mjs PAGE.html: ms from a slider's move to the first points, the whole curve and the map, for each law.
//
// It needs playwright-core (where NODE_PATH has it) and /usr/bin/chromium.
import { createRequire } from 'node:module';
import { resolve } from 'node:path';

const { chromium } = createRequire(import.meta.url)('playwright-core');
const args = ['--headless', '--no-sandbox', '--disable-gpu', '--disable-background-networking', '--disable-sync'];
const MOVES = 10;

const browser = await chromium.launch({ executablePath: '/usr/bin/chromium', args });
const page = await browser.newPage();
const begun = performance.now();
await page.goto(`file://${resolve(process.argv[2])}`);
await page.waitForFunction(() => window.afmsweep?.times.first !== undefined);
console.log(`first picture ${(performance.now() - begun).toFixed(0)} ms after the page is opened`);
for (const law of ['hertz', 'dmt', 'jkr']) {
  await page.selectOption('#law', law);
  await page.evaluate(() => window.afmsweep.idle());
  const all = { first: [], curve: [], map: [] };
  for (let move = 0; move < MOVES; move += 1) {
    await page.focus('#q-e');
    await page.keyboard.press(move % 2 ? 'ArrowLeft' : 'ArrowRight');
    await page.evaluate(() => window.afmsweep.idle());
    const times = await page.evaluate(() => window.afmsweep.times);
    for (const name of Object.keys(all)) all[name].push(times[name]);
  }
  const told = Object.entries(all).map(([name, ms]) => {
    ms.sort((a, b) => a - b);
    return `${name} ${ms[0].toFixed(0)}, ${ms[MOVES / 2].toFixed(0)} ms`;
  });
  console.log(`${law}: least and median of ${MOVES} moves: ${told.join('; ')}`);
}
await browser.close();
