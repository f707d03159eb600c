// The light source: a tablet's whole screen, the display image on it in its true size, nudged by touch, kept awake.

import type { Catalogue } from "../../core/midair_web.js";
import { Core } from "../core/client.js";
import type { Pixels, Reply } from "../core/protocol.js";
import { by, onClick } from "../page.js";
import { filesOf, FIRST } from "../scene/gallery.js";
import { fromFragment } from "../scene/link.js";
import { Film } from "../seen/film.js";
import { Warper } from "../seen/warp.js";
import { preferred, speak, word } from "../words.js";
import { keepAwake } from "./awake.js";

/** The width of a bank card (ISO/IEC 7810, ID-1), mm. */
const CARD = 85.6;
/** What a screen is taken for until it is said: CSS' own millimetre. */
const CSS_PITCH = 25.4 / 96;

const canvas = by<HTMLCanvasElement>("light");
const core = new Core(receive);
let pitch: [number, number] | undefined;
let size: [number, number] = [1, 1];
let film: Film | undefined;

/** Millimetres of this screen in a CSS pixel. */
let scale = Number(localStorage.getItem("screen-pitch")) || CSS_PITCH;
/** How far the image is moved from the screen's middle, mm: right and down. */
const moved = { x: Number(localStorage.getItem("nudge-x")) || 0, y: Number(localStorage.getItem("nudge-y")) || 0 };

function receive(reply: Reply) {
  switch (reply.kind) {
    case "ready": return void begin(reply.catalogue);
    case "source": return show(reply.display, reply.pitch);
    case "fault": return problem(`${reply.fault.message}. ${reply.fault.remedy ?? ""}`);
    case "unread": return problem(`${word("unread", { name: reply.name })} ${word("unreadRemedy")}`);
    case "crashed": return problem(word("restarted"));
    default: return;
  }
}

function problem(text: string) {
  by("problem").textContent = text;
  by("problem").hidden = false;
}

async function begin(catalogue: Catalogue) {
  const device = by<HTMLSelectElement>("device");
  device.replaceChildren(new Option(word("unset"), ""), ...catalogue.displays.map(({ name }) => new Option(name)));
  device.addEventListener("change", () => {
    const found = catalogue.displays.find(({ name }) => name === device.value);
    // The pixels of the glass are as many to a CSS pixel as the browser says.
    if (found) measured(found.pitch[0] * devicePixelRatio);
  });
  const given = location.hash.length > 1 ? await fromFragment(location.hash) : FIRST.text;
  if (given === null) problem(`${word("badLink")} ${word("badLinkRemedy")}`);
  const text = given ?? FIRST.text;
  by<HTMLAnchorElement>("back").href = `./${location.hash}`;
  core.send({ kind: "open", text, name: "scene.toml", files: await filesOf(text), views: false });
  core.send({ kind: "source", even: false });
}

function show(display: Pixels, itsPitch: [number, number]) {
  pitch = itsPitch;
  size = [display.width, display.height];
  if (!film) {
    [canvas.width, canvas.height] = size;
    canvas.getContext("2d", { alpha: false })!.putImageData(new ImageData(new Uint8ClampedArray(display.rgba), ...size), 0, 0);
  }
  lay();
}

/** Puts the image where it belongs, in its true size. */
function lay() {
  if (!pitch) return;
  const mm = [size[0] * pitch[0], size[1] * pitch[1]] as const;
  for (const shown of document.querySelectorAll<HTMLElement>("#stage canvas")) {
    shown.style.width = `${mm[0] / scale}px`;
    shown.style.height = `${mm[1] / scale}px`;
    shown.style.marginLeft = `${(moved.x - mm[0] / 2) / scale}px`;
    shown.style.marginTop = `${(moved.y - mm[1] / 2) / scale}px`;
  }
  by("bar").style.width = `${CARD / scale}px`;
  by<HTMLInputElement>("length").value = String(CARD / scale);
  by("sized").textContent = word("sized", { width: mm[0].toFixed(1), height: mm[1].toFixed(1) });
  by("nudged").textContent = word("nudge", { x: moved.x.toFixed(1), y: (-moved.y).toFixed(1) });
}

function measured(mmPerPixel: number) {
  scale = mmPerPixel;
  localStorage.setItem("screen-pitch", String(scale));
  lay();
}

function nudge(x: number, y: number) {
  moved.x += x;
  moved.y += y;
  localStorage.setItem("nudge-x", String(moved.x));
  localStorage.setItem("nudge-y", String(moved.y));
  lay();
}

speak(preferred());
by<HTMLInputElement>("length").addEventListener("input", (event) => measured(CARD / Number((event.target as HTMLInputElement).value)));
onClick("full", () => void document.documentElement.requestFullscreen?.().catch(() => undefined));
onClick("film-button", () => by("file").click());

let held: { x: number; y: number; far: boolean } | undefined;
by("stage").addEventListener("pointerdown", (event) => {
  held = { x: event.clientX, y: event.clientY, far: false };
  by("stage").setPointerCapture(event.pointerId);
});
by("stage").addEventListener("pointermove", (event) => {
  if (!held) return;
  const [x, y] = [event.clientX - held.x, event.clientY - held.y];
  if (!held.far && Math.hypot(x, y) < 5) return;
  nudge(x * scale, y * scale);
  held = { x: event.clientX, y: event.clientY, far: true };
});
by("stage").addEventListener("pointerup", () => {
  if (held && !held.far) by("controls").hidden = !by("controls").hidden;
  held = undefined;
});
document.addEventListener("keydown", (event) => {
  if ((event.target as HTMLElement).matches("input, select, summary")) return;
  const step = event.shiftKey ? 1 : 0.1;
  const ways: Record<string, [number, number]> = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] };
  const way = ways[event.key];
  if (way) {
    event.preventDefault();
    nudge(...way);
  } else if (event.key === "Escape" || event.key === " ") {
    if ((event.target as HTMLElement).matches("button, a")) return;
    by("controls").hidden = !by("controls").hidden;
  }
});

/** A picture goes by the core, as every picture; a film by the shader, through the same map. */
by("file").addEventListener("change", async () => {
  const file = by<HTMLInputElement>("file").files?.[0];
  if (!file) return;
  if (!file.type.startsWith("video/")) {
    core.send({ kind: "picture", name: file.name, bytes: new Uint8Array(await file.arrayBuffer()) });
    core.send({ kind: "source", even: false });
    return;
  }
  const replies = await core.ask({ kind: "warp" });
  const map = replies.find((reply) => reply.kind === "map");
  if (!map) return;
  // A canvas has one kind of graphics for good: the film gets its own.
  const fresh = canvas.cloneNode() as HTMLCanvasElement;
  [fresh.width, fresh.height] = [map.warp.width, map.warp.height];
  const warper = new Warper(fresh);
  warper.map(map.warp.width, map.warp.height, map.warp.pixels);
  const next = new Film(file, (video) => {
    warper.picture(video);
    warper.draw();
  });
  if (!(await next.play())) return problem(`${word("filmRefused", { name: file.name })} ${word("filmRefusedRemedy")}`);
  film?.stop();
  film = next;
  fresh.id = "film";
  canvas.hidden = true;
  document.getElementById("film")?.remove();
  by("stage").append(fresh);
});

void keepAwake((awake) => (by("awake").textContent = word(awake ? "awake" : "notAwake")));
