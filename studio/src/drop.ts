// Files of one's own, by drop or by dialog: scenes, meshes, pictures, films.

import type { NamedBytes } from "./core/protocol.js";
import { by, complain, onClick } from "./page.js";
import { word } from "./words.js";

/** What is larger would leave the browser's memory no room for the work. */
const MOST_MB = { mesh: 64, picture: 64, scene: 4 };

const MESHES = /\.(obj|stl|ply|off|gltf|glb)$/i;
const PICTURES = /\.(png|jpe?g|webp|bmp|gif|avif)$/i;
const SCENES = /\.(toml|json)$/i;
const FILMS = /\.(mp4|webm|mov|m4v|ogv)$/i;

export interface Dropped {
  scene(file: NamedBytes, beside: NamedBytes[]): void;
  mesh(file: NamedBytes): void;
  picture(file: NamedBytes): void;
  film(file: File): void;
}

async function read(file: File, kind: keyof typeof MOST_MB): Promise<NamedBytes | null> {
  const most = MOST_MB[kind];
  if (file.size > most * 1e6) {
    complain(word("tooLarge", { name: file.name, most }), word("tooLargeRemedy"));
    return null;
  }
  return { name: file.name, bytes: new Uint8Array(await file.arrayBuffer()) };
}

async function take(files: File[], to: Dropped) {
  const scene = files.find((file) => SCENES.test(file.name));
  const meshes: NamedBytes[] = [];
  for (const file of files.filter((file) => MESHES.test(file.name))) {
    const found = await read(file, "mesh");
    if (!found) return;
    meshes.push(found);
  }
  if (scene) {
    const found = await read(scene, "scene");
    if (found) to.scene(found, meshes);
    return;
  }
  for (const mesh of meshes) to.mesh(mesh);
  if (meshes.length > 0) return;
  const film = files.find((file) => FILMS.test(file.name) || file.type.startsWith("video/"));
  if (film) return to.film(film);
  const picture = files.find((file) => PICTURES.test(file.name));
  if (picture) {
    const found = await read(picture, "picture");
    if (found) to.picture(found);
    return;
  }
  if (files[0]) complain(word("unknownFile", { name: files[0].name }), word("unknownFileRemedy"));
}

export function takeFiles(to: Dropped) {
  const input = by<HTMLInputElement>("file");
  for (const button of ["open-button", "picture-button"]) onClick(button, () => input.click());
  input.addEventListener("change", () => {
    const files = [...(input.files ?? [])];
    input.value = "";
    void take(files, to);
  });
  document.addEventListener("dragover", (event) => {
    event.preventDefault();
    document.body.classList.add("dropping");
  });
  document.addEventListener("dragleave", (event) => {
    if (!event.relatedTarget) document.body.classList.remove("dropping");
  });
  document.addEventListener("drop", (event) => {
    event.preventDefault();
    document.body.classList.remove("dropping");
    void take([...(event.dataTransfer?.files ?? [])], to);
  });
}
