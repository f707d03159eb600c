import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";
import { defineConfig, type Plugin } from "vite";

/** The files of the page, and a worker that keeps them for when there is no network. */
function offline(): Plugin {
  return {
    name: "midair-offline",
    // After Vite's own, which adds the pages.
    generateBundle: { order: "post", handler(_, bundle) {
      const names = Object.keys(bundle).sort();
      const hash = createHash("sha256");
      for (const name of names) {
        const file = bundle[name]!;
        hash.update(name).update(file.type === "chunk" ? file.code : file.source);
      }
      // Meshes of the gallery are kept once they have been asked for.
      const kept = names.filter((name) => !name.endsWith(".obj"));
      const lists = { version: hash.digest("hex").slice(0, 12), files: ["./", "icon.svg", ...kept] };
      const template = readFileSync(new URL("src/offline/keeper.js", import.meta.url), "utf8");
      const source = template.replace("/* LISTS */ { version: \"\", files: [] }", JSON.stringify(lists));
      this.emitFile({ type: "asset", fileName: "keeper.js", source });
    } },
  };
}

export default defineConfig({
  base: "./",
  build: {
    outDir: "../target/studio",
    emptyOutDir: true,
    target: "es2022",
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 4000,
    rollupOptions: { input: { index: "index.html", source: "source.html" } },
  },
  worker: { format: "es" },
  server: { fs: { allow: [".."] } },
  plugins: [offline()],
});
