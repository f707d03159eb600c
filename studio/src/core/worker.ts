// The core's own thread. What is asked for last wins: work in several stages looks for newer requests between them.

import init, { catalogue, Files, Scene, schema, Still, type Fault, type Solution, type Value, type Vector } from "../../core/midair_web.js";
import demo from "../picture.webp?url";
import type { Asked, Drawn, Edit, Goods, Layer, NamedBytes, Pixels, Reply, Request, Seen, Told } from "./protocol.js";

/** Display pixels along the longer side of a map that follows a drag. */
const COARSE = 128;
/** View pixels in a row that follow a drag, and at rest. */
const [GLANCE, LOOK] = [112, 384];
/** The same of a layer. */
const LAYER = 192;
/** Rays along each side of the image that are drawn. */
const RAYS = 7;

const scope = self as unknown as { postMessage(message: unknown, transfer: Transferable[]): void };
let files: Files;
let scene: Scene | undefined;
/** The scene as it is shown: while a thing is dragged another than what is kept. */
let live: Scene | undefined;
let solution: Solution | undefined;
let picture: Still | undefined;
/** The same in small: what a drag shows is no finer. */
let small: Still | undefined;
let eye: Vector | null = null;
let watched: string[] = [];
let layer: Layer | null = null;
let viewed = true;
let newest = 0;

/** The picture of `midair demo`, until there is another. */
const demoBytes = fetch(demo).then((response) => response.arrayBuffer());

const started = init().then(async () => {
  files = new Files();
  [picture, small] = await decoded(new Blob([await demoBytes]));
});

/** Pixels of a picture at most, and of its small twin; larger ones are reduced to that. */
const [MOST_PIXELS, FEW_PIXELS] = [16e6, COARSE * COARSE];

/** A picture over black, as the browser decodes it: turned as it says, its colours in sRGB. */
async function decoded(file: Blob): Promise<[Still, Still]> {
  const bitmap = await createImageBitmap(file);
  const both: [Still, Still] = [drawn(bitmap, MOST_PIXELS), drawn(bitmap, FEW_PIXELS)];
  bitmap.close();
  return both;
}

function drawn(bitmap: ImageBitmap, most: number): Still {
  const factor = Math.min(1, Math.sqrt(most / (bitmap.width * bitmap.height)));
  const [width, height] = [bitmap.width, bitmap.height].map((side) => Math.max(1, Math.floor(side * factor))) as [number, number];
  const context = new OffscreenCanvas(width, height).getContext("2d", { alpha: false, willReadFrequently: true })!;
  context.imageSmoothingQuality = "high";
  context.drawImage(bitmap, 0, 0, width, height);
  return Still.of_codes(width, height, new Uint8Array(context.getImageData(0, 0, width, height).data.buffer));
}

function tell(id: number, reply: Reply, transfer: Transferable[] = []) {
  scope.postMessage({ ...reply, id } satisfies Told, transfer);
}

const channel = new MessageChannel();
const waiting: (() => void)[] = [];
channel.port1.onmessage = () => waiting.shift()?.();

/** Lets newer requests in. */
function pause(): Promise<void> {
  return new Promise((resolve) => {
    waiting.push(resolve);
    channel.port2.postMessage(0);
  });
}

function edited(from: Scene, edits: Edit[]): Scene {
  let now = from;
  for (const edit of edits) {
    const before = now;
    switch (edit.op) {
      case "set": now = before.changed(edit.changes, files); break;
      case "block": now = before.with_block(edit.key, edit.block, files); break;
      case "add": now = before.with_element(edit.keys, files); break;
      case "remove": now = before.without_element(edit.element, files); break;
      case "copy": now = before.with_copy(edit.element, edit.name, files); break;
    }
    if (before !== from) before.free();
  }
  return now;
}

function show(next: Scene, isLive: boolean) {
  if (live && live !== scene) live.free();
  if (!isLive) {
    if (scene && scene !== next) scene.free();
    scene = next;
  }
  live = next;
}

