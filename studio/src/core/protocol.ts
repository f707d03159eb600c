// What the page and the worker say to one another.

import type { Catalogue, Change, Check, Counts, Fault, Layout, Schema, Value, Vector } from "../../core/midair_web.js";

export type Edit =
  | { op: "set"; changes: Change[] }
  | { op: "block"; key: string; block: string }
  | { op: "add"; keys: string }
  | { op: "remove"; element: number }
  | { op: "copy"; element: number; name: string };

export interface NamedBytes {
  name: string;
  bytes: Uint8Array;
}

/** A thing to take away. */
export type Goods =
  | { what: "map"; format: string }
  | { what: "display"; even: boolean }
  | { what: "drawing" }
  | { what: "report" };

export type Request =
  /** `views`: whether map, views and findings are shown of it, or the light source's display image alone. */
  | { kind: "open"; text: string; name: string; files: NamedBytes[]; views: boolean }
  | { kind: "change"; edits: Edit[]; live: boolean }
  | { kind: "eye"; eye: Vector | null; live: boolean }
  | { kind: "picture"; name: string; bytes: Uint8Array }
  | { kind: "watch"; keys: string[] }
  /** The layer that is shown from now on; null: none is. */
  | { kind: "layer"; layer: Layer | null }
  | { kind: "files"; files: NamedBytes[] }
  | { kind: "take"; goods: Goods }
  | { kind: "source"; even: boolean }
  /** The whole map, told as such. */
  | { kind: "warp" }
  | { kind: "perspective"; text: string; name: string; files: NamedBytes[] };

export interface Drawn {
  edges: Float32Array;
  hull: Float32Array;
  faces: Float32Array;
}

export interface RayLines {
  ends: Float32Array;
  fates: Uint8Array;
}

export interface Pixels {
  width: number;
  height: number;
  rgba: Uint8Array<ArrayBuffer>;
}

export interface Warp {
  width: number;
  height: number;
  /** u, v, status and whether there is an answer; row 0 at the top. */
  pixels: Float32Array<ArrayBuffer>;
}

/** What is worked out only while it is shown. */
export const LAYERS = ["brightness", "stray"] as const;
export type Layer = (typeof LAYERS)[number];
export type Seen = "compensated" | "uncompensated" | "reference" | Layer;

export type Reply =
  | { kind: "ready"; schema: Schema; catalogue: Catalogue }
  | { kind: "scene"; text: string; layout: Layout; drawn: Drawn[]; rays: RayLines; values: Record<string, Value>; live: boolean }
  | { kind: "map"; warp: Warp; counts: Counts; bound: number; coarse: boolean; time: number }
  | { kind: "view"; seen: Seen; view: Pixels; live: boolean }
  | { kind: "check"; check: Check }
  | { kind: "picture"; picture: Pixels; name: string }
  | { kind: "taken"; files: NamedBytes[] }
  | { kind: "source"; display: Pixels; pitch: [number, number] }
  | { kind: "perspective"; svg: string }
  /** A picture that the browser does not decode. */
  | { kind: "unread"; name: string }
  | { kind: "fault"; fault: Fault }
  | { kind: "crashed"; why: string }
  | { kind: "done" };

export type Asked = Request & { id: number };
export type Told = Reply & { id: number };
