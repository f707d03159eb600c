// The scene's texts, one after another: undo is a list of texts.

export class History {
  readonly #texts: string[] = [];
  #at = -1;

  /** The newest text; what was undone before it is forgotten. */
  push(text: string) {
    if (this.#texts[this.#at] === text) return;
    this.#texts.splice(this.#at + 1);
    this.#texts.push(text);
    // A thousand texts are a few megabytes, and more than anybody undoes.
    if (this.#texts.length > 1000) this.#texts.shift();
    this.#at = this.#texts.length - 1;
  }

  get now(): string | undefined {
    return this.#texts[this.#at];
  }

  get canUndo(): boolean {
    return this.#at > 0;
  }

  get canRedo(): boolean {
    return this.#at < this.#texts.length - 1;
  }

  undo(): string | undefined {
    if (this.canUndo) this.#at--;
    return this.now;
  }

  redo(): string | undefined {
    if (this.canRedo) this.#at++;
    return this.now;
  }
}
