// The panel of properties, made from the scene file's schema: whatever a scene file can say, it can say.

import type { Change, Schema, Value } from "../../core/midair_web.js";
import type { Edit } from "../core/protocol.js";
import { shapeOf } from "../scene/shapes.js";
import { word } from "../words.js";
import { control } from "./control.js";

/** A key with its schema and where it stands. */
interface Key {
  path: string;
  name: string;
  schema: Schema;
  required: boolean;
}

export class Panel {
  #blocks: { path: string; schema: Schema }[] = [];
  #values: Record<string, Value> = {};

  constructor(
    private readonly form: HTMLFormElement,
    private readonly scene: Schema,
    private readonly edit: (edit: Edit) => void,
  ) {
    form.addEventListener("submit", (event) => event.preventDefault());
  }

  /** The blocks of a part: "viewpoint", "image", "plate", "display", or an element's number; what to watch is given back. */
  show(part: string | number): string[] {
    const of = (name: string) => this.scene.properties?.[name] ?? {};
    this.#blocks = typeof part === "number"
      ? [{ path: `element.${part}`, schema: of("element").items ?? {} }]
      : [{ path: part, schema: of(part) }];
    if (part === "viewpoint") {
      const scalars = Object.entries(this.scene.properties ?? {}).filter(([name, schema]) => !schema.properties && !schema.items && name !== "$schema");
      this.#blocks.push({ path: "", schema: { properties: Object.fromEntries(scalars) } });
      this.#blocks.push({ path: "tracker", schema: of("tracker") });
    }
    this.form.replaceChildren();
    delete this.form.dataset.kinds;
    return this.#blocks.flatMap(({ path, schema }) => watched(path, schema));
  }

  /** Fills in what the scene says; what is being typed into stays. */
  fill(values: Record<string, Value>) {
    this.#values = values;
    const held = this.form.contains(document.activeElement) ? (document.activeElement as HTMLElement).id : null;
    const kinds = this.#kinds();
    if (this.form.dataset.kinds === kinds) {
      for (const refresh of this.#refreshers) refresh(held ?? "");
      return;
    }
    this.form.dataset.kinds = kinds;
    this.#refreshers.length = 0;
    this.form.replaceChildren(...this.#blocks.map(({ path, schema }) => this.#block(path, schema)));
    if (held) document.getElementById(held)?.focus();
  }

  readonly #refreshers: ((held: string) => void)[] = [];

  /** What decides which keys there are: kinds of shapes, and which of several keys is given. */
  #kinds(): string {
    const kinds = Object.entries(this.#values).map(([path, value]) => (path.endsWith(".kind") ? value : `${path}${value === null}`));
    return JSON.stringify([this.#blocks.map((block) => block.path), kinds]);
  }

  #block(path: string, schema: Schema): HTMLElement {
    const set = document.createElement("fieldset");
    const legend = document.createElement("legend");
    legend.textContent = path.split(".").at(-1)?.replace(/^\d+$/, "element") || "scene";
    legend.title = schema.description ?? "";
    set.append(legend);
    const choice = schema.oneOf?.every((one) => one.required?.length === 1 && !one.properties) ? schema.oneOf.map((one) => one.required![0]!) : null;
    const given = choice?.find((name) => this.#values[`${path}.${name}`] !== null);
    if (choice) set.append(this.#chooser(path, choice, given));
    for (const key of keysOf(path, schema)) {
      if (choice?.includes(key.name) && key.name !== given) continue;
      if (key.schema.oneOf?.[0]?.properties?.kind) set.append(this.#variants(key));
      else if (key.schema.properties) set.append(this.#block(key.path, key.schema));
      else set.append(this.#field(key));
    }
    return set;
  }

  /** A select that says which of several shapes a block is, and that shape's keys. */
  #variants(key: Key): HTMLElement {
    const kinds = key.schema.oneOf!.map((one) => one.properties!.kind!.const!);
    const now = this.#values[`${key.path}.kind`];
    const variant = key.schema.oneOf!.find((one) => one.properties!.kind!.const === now);
    const set = this.#block(key.path, { ...variant, properties: without(variant?.properties, "kind") });
    const file = this.#values[`${key.path}.file`];
    const pick = select(`${key.path}.kind`, kinds, String(now), (kind) =>
      this.edit({ op: "block", key: key.path, block: shapeOf(kind, typeof file === "string" ? file : undefined) }));
    set.querySelector("legend")!.after(row("kind", pick, key.schema.description));
    return set;
  }

  /** A select that says which one of several keys is given. */
  #chooser(path: string, names: string[], given: string | undefined): HTMLElement {
    const pick = select(`${path}.which`, names, given ?? names[0]!, (name) => {
      const goes: Change[] = given ? [{ key: `${path}.${given}`, value: null }] : [];
      this.edit({ op: "set", changes: [...goes, { key: `${path}.${name}`, value: BEGIN[name] ?? "" }] });
    });
    return row(word("properties"), pick, names.join(", "));
  }

  #field(key: Key): HTMLElement {
    const change = (value: Value) => {
      if (value === null && key.required) return this.fill(this.#values);
      this.edit({ op: "set", changes: [{ key: key.path, value }] });
    };
    const made = control(key.path, key.schema, this.#values[key.path] ?? null, change);
    this.#refreshers.push((held) => {
      if (!held || !made.element.contains(document.getElementById(held))) made.show(this.#values[key.path] ?? null);
    });
    return row(key.name, made.element, key.schema.description);
  }
}

/** What a key is first given where it takes another's place. */
const BEGIN: Record<string, Value> = { ior: 1.49, glass: "N-BK7", cauchy: [1.49, 0.004], mirror: true, opaque: true, file: "glass.yml" };

function without(properties: Record<string, Schema> | undefined, name: string): Record<string, Schema> {
  return Object.fromEntries(Object.entries(properties ?? {}).filter(([key]) => key !== name));
}

function keysOf(path: string, schema: Schema): Key[] {
  return Object.entries(schema.properties ?? {})
    .filter(([name]) => name !== "$schema")
    .map(([name, inner]) => ({ path: path ? `${path}.${name}` : name, name, schema: inner, required: schema.required?.includes(name) ?? false }));
}

/** All keys of a block that have values. */
function watched(path: string, schema: Schema): string[] {
  return keysOf(path, schema).flatMap((key) => {
    if (key.schema.properties) return watched(key.path, key.schema);
    const variants = key.schema.oneOf?.filter((one) => one.properties) ?? [];
    if (variants.length > 0) return [...new Set(variants.flatMap((one) => watched(key.path, one)))];
    return [key.path];
  });
}

function row(name: string, element: HTMLElement, about?: string): HTMLElement {
  const line = document.createElement("div");
  line.className = "field";
  const label = document.createElement("label");
  label.textContent = name.replaceAll("_", " ");
  label.title = about ?? "";
  const first = element.matches("input, select, textarea") ? element : element.querySelector<HTMLElement>("input, select, textarea");
  if (first?.id) label.htmlFor = first.id;
  if (about && first) first.title = about;
  line.append(label, element);
  return line;
}

function select(id: string, names: string[], now: string, chosen: (name: string) => void): HTMLSelectElement {
  const element = document.createElement("select");
  element.id = `f-${id}`;
  element.append(...names.map((name) => new Option(name, name, false, name === now)));
  element.addEventListener("change", () => chosen(element.value));
  return element;
}
