// Plates and displays that are sold, as presets.

import type { Catalogue, Value } from "../../core/midair_web.js";
import type { Edit } from "../core/protocol.js";

/** Selects for what people have; nothing for parts that nobody sells. */
export function showPresets(place: HTMLElement, part: string | number, catalogue: Catalogue, edit: (edit: Edit) => void) {
  place.replaceChildren();
  const set = (changes: [string, Value][]) => edit({ op: "set", changes: changes.map(([key, value]) => ({ key, value })) });
  if (part === "plate") {
    place.append(offered("plate-preset", catalogue.plates.map((plate) => plate.name), (name) => {
      const plate = catalogue.plates.find((each) => each.name === name)!;
      set([["plate.size", plate.size]]);
    }));
  } else if (part === "display") {
    place.append(offered("display-preset", catalogue.displays.map((display) => display.name), (name) => {
      const display = catalogue.displays.find((each) => each.name === name)!;
      set([
        ["display.resolution", display.resolution],
        ["display.size", display.size.map((side) => Math.round(side * 100) / 100)],
        ["display.model", null], ["display.ppi", null], ["display.diagonal_inches", null], ["display.portrait", null],
      ]);
    }));
  }
}

function offered(id: string, names: string[], chosen: (name: string) => void): HTMLElement {
  const line = document.createElement("div");
  line.className = "field";
  const label = document.createElement("label");
  label.htmlFor = id;
  label.textContent = "preset";
  const select = document.createElement("select");
  select.id = id;
  select.append(new Option("…", ""), ...names.map((name) => new Option(name)));
  select.addEventListener("change", () => select.value && chosen(select.value));
  line.append(label, select);
  return line;
}
