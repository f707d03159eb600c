// One key's control: what is typed becomes a value, and what the scene says is shown.

import type { Schema, Value } from "../../core/midair_web.js";
import { word } from "../words.js";

export interface Control {
  element: HTMLElement;
  show(value: Value): void;
}

const AXES = ["x", "y", "z"];

const isNumber = (schema: Schema | undefined) => schema?.type === "number" || schema?.type === "integer" || (Array.isArray(schema?.type) && schema.type.includes("number"));

export function control(path: string, schema: Schema, value: Value, change: (value: Value) => void): Control {
  const id = `f-${path}`;
  let made: Control;
  if (schema.enum) made = choice(id, schema, change);
  else if (schema.type === "boolean") made = flag(id, schema, change);
  else if (isNumber(schema)) made = number(id, schema, change);
  else if (schema.type === "array" && isNumber(schema.items) && schema.minItems !== undefined && schema.minItems === schema.maxItems) {
    made = numbers(id, schema, change);
  } else if (schema.type === "string") made = text(id, schema, change);
  else made = list(id, schema, change);
  made.show(value);
  return made;
}

const defaulted = (schema: Schema) => (schema.default === undefined ? word("unset") : String(schema.default));

function choice(id: string, schema: Schema, change: (value: Value) => void): Control {
  const element = document.createElement("select");
  element.id = id;
  element.append(new Option(defaulted(schema), ""), ...schema.enum!.map((name) => new Option(name)));
  element.addEventListener("change", () => change(element.value || null));
  return { element, show: (value) => (element.value = typeof value === "string" ? value : "") };
}

function flag(id: string, schema: Schema, change: (value: Value) => void): Control {
  const element = document.createElement("input");
  element.type = "checkbox";
  element.id = id;
  element.addEventListener("change", () => change(element.checked));
  return { element, show: (value) => (element.checked = (value ?? schema.default) === true) };
}

/** A number as it is typed: to a hundredth of a millionth, without noise of the last digits. */
const shown = (value: number) => String(Number(value.toPrecision(12)));

function numberInput(schema: Schema): HTMLInputElement {
  const element = document.createElement("input");
  element.type = "number";
  element.step = schema.type === "integer" ? "1" : "any";
  if (schema.minimum !== undefined) element.min = String(schema.minimum);
  if (schema.maximum !== undefined) element.max = String(schema.maximum);
  return element;
}

function number(id: string, schema: Schema, change: (value: Value) => void): Control {
  const element = numberInput(schema);
  element.id = id;
  element.placeholder = defaulted(schema);
  element.addEventListener("change", () => {
    if (element.value === "") change(null);
    else if (Number.isFinite(element.valueAsNumber)) change(element.valueAsNumber);
  });
  return { element, show: (value) => (element.value = typeof value === "number" ? shown(value) : "") };
}

function numbers(id: string, schema: Schema, change: (value: Value) => void): Control {
  const count = schema.minItems!;
  const element = document.createElement("span");
  element.className = "numbers";
  const key = id.slice(2).replace(/^element\.\d+\./, "");
  const inputs = Array.from({ length: count }, (_, index) => {
    const input = numberInput(schema.items!);
    input.id = index === 0 ? id : `${id}.${index}`;
    input.setAttribute("aria-label", `${key} ${count <= 3 ? AXES[index] : index + 1}`);
    input.placeholder = Array.isArray(schema.default) ? String(schema.default[index]) : "";
    input.addEventListener("change", () => {
      if (inputs.every((each) => each.value === "")) change(null);
      else if (inputs.every((each) => Number.isFinite(each.valueAsNumber))) change(inputs.map((each) => each.valueAsNumber));
    });
    return input;
  });
  element.append(...inputs);
  const show = (value: Value) => inputs.forEach((input, index) => {
    const at: unknown = Array.isArray(value) ? value[index] : undefined;
    input.value = typeof at === "number" ? shown(at) : "";
  });
  return { element, show };
}

function text(id: string, schema: Schema, change: (value: Value) => void): Control {
  const element = document.createElement("input");
  element.id = id;
  element.placeholder = defaulted(schema);
  if (schema.examples) element.setAttribute("list", "glasses");
  element.addEventListener("change", () => change(element.value || null));
  return { element, show: (value) => (element.value = typeof value === "string" ? value : "") };
}

/** Numbers of any count, rows of them, or a colour: as JSON has them, without the outer brackets where it is one row. */
function list(id: string, schema: Schema, change: (value: Value) => void): Control {
  const rows = schema.items?.type === "array";
  const element = document.createElement(rows ? "textarea" : "input");
  element.id = id;
  element.setAttribute("spellcheck", "false");
  element.placeholder = defaulted(schema);
  element.addEventListener("change", () => {
    const typed = element.value.trim();
    if (typed === "") return change(null);
    try {
      const read: unknown = JSON.parse(rows || typed.startsWith("[") ? typed : `[${typed}]`);
      const one = Array.isArray(read) && read.length === 1 && schema.anyOf ? read[0] : read;
      element.setAttribute("aria-invalid", "false");
      change(one as Value);
    } catch {
      element.setAttribute("aria-invalid", "true");
    }
  });
  const show = (value: Value) => {
    element.value = value === null ? "" : rows ? JSON.stringify(value) : String(Array.isArray(value) ? value.join(", ") : value);
  };
  return { element, show };
}
