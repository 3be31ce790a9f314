// Engines in workers, and what waits for one. A task that is no longer wanted is dropped or ended.

/**
 * @typedef {object} Task
 * @property {string} kind what it is for; the kinds are in the order of PRIORITIES
 * @property {Table} scene
 * @property {(answer: Answer, ms: number) => void} done
 * @property {boolean} [brief] whether it may end by itself when it is no longer wanted
 * @property {boolean} [dropped]
 * @property {number} [number]
 */

/**
 * The answer of the engine; its parts are told in docs/results.md.
 * @typedef {{error?: string, [key: string]: any}} Answer
 */
/** @typedef {{worker: Worker, task: Task | null, ready: boolean}} Engine */

/** The curve comes first, then the motion, then the map. */
const PRIORITIES = ['probe', 'coarse', 'curve', 'motion', 'fine', 'map', 'detail'];

/** @type {Engine[]} */
const engines = [];
/** @type {Task[]} */
let waiting = [];
/** @type {WebAssembly.Module | null} */
let engineModule = null;
let workerUrl = '';
let taskNumber = 0;
/** Called with the reason when no engine starts. @type {(why: string) => void} */
let onDead = () => {};
/** Called whenever the work at hand changes. */
let onWork = () => {};
let failedStarts = 0;
const MOST_FAILED_STARTS = 5;
/** How many work at a time. */
let engineCount = 0;
/** As many wait, started, for those that are ended: to start one takes longer than the first points of a curve. */
const SPARE_ENGINES = 2;
/** Spares are started when the first points are there, ms. */
const SPARE_AFTER = 400;
/** A brief task that is no longer wanted is ended after so long, ms. */
const BRIEF = 500;

/** @param {Task} task */
function ask(task) {
  task.number = ++taskNumber;
  waiting.push(task);
  waiting.sort(
    (a, b) =>
      PRIORITIES.indexOf(a.kind) - PRIORITIES.indexOf(b.kind) ||
      /** @type {number} */ (a.number) - /** @type {number} */ (b.number),
  );
  handOut();
}

function handOut() {
  let busy = engines.filter((engine) => engine.task).length;
  for (const engine of engines) {
    if (!engine.ready || engine.task || busy >= engineCount) continue;
    const task = waiting.shift();
    if (!task) break;
    engine.task = task;
    busy += 1;
    engine.worker.postMessage({ task: task.number, toml: toml(task.scene) });
  }
  onWork();
}

function startEngine() {
  /** @type {Engine} */
  const engine = { worker: new Worker(workerUrl), task: null, ready: false };
  engine.worker.onmessage = ({ data }) => {
    if (data.ready) {
      engine.ready = true;
      failedStarts = 0;
    } else if (data.trap) {
      replaceStopped(engine, data.trap);
    } else {
      const task = engine.task;
      engine.task = null;
      // The next task begins while the page draws.
      handOut();
      if (task && !task.dropped) task.done(data.answer, data.ms);
    }
    handOut();
  };
  engine.worker.onerror = (event) => replaceStopped(engine, event.message || 'the worker failed');
  engine.worker.postMessage({ module: engineModule });
  engines.push(engine);
}

/** @param {number} count */
function fillEngines(count) {
  while (engineModule && engines.length < count && failedStarts < MOST_FAILED_STARTS) startEngine();
}

/** @param {Engine} engine */
function endEngine(engine) {
  engine.worker.terminate();
  engines.splice(engines.indexOf(engine), 1);
}

/** @param {Engine} engine @param {string} why */
function replaceStopped(engine, why) {
  if (!engines.includes(engine)) return;
  const task = engine.task;
  endEngine(engine);
  // An engine that never starts is not started for ever.
  if (!engine.ready) failedStarts += 1;
  if (failedStarts >= MOST_FAILED_STARTS) onDead(why);
  fillEngines(engineCount);
  if (task && !task.dropped) task.done({ error: `the engine stopped and was started anew (${why})` }, 0);
  handOut();
}

/**
 * Drops tasks of these kinds. A brief one ends by itself; a longer one ends with its worker.
 * @param {string[]} kinds
 */
function dropTasks(kinds) {
  waiting = waiting.filter((task) => !kinds.includes(task.kind));
  for (const engine of [...engines]) {
    const task = engine.task;
    if (!task || task.dropped || !kinds.includes(task.kind)) continue;
    task.dropped = true;
    if (!task.brief) endEngine(engine);
    // A slow scene makes a brief task long.
    else setTimeout(() => endIfBusyWith(engine, task), BRIEF);
  }
  fillEngines(engineCount);
  setTimeout(() => fillEngines(engineCount + SPARE_ENGINES), SPARE_AFTER);
  onWork();
}

/** @param {Engine} engine @param {Task} task */
function endIfBusyWith(engine, task) {
  if (engine.task !== task || !engines.includes(engine)) return;
  endEngine(engine);
  fillEngines(engineCount);
  handOut();
}

/** @param {string[]} kinds */
const isBusyWith = (kinds) =>
  waiting.some((task) => kinds.includes(task.kind)) ||
  engines.some(({ task }) => task && !task.dropped && kinds.includes(task.kind));

const isIdle = () => waiting.length === 0 && engines.every(({ task, ready }) => ready && !task);

/** A small module that is valid only where the engine's SIMD instructions are known. */
const SIMD_MODULE = new Uint8Array([
  0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11,
]);

/** The bytes that an element of the page holds in base64. @param {string} id */
function bytesOf(id) {
  const text = atob(document.getElementById(id)?.textContent?.trim() ?? '');
  // A plain loop: with millions of letters it takes a fraction of what Uint8Array.from does.
  const bytes = new Uint8Array(text.length);
  for (let n = 0; n < text.length; n++) bytes[n] = text.charCodeAt(n);
  return bytes;
}

/** Unpacks the engine and starts two or more. An error tells in words what the browser lacks. */
async function startEngines() {
  if (typeof WebAssembly !== 'object') throw new Error('This browser has no WebAssembly.');
  if (!WebAssembly.validate(SIMD_MODULE)) throw new Error("This browser's WebAssembly has no SIMD instructions.");
  const code = /** @type {Uint8Array<ArrayBuffer>} */ (fzstd.decompress(bytesOf('engine')));
  engineModule = await WebAssembly.compile(code);
  const script = document.getElementById('worker')?.textContent ?? '';
  workerUrl = URL.createObjectURL(new Blob([script], { type: 'text/javascript' }));
  engineCount = Math.max(2, Math.min(4, navigator.hardwareConcurrency || 2));
  fillEngines(engineCount);
  setTimeout(() => fillEngines(engineCount + SPARE_ENGINES), 3 * SPARE_AFTER);
}
