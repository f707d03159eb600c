// The studio. The state is the scene's text; the core reads it, and tells what it finds.

import type { Catalogue, Layout, Line, Schema, Vector } from "../core/midair_web.js";
import { Core } from "./core/client.js";
import { LAYERS, type Edit, type Goods, type NamedBytes, type Reply, type Warp } from "./core/protocol.js";
import { takeFiles } from "./drop.js";
import { showFindings } from "./findings.js";
import { galleryDialog } from "./gallery-dialog.js";
import { appease, by, chooser, complain, onClick } from "./page.js";
import { Panel } from "./panel/panel.js";
import { showPresets } from "./panel/presets.js";
import { filesOf, FIRST, type Example } from "./scene/gallery.js";
import { History } from "./scene/history.js";
import { fromFragment, toFragment } from "./scene/link.js";
import { elementOf, freeName, SHAPES } from "./scene/shapes.js";
import { Seen, type Shown } from "./seen/seen.js";
import { download } from "./take.js";
import { tour } from "./tour.js";
import { FATES, Space, type Part, type ViewName } from "./view/space.js";
import { languageNow, preferred, speak, word, type Word } from "./words.js";

const history = new History();
let catalogue: Catalogue | undefined;
let panel: Panel | undefined;
let layout: Layout | undefined;
/** A body's number in the layout, or the eye. */
let selected: Part = "eye";
/** Files that were dropped: not the gallery's, and not in a link. */
const own = new Map<string, NamedBytes>();
/** Where the viewer looks from, while the compensation stays. */
let elsewhere: Vector | null = null;
/** Requests whose answer becomes a step of the history. */
const steps = new Set<number>();

const core = new Core((reply, id) => receive(reply, id));
const seen = new Seen(by<HTMLCanvasElement>("view"), by<HTMLCanvasElement>("warp"));
const space = madeSpace();
const openGallery = galleryDialog(core, (example) => {
  appease();
  void openExample(example);
});

function madeSpace(): Space | null {
  try {
    return new Space(by<HTMLCanvasElement>("space"), { select: (part) => part !== null && select(part), drag: dragged });
  } catch {
    complain(word("noGraphics"), word("noGraphicsRemedy"));
    return null;
  }
}

function receive(reply: Reply, id: number) {
  switch (reply.kind) {
    case "ready": return ready(reply.schema, reply.catalogue);
    case "scene": return showScene(reply, id);
    case "map": return showMap(reply);
    case "view": return seen.set(reply.seen, reply.view);
    case "check": return showFindings(reply.check, (lines) => change(edits(lines)));
    case "picture": return seen.setPicture(reply.picture);
    case "taken": return void download(reply.files);
    case "unread": return complain(word("unread", { name: reply.name }), word("unreadRemedy"));
    case "fault": return fault(reply.fault);
    case "crashed": return crashed(reply.why);
    case "source": case "perspective": case "done": return;
  }
}

const edits = (lines: Line[]): Edit[] => [{ op: "set", changes: lines.map(({ key, value }) => ({ key, value })) }];

function ready(schema: Schema, known: Catalogue) {
  catalogue = known;
  panel = new Panel(by<HTMLFormElement>("panel"), schema, (edit) => change([edit]));
  by("glasses").replaceChildren(...known.glasses.map((name) => new Option(name)));
  by<HTMLSelectElement>("format").replaceChildren(...known.formats.map(({ name }) => new Option(name)));
  showAdding();
  const text = history.now;
  if (text !== undefined) open(text, "scene.toml", [...own.values()]);
  else void begin();
}

/** The link's scene, else the first. */
async function begin() {
  if (location.hash.length <= 1) return openExample(FIRST);
  const text = await fromFragment(location.hash);
  if (text !== null) return open(text, "link.toml", await filesOf(text));
  if (history.now === undefined) await openExample(FIRST);
  complain(word("badLink"), word("badLinkRemedy"));
}

