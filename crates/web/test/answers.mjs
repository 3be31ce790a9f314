// The page's engine under Node: `node answers.mjs ENGINE.wasm SCENE...` prints one line of JSON for each scene.
import fs from 'node:fs';

const [engine, ...scenes] = process.argv.slice(2);
const module = await WebAssembly.compile(fs.readFileSync(engine));
const { exports } = await WebAssembly.instantiate(module, { page: { now: () => performance.now() } });

for (const scene of scenes) {
  const text = fs.readFileSync(scene);
  const room = exports.room(text.length);
  new Uint8Array(exports.memory.buffer, room, text.length).set(text);
  const answer = exports.run(room, text.length);
  const length = new DataView(exports.memory.buffer).getUint32(answer, true);
  console.log(Buffer.from(exports.memory.buffer, answer + 4, length).toString());
  exports.give_back(answer);
}
