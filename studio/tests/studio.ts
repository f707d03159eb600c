// What the tests share: a page that is watched for errors and for requests to other hosts, and a person's ways of using it.

import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { expect, test as base, type Locator, type Page } from "@playwright/test";

export const ROOT = fileURLToPath(new URL("../../", import.meta.url));
export const PROGRAM = process.env["MIDAIR"] ?? `${ROOT}target/debug/midair`;

export interface Watched {
  errors: string[];
  foreign: string[];
}

export function watch(page: Page, watched: Watched) {
  page.on("console", (message) => message.type() === "error" && watched.errors.push(message.text()));
  page.on("pageerror", (error) => watched.errors.push(String(error)));
  page.on("request", (request) => {
    const url = request.url();
    if (!url.startsWith("http://127.0.0.1:8474/") && !url.startsWith("blob:http://127.0.0.1:8474/")) watched.foreign.push(url);
  });
}

/** Each test's page: none may log an error, break its policy (which logs one) or ask another host. */
export const test = base.extend<{ watched: Watched }>({
  watched: [async ({ page }, use) => {
    const watched: Watched = { errors: [], foreign: [] };
    watch(page, watched);
    await use(watched);
    expect(watched.errors).toEqual([]);
    expect(watched.foreign).toEqual([]);
  }, { auto: true }],
});

export { expect };

/** Opens the studio and waits until all has been worked out. */
export async function open(page: Page, fragment = "") {
  await page.goto(`/${fragment}`);
  await settled(page);
}

/** Until the whole map is there and the findings are. */
export async function settled(page: Page) {
  await expect(page.locator("#figures")).toHaveText(/error at most|以下/);
  await expect(page.locator("#findings li").first()).toBeVisible();
}

export const sceneText = (page: Page) => page.locator("#text").inputValue();

export async function useText(page: Page, text: string) {
  if (!(await page.locator("#text").isVisible())) await page.locator("#text-details summary").click();
  await page.locator("#text").fill(text);
  await page.locator("#read-text").click();
}

export async function select(page: Page, name: string) {
  await page.locator("#parts [role=option]", { hasText: name }).first().click();
}

/** Mean and variance of a screenshot's grey values: a blank canvas has no variance. */
export async function greys(page: Page, part: Locator): Promise<{ mean: number; variance: number }> {
  const png = (await part.screenshot()).toString("base64");
  const bare = await page.context().newPage();
  const found = await bare.evaluate(async (png) => {
    const bytes = Uint8Array.from(atob(png), (c) => c.charCodeAt(0));
    const bitmap = await createImageBitmap(new Blob([bytes]));
    const canvas = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d")!;
    canvas.drawImage(bitmap, 0, 0);
    const { data } = canvas.getImageData(0, 0, bitmap.width, bitmap.height);
    let [sum, squares] = [0, 0];
    for (let at = 0; at < data.length; at += 4) {
      const grey = (data[at]! + data[at + 1]! + data[at + 2]!) / 3;
      sum += grey;
      squares += grey * grey;
    }
    const count = data.length / 4;
    return { mean: sum / count, variance: squares / count - (sum / count) ** 2 };
  }, png);
  await bare.close();
  return found;
}

/** The pixels of the view that is shown. */
export async function view(page: Page, which: string): Promise<number[]> {
  await page.locator(`[data-seen=${which}]`).click();
  return page.locator("#view").evaluate((canvas: HTMLCanvasElement) => {
    const { width, height } = canvas;
    return Array.from(canvas.getContext("2d")!.getImageData(0, 0, width, height).data);
  });
}

/** Root of the mean square difference of two views, in codes. */
export function apart(a: number[], b: number[]): number {
  expect(a.length).toBe(b.length);
  return Math.sqrt(a.reduce((sum, value, at) => sum + (value - b[at]!) ** 2, 0) / a.length);
}

export function run(folder: string, ...words: string[]): string {
  return execFileSync(PROGRAM, words, { cwd: folder, encoding: "utf8" });
}

export const scene = (name: string) => readFileSync(`${ROOT}scenes/${name}`, "utf8");

/** A NumPy array of 64-bit floats or bytes. */
export function npy(file: string): { shape: number[]; numbers: Float64Array | Uint8Array } {
  const bytes = readFileSync(file);
  const length = bytes.readUInt16LE(8);
  const header = bytes.toString("latin1", 10, 10 + length);
  const shape = /'shape': \(([\d, ]*)\)/.exec(header)![1]!.split(",").filter((part) => part.trim()).map(Number);
  const data = bytes.subarray(10 + length);
  const copy = data.buffer.slice(data.byteOffset, data.byteOffset + data.byteLength);
  return { shape, numbers: header.includes("'<f8'") ? new Float64Array(copy) : new Uint8Array(copy) };
}
