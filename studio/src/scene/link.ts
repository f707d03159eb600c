// The scene in the link's fragment, which browsers never send: its text, deflated, in base64url. The number says how; old links always open.

const FIRST = "#1=";
/** A scene's text is bounded, so that a hostile link does not fill the memory. */
const MOST_BYTES = 4 << 20;

export async function toFragment(text: string): Promise<string> {
  const packed = new Blob([text]).stream().pipeThrough(new CompressionStream("deflate-raw"));
  const bytes = new Uint8Array(await new Response(packed).arrayBuffer());
  let binary = "";
  for (const byte of bytes) binary += String.fromCharCode(byte);
  return FIRST + btoa(binary).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
}

/** The text of a fragment; null where it holds none. */
export async function fromFragment(fragment: string): Promise<string | null> {
  if (!fragment.startsWith(FIRST)) return null;
  try {
    const binary = atob(fragment.slice(FIRST.length).replaceAll("-", "+").replaceAll("_", "/"));
    const bytes = Uint8Array.from(binary, (c) => c.charCodeAt(0));
    const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw")).getReader();
    const parts: Uint8Array<ArrayBuffer>[] = [];
    let size = 0;
    for (;;) {
      const { done, value } = await reader.read();
      if (done) break;
      size += value.byteLength;
      if (size > MOST_BYTES) {
        await reader.cancel();
        return null;
      }
      parts.push(value);
    }
    return new TextDecoder("utf-8", { fatal: true }).decode(await new Blob(parts).arrayBuffer());
  } catch {
    // Cut short or garbled: there is no scene in it.
    return null;
  }
}
