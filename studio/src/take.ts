// Files on their way to the person's disk.

import type { NamedBytes } from "./core/protocol.js";

/** Hands files over one after another: a browser takes one download at a time. */
export async function download(files: NamedBytes[]) {
  for (const [index, file] of files.entries()) {
    if (index > 0) await new Promise((resolve) => setTimeout(resolve, 300));
    const address = URL.createObjectURL(new Blob([file.bytes as Uint8Array<ArrayBuffer>]));
    const link = document.createElement("a");
    link.href = address;
    link.download = file.name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(address), 30_000);
  }
}
