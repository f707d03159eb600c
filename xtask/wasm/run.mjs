// Runs the module's tasks: `node run.mjs MODULE FOLDER TASKS ROUNDS`. The numbers of task N go to FOLDER/N.f64; then the map is timed, and each
// round's milliseconds are a line of standard output.
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";

const [module, folder, tasks, rounds] = process.argv.slice(2);
const host = { now: () => performance.now() };
const { instance } = await WebAssembly.instantiate(readFileSync(module), { host });
const { run, findings, map_time, memory } = instance.exports;

for (let task = 0; task < Number(tasks); task++) {
  const count = run(task);
  writeFileSync(join(folder, `${task}.f64`), new Uint8Array(memory.buffer, findings(), count * 8));
}
for (let round = 0; round < Number(rounds); round++) console.log(map_time());
