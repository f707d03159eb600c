// A film of one's own, frame by frame.

export class Film {
  readonly #video = document.createElement("video");
  readonly #address: string;
  #stopped = false;

  constructor(file: Blob, private readonly frame: (video: HTMLVideoElement) => void) {
    this.#address = URL.createObjectURL(file);
    this.#video.muted = true;
    this.#video.loop = true;
    this.#video.playsInline = true;
    this.#video.src = this.#address;
  }

  async play(): Promise<boolean> {
    try {
      await this.#video.play();
    } catch {
      // No film, or none that this browser decodes.
      this.stop();
      return false;
    }
    this.#next();
    return true;
  }

  #next() {
    if (this.#stopped) return;
    this.#video.requestVideoFrameCallback(() => {
      if (this.#stopped) return;
      this.frame(this.#video);
      this.#next();
    });
  }

  stop() {
    this.#stopped = true;
    this.#video.pause();
    this.#video.removeAttribute("src");
    URL.revokeObjectURL(this.#address);
  }
}
