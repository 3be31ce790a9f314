// One engine: it takes scenes as texts and gives back what the library says of them.
'use strict';

/**
 * What the library exports.
 * @typedef {{memory: WebAssembly.Memory, room: (length: number) => number, give_back: (answer: number) => void,
 *   run: (text: number, length: number) => number}} Library
 */
/** @type {Library} */
let engine;

/** @param {WebAssembly.Module} module */
async function start(module) {
  const imports = { page: { now: () => performance.now() } };
  engine = /** @type {any} */ ((await WebAssembly.instantiate(module, imports)).exports);
}

/** @param {string} toml the text of a scene */
function run(toml) {
  const text = new TextEncoder().encode(toml);
  const room = engine.room(text.length);
  new Uint8Array(engine.memory.buffer, room, text.length).set(text);
  const told = engine.run(room, text.length);
  const length = new DataView(engine.memory.buffer).getUint32(told, true);
  const answer = new TextDecoder().decode(new Uint8Array(engine.memory.buffer, told + 4, length));
  engine.give_back(told);
  return JSON.parse(answer);
}

/**
 * Waveforms are long. As typed arrays they are handed over and not copied.
 * @param {any} answer
 */
function packed(answer) {
  /** @type {Transferable[]} */
  const buffers = [];
  const pack = (/** @type {(number | null)[][]} */ rows) =>
    rows.map((row) => {
      const numbers = Float64Array.from(row, (one) => (one === null ? NaN : one));
      buffers.push(numbers.buffer);
      return numbers;
    });
  for (const name of ['time', 'tip_travel', 'force']) {
    if (answer.waveforms) answer.waveforms[name] = pack(answer.waveforms[name]);
  }
  return buffers;
}

onmessage = async ({ data }) => {
  if (data.module) {
    try {
      await start(data.module);
      postMessage({ ready: true });
    } catch (error) {
      postMessage({ trap: String(error) });
    }
    return;
  }
  const begun = performance.now();
  try {
    const answer = run(data.toml);
    const buffers = packed(answer);
    postMessage({ task: data.task, answer, ms: performance.now() - begun }, buffers);
  } catch (error) {
    // A trap leaves the engine's memory in the middle of something. The page starts another worker.
    postMessage({ task: data.task, trap: String(error) });
  }
};
