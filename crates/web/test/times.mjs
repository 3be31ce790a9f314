// node times.mjs PAGE.html [PROGRAM]: ms from a slider's move to the first points, the whole curve and the map, for each law; and
// what the program takes for the same curve and the same map, from its start to its results file.
//
// It needs playwright-core (where NODE_PATH has it) and /usr/bin/chromium.
import { createRequire } from 'node:module';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { SWITCHES } from './switches.mjs';

const { chromium } = createRequire(import.meta.url)('playwright-core');
const program = process.argv[3] && resolve(process.argv[3]);
const MOVES = 10;

/** The scene of one of the page's pictures. */
const sceneOf = async (which) => {
  await page.selectOption('#scene-of', which);
  await page.click('#copy-scene');
  return page.inputValue('#scene-text');
};
/** Runs a scene several times. */
const native = (text) => {
  const folder = mkdtempSync(join(tmpdir(), 'afmsweep-times-'));
  writeFileSync(join(folder, 'scene.toml'), text);
  const all = Array.from({ length: MOVES }, () => {
    const begun = performance.now();
    execFileSync(program, ['-q', 'run', 'scene.toml', '-o', 'results.h5', '--overwrite', '--no-audit'], { cwd: folder });
    return performance.now() - begun;
  });
  return all;
};
const leastAndMedian = (ms) => {
  ms.sort((a, b) => a - b);
  return `${ms[0].toFixed(0)}, ${ms[ms.length >> 1].toFixed(0)} ms`;
};

const browser = await chromium.launch({ executablePath: '/usr/bin/chromium', args: SWITCHES });
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
  const told = Object.entries(all).map(([name, ms]) => `${name} ${leastAndMedian(ms)}`);
  console.log(`${law}: least and median of ${MOVES} moves: ${told.join('; ')}`);
  if (!program) continue;
  for (const which of ['curve', 'map'])
    console.log(`${law}: the program, ${which}: least and median of ${MOVES} runs: ${leastAndMedian(native(await sceneOf(which)))}`);
}
await browser.close();
