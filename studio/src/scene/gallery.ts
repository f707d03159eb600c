// The example scenes, embedded when the page is built.

import type { NamedBytes } from "../core/protocol.js";

const texts = import.meta.glob<string>(["../../../scenes/*.toml", "../../../scenes/paper/*.toml"], {
  query: "?raw", import: "default", eager: true,
});
const meshes = import.meta.glob<string>("../../../scenes/meshes/*.obj", { query: "?url", import: "default", eager: true });

export interface Example {
  /** Its file, such as ball.toml. */
  file: string;
  name: string;
  /** Its first comment's first sentence. */
  about: string;
  text: string;
}

function described(path: string, text: string): Example {
  const file = path.replace(/^.*\/scenes\//, "");
  const name = /^name = "(.*)"$/m.exec(text)?.[1] ?? file;
  const comment = text.split("\n").filter((line, index, all) => line.startsWith("#") && all.slice(0, index).every((before) => before.startsWith("#")));
  const prose = comment.map((line) => line.replace(/^# ?/, "")).join(" ").trim();
  const about = /^.*?\.(?=\s|$)/.exec(prose)?.[0] ?? prose;
  return { file, name, about, text };
}

/** The bunny's mesh is not ours to give. */
const examples = Object.entries(texts).map(([path, text]) => described(path, text)).filter((example) => !example.text.includes("bunny.ply"));

export const GALLERY: Example[] = examples.sort((a, b) => a.file.localeCompare(b.file));

/** What is shown at the first visit. */
export const FIRST = GALLERY.find((example) => example.file === "ball.toml") ?? GALLERY[0]!;

/** The mesh files that a text names and the gallery has. */
export async function filesOf(text: string): Promise<NamedBytes[]> {
  const names = [...text.matchAll(/file\s*=\s*"([^"]*)"/g)].map((match) => match[1]!);
  const found: NamedBytes[] = [];
  for (const name of names) {
    const url = Object.entries(meshes).find(([path]) => path.endsWith(`/scenes/${name}`))?.[1];
    if (!url) continue;
    const response = await fetch(url);
    if (response.ok) found.push({ name, bytes: new Uint8Array(await response.arrayBuffer()) });
  }
  return found;
}
