// node moves.mjs PAGE.html [SECONDS] [SEED]: random moves of the live page. Twice a minute it prints the heap and the memory of
// the renderers of every Chromium on the machine. It ends with 1 if a picture stood with numbers of older positions unmarked or
// without its error, if the page does not come to rest in the end, or if it complained.
//
// It needs playwright-core (where NODE_PATH has it), ps and /usr/bin/chromium.
import { createRequire } from 'node:module';
import { execSync } from 'node:child_process';
import { resolve } from 'node:path';
import { SWITCHES } from './switches.mjs';

const { chromium } = createRequire(import.meta.url)('playwright-core');
const seconds = Number(process.argv[3] ?? 180);
/** After so long everything has to be at rest, ms. */
const PATIENCE = 60_000;
let seed = Number(process.argv[4] ?? 1);
const random = () => (seed = (seed * 1103515245 + 12345) % 2147483648) / 2147483648;

const browser = await chromium.launch({ executablePath: '/usr/bin/chromium', args: SWITCHES });
const page = await browser.newPage({ viewport: { width: 1400, height: 1000 } });
const complaints = [];
page.on('console', (one) => {
  if (one.type() === 'error') complaints.push(one.text());
});
page.on('pageerror', (one) => complaints.push(String(one)));
await page.goto(`file://${resolve(process.argv[2])}`);
await page.waitForFunction(() => window.afmsweep);
await page.evaluate(() => window.afmsweep.idle());

/** Looks at every frame that is drawn. */
await page.evaluate(() => {
  window.seen = { frames: 0, bad: [] };
  const look = () => {
    const { curve, motion, map, rounds } = window.afmsweep;
    const place = (id) => document.getElementById(id);
    const old = (id) => place(id).classList.contains('old');
    const told = place('told-curve').textContent;
    window.seen.frames += 1;
    if (curve && curve.round !== rounds.curve && !old('curves')) window.seen.bad.push('an old curve, unmarked');
    if (motion && motion.round !== rounds.motion && !old('motion')) window.seen.bad.push('an old motion, unmarked');
    if (map && map.round !== rounds.map && !old('map')) window.seen.bad.push('an old map, unmarked');
    if (curve && !/error median|refuses/.test(told)) window.seen.bad.push(`a curve without its error: ${told}`);
    requestAnimationFrame(look);
  };
  requestAnimationFrame(look);
});

const developer = await page.context().newCDPSession(page);
const memory = async () => {
  await developer.send('HeapProfiler.collectGarbage');
  const { usedSize } = await developer.send('Runtime.getHeapUsage');
  const all = execSync("ps -eo rss,args | grep '[t]ype=renderer' | awk '{s+=$1} END {print s/1000}'").toString();
  return `heap ${(usedSize / 1e6).toFixed(1)} MB, renderers ${Number(all).toFixed(0)} MB`;
};

/** One slider is moved a little or far; now and then a choice changes, or all begins again. */
const move = ([which, where, how]) => {
  const sliders = [...document.querySelectorAll('#sliders input[type=range]')].filter(
    (one) => !one.disabled && !one.closest('.row').hidden,
  );
  const slider = sliders[Math.floor(which * sliders.length)];
  const far = Math.floor(where * 401);
  const near = Math.max(0, Math.min(400, Number(slider.value) + Math.round((where - 0.5) * 60)));
  slider.value = String(how < 0.3 ? far : near);
  slider.dispatchEvent(new Event('input', { bubbles: true }));
  if (how > 0.95) {
    const choices = document.querySelectorAll('#law, #hold, #way, #branch, #map-of, #map-x, #map-y');
    const choice = choices[Math.floor(where * choices.length)];
    const options = [...choice.options].filter((one) => !one.disabled);
    choice.value = options[Math.floor(which * options.length)].value;
    choice.dispatchEvent(new Event('change', { bubbles: true }));
  }
  if (how > 0.9 && how < 0.91) document.getElementById('reset').click();
};

console.log(`at the start: ${await memory()}`);
const begun = Date.now();
const passed = () => (Date.now() - begun) / 1000;
let [moves, next] = [0, 30];
while (passed() < seconds) {
  await page.evaluate(move, [random(), random(), random()]);
  moves += 1;
  const haste = random();
  await page.waitForTimeout(haste < 0.7 ? 16 : haste < 0.95 ? 120 : 900);
  if (passed() < next) continue;
  console.log(`${next} s, ${moves} moves: ${await memory()}`);
  next += 30;
}
await page.evaluate(() => document.getElementById('reset').click());
const ended = Date.now();
const rests = await Promise.race([
  page.evaluate(() => window.afmsweep.idle()).then(() => true),
  new Promise((done) => setTimeout(() => done(false), PATIENCE)),
]);
const { frames, bad } = await page.evaluate(() => window.seen);
console.log(`at rest ${rests ? `after ${Date.now() - ended} ms` : 'never'}; ${moves} moves: ${await memory()}`);
console.log(`${frames} frames looked at, ${bad.length} bad: ${bad.slice(0, 5).join('; ') || 'none'}`);
console.log(`${complaints.length} complaints: ${complaints.slice(0, 5).join('; ') || 'none'}`);
await browser.close();
process.exit(rests && bad.length === 0 && complaints.length === 0 ? 0 : 1);
