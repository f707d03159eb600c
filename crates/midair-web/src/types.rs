//! The interfaces of the data that cross the border, for TypeScript.

use wasm_bindgen::prelude::wasm_bindgen;

#[wasm_bindgen(typescript_custom_section)]
const INTERFACES: &str = r#"
export type Vector = [number, number, number];

/** What is wrong, and what helps: thrown by whatever can fail. */
export interface Fault {
  fault: true;
  message: string;
  remedy: string | null;
  /** The file, and the line in it from 1. */
  file: string | null;
  line: number | null;
  /** What else is wrong with the same text. */
  others: { message: string; remedy: string; line: number | null }[];
}

export interface Schema {
  type?: string | string[];
  const?: string;
  enum?: string[];
  examples?: string[];
  description?: string;
  default?: unknown;
  minimum?: number;
  maximum?: number;
  minItems?: number;
  maxItems?: number;
  items?: Schema;
  properties?: Record<string, Schema>;
  required?: string[];
  oneOf?: Schema[];
  anyOf?: Schema[];
}

export interface Catalogue {
  plates: { name: string; size: [number, number] }[];
  displays: { name: string; resolution: [number, number]; size: [number, number]; pitch: [number, number] }[];
  glasses: string[];
  formats: { name: string; file: string }[];
  version: string;
}

export type Value = boolean | number | string | number[] | number[][] | null;

export interface Change {
  key: string;
  /** null: the key goes. */
  value: Value;
}

export type Role = "display" | "plate" | "image" | "solid" | "mirror" | "opaque";

export interface Body {
  role: Role;
  name: string;
  /** The element's number in the scene; null for display, plate, image and what is inside of elements. */
  element: number | null;
  measures: string;
  position: Vector;
  rotation: Vector;
  size: [number, number] | null;
}

export interface Layout {
  name: string;
  bodies: Body[];
  eye: Vector;
  image: Vector;
  elements: string[];
  resolution: [number, number];
  pitch: [number, number];
  notes: string[];
}

export interface Counts { ok: number; folded: number; outside: number; blocked: number }

export interface Line { key: string; value: Value }

export interface Finding {
  kind: string;
  severity: "fault" | "warning" | "note";
  sentence: string;
  remedy: string | null;
  lines: Line[];
}

export interface Check {
  image: { formed: number; folded: number; not_formed: Record<string, number> };
  findings: Finding[];
}
"#;