async function openExample(example: Example) {
  open(example.text, example.file.replace(/^.*\//, ""), await filesOf(example.text));
}

function open(text: string, name: string, files: NamedBytes[]) {
  elsewhere = null;
  steps.add(core.send({ kind: "open", text, name, files, views: true }));
}

function change(list: Edit[]) {
  appease();
  steps.add(core.send({ kind: "change", edits: list, live: false }));
}

function showScene(reply: Extract<Reply, { kind: "scene" }>, id: number) {
  const before = layout;
  layout = reply.layout;
  ended = 0;
  if (!reply.live && steps.delete(id)) {
    if (history.now === undefined && location.hash.length <= 1) performance.mark("first-scene");
    history.push(reply.text);
    by<HTMLTextAreaElement>("text").value = reply.text;
    void toFragment(reply.text).then((fragment) => {
      by<HTMLAnchorElement>("source-link").href = `source.html${fragment}`;
    });
    showHistory();
  }
  if (typeof selected === "number" && selected >= layout.bodies.length) selected = "eye";
  const shown = elsewhere && !follows() ? { ...layout, eye: elsewhere } : layout;
  space?.show(shown, reply.drawn, reply.rays);
  seen.resize(layout.resolution);
  showParts();
  panel?.fill(reply.values);
  const renewed = !before || before.bodies.length !== layout.bodies.length || before.name !== layout.name;
  if (renewed && !reply.live) select(selected);
}

function showMap(reply: Extract<Reply, { kind: "map" }>) {
  const { width, height }: Warp = reply.warp;
  seen.setMap(reply.warp);
  const all = width * height;
  const share = (count: number) => `${((100 * count) / all).toFixed(1)} %`;
  const { ok, folded, outside, blocked } = reply.counts;
  by("figures").textContent = reply.coarse
    ? word("coarse", { width, height })
    : word("figures", { width, height, ok: share(ok), folded: share(folded), outside: share(outside), blocked: share(blocked), bound: reply.bound.toExponential(0), time: reply.time.toFixed(0) });
  by("figures").dataset.time = reply.coarse ? "" : reply.time.toFixed(1);
}

function showHistory() {
  by<HTMLButtonElement>("undo").disabled = !history.canUndo;
  by<HTMLButtonElement>("redo").disabled = !history.canRedo;
}

function go(text: string | undefined) {
  if (text === undefined) return;
  appease();
  // Not a step: it is in the list already.
  core.send({ kind: "open", text, name: "scene.toml", files: [], views: true });
  by<HTMLTextAreaElement>("text").value = text;
  showHistory();
}

/** The parts as a list: for the keyboard, and for what stands behind another. */
function showParts() {
  if (!layout) return;
  const names: [Part, string, string][] = [["eye", word("eye"), ""], ...layout.bodies.map((body, index): [Part, string, string] => [index, body.name, body.measures])];
  by("parts").replaceChildren(...names.map(([part, name, about]) => {
    const option = document.createElement("div");
    option.role = "option";
    option.id = `part-${part}`;
    option.dataset.part = String(part);
    option.setAttribute("aria-selected", String(part === selected));
    const measures = document.createElement("small");
    measures.textContent = about;
    option.append(name, measures);
    return option;
  }));
  by("parts").setAttribute("aria-activedescendant", `part-${selected}`);
}

/** What the panel calls a part. */
function blockOf(part: Part): string | number {
  if (part === "eye") return "viewpoint";
  const body = layout?.bodies[part];
  return body?.element ?? body?.name ?? "viewpoint";
}

function elementOfPart(part: Part): number | null {
  return typeof part === "number" ? (layout?.bodies[part]?.element ?? null) : null;
}

function select(part: Part) {
  selected = part;
  showParts();
  space?.select(part);
  const isElement = elementOfPart(part) !== null;
  for (const id of ["duplicate", "remove"]) by<HTMLButtonElement>(id).disabled = !isElement;
  const block = blockOf(part);
  if (catalogue) showPresets(by("presets"), block, catalogue, (edit) => change([edit]));
  // What is inside of an element has no keys of its own.
  const known = typeof block === "number" || ["viewpoint", "image", "plate", "display"].includes(block);
  core.send({ kind: "watch", keys: panel && known ? panel.show(block) : [] });
}

const follows = () => by<HTMLInputElement>("follow").checked;

/** The keys that a part's place and turn are. */
function placed(part: Part, position: Vector, rotation: Vector): Edit[] {
  const block = blockOf(part);
  if (block === "viewpoint") return [{ op: "set", changes: [{ key: "viewpoint.position", value: position }] }];
  const at = typeof block === "number" ? `element.${block}` : block;
  return [{ op: "set", changes: [{ key: `${at}.position`, value: position }, { key: `${at}.rotation`, value: rotation }] }];
}

function dragged(part: Part, position: Vector, rotation: Vector, done: boolean) {
  if (part === "eye" && !follows()) {
    elsewhere = position;
    space?.moveEye(position);
    if (done) core.send({ kind: "eye", eye: position, live: false });
    else core.drag({ eye: position });
    return;
  }
  const list = placed(part, position, rotation);
  if (done) change(list);
  else core.drag({ edits: list });
}

/** Arrow keys move what is selected by a millimetre, with Shift by ten; Page Up and Down towards and away from the viewer. */
function nudged(event: KeyboardEvent) {
  const step = event.shiftKey ? 10 : 1;
  const ways: Record<string, Vector> = { ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowUp: [0, 1, 0], ArrowDown: [0, -1, 0], PageUp: [0, 0, 1], PageDown: [0, 0, -1] };
  const way = ways[event.key];
  if (!way || !layout) return;
  event.preventDefault();
  const body = typeof selected === "number" ? layout.bodies[selected] : undefined;
  const from = body?.position ?? elsewhere ?? layout.eye;
  const to = from.map((c, axis) => c + step * way[axis]!) as Vector;
  // The next key may come before the core's answer: it goes on from here.
  if (body) layout = { ...layout, bodies: layout.bodies.map((other) => (other === body ? { ...body, position: to } : other)) };
  else if (follows()) layout = { ...layout, eye: to };
  dragged(selected, to, body?.rotation ?? [0, 0, 0], true);
}

function fault(found: { message: string; remedy: string | null; line: number | null }) {
  complain(found.line ? word("line", { line: found.line, message: found.message }) : found.message, found.remedy);
  // What is shown goes back to what is kept.
  if (history.now === undefined) void openExample(FIRST);
  else core.send({ kind: "change", edits: [], live: false });
}

/** How often the core has ended since it last read a scene. */
let ended = 0;

function crashed(why: string) {
  console.warn(why);
  // What ends it at once would end it again and again.
  if (++ended > 3) return complain(word("gaveUp"), why);
  core.restart();
  complain(word("restarted"), null);
}

function takeAway(what: string) {
  if (what === "scene") return void download([{ name: "scene.toml", bytes: new TextEncoder().encode(history.now ?? "") }]);
  const goods: Record<string, Goods> = {
    map: { what: "map", format: by<HTMLSelectElement>("format").value },
    display: { what: "display", even: by<HTMLInputElement>("even").checked },
    drawing: { what: "drawing" },
    report: { what: "report" },
  };
  core.send({ kind: "take", goods: goods[what]! });
}

async function copyLink() {
  const fragment = await toFragment(history.now ?? "");
  window.history.replaceState(null, "", fragment);
  // Where the clipboard is closed to the page, the address bar has the link all the same.
  await navigator.clipboard?.writeText(location.href).catch(() => undefined);
  const named = [...own.keys()].filter((name) => history.now?.includes(`"${name}"`));
  by("told").textContent = named.length > 0 ? word("linkFiles", { files: named.join(", ") }) : word("linkCopied");
}

function showAdding() {
  const kinds = [...Object.keys(SHAPES), ...(own.size > 0 ? ["mesh"] : [])];
  by<HTMLSelectElement>("add").replaceChildren(new Option(word("add"), ""), ...kinds.map((kind) => new Option(kind)));
}

function addElement(kind: string, file?: string) {
  const name = freeName(file?.replace(/\.\w+$/, "") ?? kind, layout?.elements ?? []);
  change([{ op: "add", keys: elementOf(kind, name, file) }]);
}

function showLegend() {
  const names: Word[] = ["legendFormed", "legendReflected", "legendPlate", "legendDisplay", "legendStopped", "legendOther"];
  by("legend").replaceChildren(...FATES.map((_, index) => {
    const item = document.createElement("li");
    item.className = `fate-${index}`;
    item.textContent = word(names[index]!);
    return item;
  }));
}

function speakNow(language: "en" | "ja") {
  speak(language);
  showLegend();
  showAdding();
  if (layout) select(selected);
}

speakNow(preferred());
tour();
onClick("gallery-button", () => void openGallery());
onClick("undo", () => go(history.undo()));
onClick("redo", () => go(history.redo()));
onClick("language", () => speakNow(languageNow() === "en" ? "ja" : "en"));
onClick("message-close", appease);
onClick("read-text", () => {
  appease();
  steps.add(core.send({ kind: "open", text: by<HTMLTextAreaElement>("text").value, name: "scene.toml", files: [], views: true }));
});
onClick("link", () => void copyLink());
onClick("duplicate", () => {
  const element = elementOfPart(selected);
  if (element === null || !layout) return;
  change([{ op: "copy", element, name: freeName(layout.elements[element]!, layout.elements) }]);
});
onClick("remove", () => {
  const element = elementOfPart(selected);
  if (element !== null) change([{ op: "remove", element }]);
});
onClick("snap", () => {
  const on = by("snap").getAttribute("aria-pressed") !== "true";
  by("snap").setAttribute("aria-pressed", String(on));
  if (space) space.snapping = on;
});
chooser("views", "view", (name) => space?.look(name as ViewName));
chooser("modes", "mode", (mode) => space && (space.mode = mode as "translate" | "rotate"));
chooser("tabs", "seen", (shown) => {
  try {
    seen.choose(shown as Shown);
    core.send({ kind: "layer", layer: LAYERS.find((layer) => layer === shown) ?? null });
    by("layer-note").textContent = shown === "brightness" ? word("brightnessNote") : shown === "stray" ? word("strayNote") : "";
  } catch {
    complain(word("noGraphics"), word("noGraphicsRemedy"));
  }
});
chooser("take", "take", takeAway);
by("add").addEventListener("change", () => {
  const kind = by<HTMLSelectElement>("add").value;
  by<HTMLSelectElement>("add").value = "";
  if (kind === "mesh") addElement("mesh", [...own.keys()].at(-1));
  else if (kind) addElement(kind);
});
by("follow").addEventListener("change", () => {
  by("follow").title = word("followTip");
  elsewhere = null;
  core.send({ kind: "eye", eye: null, live: false });
  core.send({ kind: "change", edits: [], live: false });
});
by("parts").addEventListener("click", (event) => {
  const part = (event.target as HTMLElement).closest<HTMLElement>("[data-part]")?.dataset.part;
  if (part !== undefined) select(part === "eye" ? "eye" : Number(part));
});
by("parts").addEventListener("keydown", (event) => {
  if (!layout || (event.key !== "ArrowDown" && event.key !== "ArrowUp")) return;
  event.preventDefault();
  const at = selected === "eye" ? -1 : selected;
  const next = Math.min(layout.bodies.length - 1, Math.max(-1, at + (event.key === "ArrowDown" ? 1 : -1)));
  select(next < 0 ? "eye" : next);
});
by("space").addEventListener("keydown", nudged);
document.addEventListener("keydown", (event) => {
  const typing = (event.target as HTMLElement).matches("input, textarea, select");
  if (typing || !(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z") return;
  event.preventDefault();
  go(event.shiftKey ? history.redo() : history.undo());
});
window.addEventListener("hashchange", () => void begin());
takeFiles({
  scene: (file, beside) => {
    appease();
    for (const mesh of beside) own.set(mesh.name, mesh);
    open(new TextDecoder().decode(file.bytes), file.name, beside);
  },
  mesh: (file) => {
    own.set(file.name, file);
    showAdding();
    void dropMesh(file);
  },
  picture: (file) => core.send({ kind: "picture", name: file.name, bytes: file.bytes }),
  film: async (file) => {
    if (!(await seen.setFilm(file))) return complain(word("filmRefused", { name: file.name }), word("filmRefusedRemedy"));
    by("tabs").querySelector<HTMLElement>("[data-seen=display]")?.click();
  },
});

/** A dropped mesh is a new element; where it cannot be read, the scene stays. */
async function dropMesh(file: NamedBytes) {
  await core.ask({ kind: "files", files: [file] });
  addElement("mesh", file.name);
}

if ("serviceWorker" in navigator && import.meta.env.PROD) {
  // Without it everything works but for when there is no network.
  void navigator.serviceWorker.register("./keeper.js").catch(() => undefined);
}

// For tests and for whoever asks in the console: how quickly films are drawn, and where handles are.
Object.assign(window, { midair: { film: seen.film, grip: (axis: "x" | "y" | "z") => space?.grip(axis) } });