function tellScene(id: number, shown: Scene, isLive: boolean) {
  const layout = shown.layout();
  const transfer: Transferable[] = [];
  const drawn: Drawn[] = layout.bodies.map((_, index) => {
    const lines = shown.lines(index);
    const parts = { edges: lines.edges(), hull: lines.hull(), faces: lines.faces() };
    lines.free();
    transfer.push(parts.edges.buffer, parts.hull.buffer, parts.faces.buffer);
    return parts;
  });
  const found = shown.rays(RAYS);
  const rays = { ends: found.ends(), fates: found.fates() };
  found.free();
  transfer.push(rays.ends.buffer, rays.fates.buffer);
  const known = shown.values(watched);
  const values: Record<string, Value> = {};
  watched.forEach((key, index) => (values[key] = known[index] ?? null));
  tell(id, { kind: "scene", text: shown.text, layout, drawn, rays, values, live: isLive }, transfer);
}

function tellMap(id: number, map: Solution, coarse: boolean, time: number) {
  const pixels = map.pixels() as Float32Array<ArrayBuffer>;
  const warp = { width: map.width, height: map.height, pixels };
  tell(id, { kind: "map", warp, counts: map.counts(), bound: map.error_bound, coarse, time }, [pixels.buffer]);
}

function tellView(id: number, seen: Seen, shown: Scene, width: number, rgba: Uint8Array, isLive: boolean) {
  const view: Pixels = { width, height: shown.view_height(width), rgba: rgba as Uint8Array<ArrayBuffer> };
  tell(id, { kind: "view", seen, view, live: isLive }, [view.rgba.buffer]);
}

/** Where the viewer of the view stands; nowhere else than the viewpoint: undefined. */
const from = () => (eye ? Float64Array.from(eye) : undefined);

/** What follows a drag. Of an eye elsewhere the map is no other. */
function glance(id: number, shown: Scene, mapToo = true) {
  const start = performance.now();
  const coarse = shown.solve(COARSE);
  if (mapToo) tellMap(id, coarse, true, performance.now() - start);
  const light = coarse.light(small!);
  tellView(id, "compensated", shown, GLANCE, shown.view(light, from(), GLANCE, 1), true);
  light.free();
  coarse.free();
}

/** What is worked out at rest. */
async function look(id: number) {
  const stale = () => id !== newest || !scene;
  await pause();
  if (stale()) return;
  const start = performance.now();
  const whole = scene!.solve(undefined);
  solution?.free();
  solution = whole;
  tellMap(id, whole, false, performance.now() - start);
  await pause();
  if (stale()) return;
  await views(id);
  if (stale()) return;
  await pause();
  if (stale()) return;
  tellLayer(id);
  await pause();
  if (stale()) return;
  tell(id, { kind: "check", check: scene!.check() });
}

/** What is shown of light besides the picture. */
function tellLayer(id: number) {
  if (!layer || !scene) return;
  const rgba = layer === "brightness" ? scene.brightness(LAYER) : scene.stray((solution ??= scene.solve(undefined)), LAYER);
  tellView(id, layer, scene, LAYER, rgba, false);
}

async function views(id: number) {
  const stale = () => id !== newest || !scene || !solution;
  const shown = (seen: Seen): boolean => {
    if (stale()) return false;
    if (seen === "reference") {
      tellView(id, seen, scene!, LOOK, scene!.reference(picture!, LOOK, 1), false);
      return true;
    }
    const light = seen === "compensated" ? solution!.light(picture!) : solution!.uncompensated_light(picture!);
    tellView(id, seen, scene!, LOOK, scene!.view(light, from(), LOOK, 2), false);
    light.free();
    return true;
  };
  for (const seen of ["compensated", "uncompensated", "reference"] as const) {
    if (!shown(seen)) return;
    await pause();
  }
}

function take(goods: Goods): NamedBytes[] {
  const text = (name: string, text: string): NamedBytes => ({ name, bytes: new TextEncoder().encode(text) });
  const shown = scene!;
  solution ??= shown.solve(undefined);
  switch (goods.what) {
    case "map":
      return solution.files(goods.format, picture!.width, picture!.height).map((file) => {
        const taken = { name: file.name, bytes: file.take() };
        file.free();
        return taken;
      });
    case "display": {
      const file = solution.display_file(picture!, goods.even, "display.png");
      return [{ name: file.name, bytes: file.take() }];
    }
    case "drawing": return [text("drawing.svg", shown.drawing())];
    case "report": return [text("report.json", JSON.stringify(shown.check(), null, 2))];
  }
}

