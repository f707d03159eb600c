// The page's side of the core: requests go out, answers come in; a core that has ended is started anew.

import type { Asked, Edit, Reply, Request, Told } from "./protocol.js";
import type { Vector } from "../../core/midair_web.js";

type Listener = (reply: Reply, id: number) => void;

export class Core {
  #worker: Worker;
  #count = 0;
  /** The drag that is being answered, and the newest one that waits. */
  #dragging = 0;
  #next: Request | undefined;
  readonly #pending = new Map<number, (replies: Reply[]) => void>();
  readonly #replies = new Map<number, Reply[]>();

  constructor(private readonly listener: Listener) {
    this.#worker = this.#start();
  }

  #start(): Worker {
    const worker = new Worker(new URL("./worker.ts", import.meta.url), { type: "module", name: "core" });
    worker.onmessage = ({ data }: MessageEvent<Told>) => this.#receive(data);
    worker.onerror = (event) => {
      event.preventDefault();
      this.listener({ kind: "crashed", why: event.message }, 0);
    };
    return worker;
  }

  /** Another instance in the place of one that has ended. */
  restart() {
    this.#worker.terminate();
    this.#dragging = 0;
    this.#next = undefined;
    for (const resolve of this.#pending.values()) resolve([]);
    this.#pending.clear();
    this.#replies.clear();
    this.#worker = this.#start();
  }

  #receive(told: Told) {
    const { id, ...reply } = told;
    if (reply.kind !== "done") {
      this.#replies.get(id)?.push(reply as Reply);
      this.listener(reply as Reply, id);
      return;
    }
    this.#pending.get(id)?.(this.#replies.get(id) ?? []);
    this.#pending.delete(id);
    this.#replies.delete(id);
    if (id !== this.#dragging) return;
    performance.measure("drag", { start: `drag-${id}` });
    performance.clearMarks(`drag-${id}`);
    this.#dragging = 0;
    const next = this.#next;
    this.#next = undefined;
    if (next) this.#drag(next);
  }

  send(request: Request, transfer: Transferable[] = []): number {
    // What has been let go of is not to be followed by what was dragged before.
    if (request.kind === "change" || request.kind === "open") this.#next = undefined;
    const id = ++this.#count;
    this.#worker.postMessage({ ...request, id } satisfies Asked, transfer);
    return id;
  }

  /** All that is told of a request, once it is done. */
  ask(request: Request): Promise<Reply[]> {
    const id = this.send(request);
    this.#replies.set(id, []);
    return new Promise((resolve) => this.#pending.set(id, resolve));
  }

  /** Edits, or an eye, that follow a drag: one at a time, and of those that wait the newest. */
  drag(request: { edits: Edit[] } | { eye: Vector | null }) {
    const live: Request = "edits" in request
      ? { kind: "change", edits: request.edits, live: true }
      : { kind: "eye", eye: request.eye, live: true };
    if (this.#dragging) this.#next = live;
    else this.#drag(live);
  }

  #drag(request: Request) {
    this.#dragging = this.#count + 1;
    performance.mark(`drag-${this.#dragging}`);
    const id = ++this.#count;
    this.#worker.postMessage({ ...request, id } satisfies Asked);
  }
}
