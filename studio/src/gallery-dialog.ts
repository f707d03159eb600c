// The gallery: each scene with a sketch and a sentence.

import type { Core } from "./core/client.js";
import { by, onClick } from "./page.js";
import { filesOf, GALLERY, type Example } from "./scene/gallery.js";

export function galleryDialog(core: Core, open: (example: Example) => void) {
  const dialog = by<HTMLDialogElement>("gallery");
  const sketches = new Map<string, HTMLElement>();
  let sketched = false;

  for (const example of GALLERY) {
    const button = document.createElement("button");
    button.dataset.scene = example.file;
    const sketch = document.createElement("span");
    sketch.className = "sketch";
    sketches.set(example.file, sketch);
    const name = document.createElement("strong");
    name.textContent = example.name;
    const about = document.createElement("small");
    about.textContent = example.about;
    button.append(sketch, name, about);
    button.addEventListener("click", () => {
      dialog.close();
      open(example);
    });
    by("examples").append(button);
  }

  onClick("gallery-close", () => dialog.close());
  return async () => {
    dialog.showModal();
    if (sketched) return;
    sketched = true;
    for (const example of GALLERY) {
      const files = await filesOf(example.text);
      const replies = await core.ask({ kind: "perspective", text: example.text, name: example.file, files });
      const svg = replies.find((reply) => reply.kind === "perspective");
      if (svg) sketches.get(example.file)!.replaceChildren(inlined(svg.svg));
    }
  };
}

/** A drawing of the core's as a part of the page. */
function inlined(svg: string): Node {
  const root = new DOMParser().parseFromString(svg, "image/svg+xml").documentElement;
  root.setAttribute("aria-hidden", "true");
  return document.importNode(root, true);
}