function add(more: NamedBytes[]) {
  for (const file of more) files.add(file.name, file.bytes);
}

async function answer(id: number, request: Request) {
  switch (request.kind) {
    case "open": {
      add(request.files);
      eye = null;
      show(Scene.read(request.text, request.name, files), false);
      solution?.free();
      solution = undefined;
      viewed = request.views;
      tellScene(id, scene!, false);
      if (!viewed) return;
      glance(id, scene!);
      return look(id);
    }
    case "change": {
      if (!scene) return;
      show(edited(scene, request.edits), request.live);
      tellScene(id, live!, request.live);
      glance(id, live!);
      if (request.live) return;
      solution?.free();
      solution = undefined;
      return look(id);
    }
    case "eye": {
      eye = request.eye;
      if (!scene) return;
      if (request.live) return glance(id, scene, false);
      solution ??= scene.solve(undefined);
      return views(id);
    }
    case "picture": {
      const read = await decoded(new Blob([request.bytes as Uint8Array<ArrayBuffer>])).catch(() => null);
      if (!read) return tell(id, { kind: "unread", name: request.name });
      picture?.free();
      small?.free();
      [picture, small] = read;
      tellPicture(id, request.name);
      return viewed && scene && solution ? views(id) : undefined;
    }
    case "watch": {
      watched = request.keys;
      if (live) tellScene(id, live, live !== scene);
      return;
    }
    case "layer": {
      layer = request.layer;
      return tellLayer(id);
    }
    case "files": return add(request.files);
    case "take": {
      if (!scene) return;
      const taken = take(request.goods);
      return tell(id, { kind: "taken", files: taken }, taken.map((file) => file.bytes.buffer));
    }
    case "source": {
      if (!scene) return;
      solution ??= scene.solve(undefined);
      const rgba = solution.display(picture!, request.even) as Uint8Array<ArrayBuffer>;
      const display = { width: solution.width, height: solution.height, rgba };
      return tell(id, { kind: "source", display, pitch: scene.layout().pitch }, [rgba.buffer]);
    }
    case "warp": {
      if (!scene) return;
      solution ??= scene.solve(undefined);
      return tellMap(id, solution, false, 0);
    }
    case "perspective": {
      add(request.files);
      const other = Scene.read(request.text, request.name, files);
      tell(id, { kind: "perspective", svg: other.perspective() });
      return other.free();
    }
  }
}

function tellPicture(id: number, name: string) {
  const rgba = picture!.rgba() as Uint8Array<ArrayBuffer>;
  tell(id, { kind: "picture", picture: { width: picture!.width, height: picture!.height, rgba }, name }, [rgba.buffer]);
}

const isFault = (thrown: unknown): thrown is Fault => typeof thrown === "object" && thrown !== null && "fault" in thrown;

/** Requests that begin work anew; others leave it alone. */
const RENEWING: Request["kind"][] = ["open", "change", "eye", "picture"];

self.onmessage = async ({ data }: MessageEvent<Asked>) => {
  await started;
  const { id, ...request } = data;
  const before = newest;
  if (RENEWING.includes(request.kind)) newest = id;
  try {
    await answer(id, request as Request);
  } catch (thrown) {
    if (isFault(thrown)) {
      // What was there before goes on.
      newest = newest === id ? before : newest;
      tell(id, { kind: "fault", fault: thrown });
    } else {
      // A trap: this instance is not to be used again.
      tell(id, { kind: "crashed", why: String(thrown) });
    }
  }
  tell(id, { kind: "done" });
};

started.then(
  () => {
    tell(0, { kind: "ready", schema: schema(), catalogue: catalogue() });
    tellPicture(0, "");
  },
  (thrown: unknown) => tell(0, { kind: "crashed", why: String(thrown) }),
);
