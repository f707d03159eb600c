// What is seen: views as the core has found them, and the display image, drawn live.

import type { Pixels, Seen as SeenName, Warp } from "../core/protocol.js";
import { Film } from "./film.js";
import { Warper } from "./warp.js";

export type Shown = SeenName | "display";

export class Seen {
  readonly #views = new Map<SeenName, Pixels>();
  readonly #context: CanvasRenderingContext2D;
  #warper: Warper | undefined;
  #picture: ImageData | undefined;
  #film: Film | undefined;
  #warp: Warp | undefined;
  #shown: Shown = "compensated";
  /** Frames that were drawn of a film, and how long that took: for whoever asks. */
  readonly film = { frames: 0, time: 0 };

  constructor(
    private readonly view: HTMLCanvasElement,
    private readonly display: HTMLCanvasElement,
  ) {
    this.#context = view.getContext("2d", { alpha: false })!;
  }

  choose(shown: Shown) {
    this.#shown = shown;
    this.view.hidden = shown === "display";
    this.display.hidden = shown !== "display";
    if (shown === "display") this.#drawDisplay();
    else this.#drawView();
  }

  /** A view; a quick one replaces the compensated one only. */
  set(seen: SeenName, view: Pixels) {
    this.#views.set(seen, view);
    if (seen === this.#shown) this.#drawView();
  }

  #drawView() {
    const view = this.#shown === "display" ? undefined : this.#views.get(this.#shown);
    if (!view) return;
    if (this.view.width !== view.width || this.view.height !== view.height) {
      this.view.width = view.width;
      this.view.height = view.height;
    }
    this.#context.putImageData(new ImageData(new Uint8ClampedArray(view.rgba.buffer), view.width, view.height), 0, 0);
  }

  setMap(warp: Warp) {
    this.#warp = warp;
    this.#warper?.map(warp.width, warp.height, warp.pixels);
    if (this.#shown === "display") this.#drawDisplay();
  }

  /** The size of the display in pixels: as many of them as a canvas can have. */
  resize([width, height]: [number, number]) {
    const factor = Math.min(1, 2048 / Math.max(width, height));
    const size = [width, height].map((side) => Math.max(1, Math.round(side * factor)));
    if (this.display.width === size[0] && this.display.height === size[1]) return;
    [this.display.width, this.display.height] = size as [number, number];
    if (this.#shown === "display") this.#drawDisplay();
  }

  setPicture(picture: Pixels) {
    this.#film?.stop();
    this.#film = undefined;
    this.#picture = new ImageData(new Uint8ClampedArray(picture.rgba), picture.width, picture.height);
    this.#warper?.picture(this.#picture);
    if (this.#shown === "display") this.#drawDisplay();
  }

  /** A film in the place of the picture; false where the browser cannot play it. */
  async setFilm(file: File): Promise<boolean> {
    const film = new Film(file, (video) => {
      const start = performance.now();
      this.#start();
      this.#warper?.picture(video);
      this.#warper?.draw();
      this.film.frames++;
      this.film.time += performance.now() - start;
    });
    if (!(await film.play())) return false;
    this.#film?.stop();
    this.#film = film;
    return true;
  }

  /** The graphics are got when they are first needed. */
  #start() {
    if (this.#warper) return;
    this.#warper = new Warper(this.display);
    if (this.#warp) this.#warper.map(this.#warp.width, this.#warp.height, this.#warp.pixels);
    if (this.#picture) this.#warper.picture(this.#picture);
  }

  #drawDisplay() {
    this.#start();
    this.#warper?.draw();
  }
}
