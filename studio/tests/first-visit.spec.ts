import { readFileSync } from "node:fs";
import { apart, expect, greys, open, settled, test, view } from "./studio.js";

test("the first visit shows the ball compensated, without a click", async ({ page }) => {
  const start = Date.now();
  await page.goto("/");
  await expect(page.locator("#figures")).toHaveText(/pixels/);
  const interactive = Date.now() - start;
  await settled(page);
  console.log(`cold load to the first answer: ${interactive} ms; the whole map: ${await page.locator("#figures").getAttribute("data-time")} ms`);
  const compensated = await view(page, "compensated");
  const reference = await view(page, "reference");
  const uncompensated = await view(page, "uncompensated");
  // The ball's is the paper's case: compensated views differ from the reference by resampling only, uncompensated ones by millimetres.
  expect(apart(compensated, reference)).toBeLessThan(0.35 * apart(uncompensated, reference));
  await page.locator("[data-seen=compensated]").click();
  // A blank canvas, as of a browser without graphics, has no variance at all.
  expect((await greys(page, page.locator("#space"))).variance).toBeGreaterThan(50);
  expect((await greys(page, page.locator("#view"))).variance).toBeGreaterThan(500);
  const folder = process.env["PICTURES"] ?? "test-results";
  await page.screenshot({ path: `${folder}/studio.png` });
});

test("brightness and stray light are layers of what is seen", async ({ page }) => {
  await open(page);
  await settled(page);
  const layer = async (which: string) => {
    await page.locator(`[data-seen=${which}]`).click();
    await expect.poll(() => page.locator("#view").evaluate((canvas: HTMLCanvasElement) => canvas.width)).toBe(192);
    const pixels = await view(page, which);
    return (x: number, y: number) => pixels.slice(4 * (192 * y + x), 4 * (192 * y + x) + 3);
  };
  // Towards a ball's outline less light passes (Fresnel): the middle is the brightest, the corners are the dimmest.
  const bright = await layer("brightness");
  for (const [x, y] of [[0, 0], [191, 0], [0, 191], [191, 191]] as const) expect(bright(96, 96)[0]! - bright(x, y)[0]!).toBeGreaterThan(50);
  expect(bright(96, 96)[0]).toBeGreaterThan(250);
  // A quarter of the layer's width is the image, which has no colour where no stray light lies over it; beyond there are the stray images alone.
  const stray = await layer("stray");
  expect(Math.min(...stray(96, 96))).toBeGreaterThan(0);
  let coloured = 0;
  for (let y = 0; y < 192; y++) for (let x = 0; x < 192; x++) coloured += Number(new Set(stray(x, y)).size > 1);
  expect(coloured).toBeGreaterThan(20);
  await page.locator("[data-seen=compensated]").click();
  await expect.poll(() => page.locator("#view").evaluate((canvas: HTMLCanvasElement) => canvas.width)).toBe(384);
});

test("the display image is drawn live", async ({ page }) => {
  await open(page);
  await page.locator("[data-seen=display]").click();
  await expect(page.locator("#warp")).toBeVisible();
  await page.waitForTimeout(300);
  expect((await greys(page, page.locator("#warp"))).variance).toBeGreaterThan(500);
});

test("it opens without a network after the first load", async ({ page, context }) => {
  await open(page);
  await page.evaluate(() => navigator.serviceWorker.ready.then(() => undefined));
  await expect.poll(() => page.evaluate(() => navigator.serviceWorker.controller !== null)).toBe(true);
  await context.setOffline(true);
  await page.reload();
  await settled(page);
  await page.goto("/source.html");
  await expect(page.locator("#sized")).toHaveText(/mm/);
  await context.setOffline(false);
});

test("nobody is left out: names, roles and contrasts, in both languages", async ({ page }) => {
  const axe = readFileSync(new URL("../node_modules/axe-core/axe.min.js", import.meta.url), "utf8");
  const check = async (where: string) => {
    await page.evaluate(axe);
    const found = await page.evaluate(async () => {
      const { violations } = await (window as unknown as { axe: { run(): Promise<{ violations: { id: string; nodes: { html: string }[] }[] }> } }).axe.run();
      return violations.map((violation) => `${violation.id}: ${violation.nodes.map((node) => node.html).slice(0, 3).join(" ")}`);
    });
    expect(found, where).toEqual([]);
  };
  await open(page);
  await check("the first page");
  await page.locator("#language").click();
  await expect(page.locator("#setup-title")).toHaveText("構成");
  await check("in Japanese");
  await page.locator("#parts").focus();
  for (let step = 0; step < 4; step++) await page.keyboard.press("ArrowDown");
  await expect(page.locator("#panel legend").first()).toBeVisible();
  await check("an element's properties");
  await page.locator("#gallery-button").click();
  await expect(page.locator("#examples svg").last()).toBeVisible({ timeout: 40_000 });
  await check("the gallery");
  await page.goto("/source.html");
  await expect(page.locator("#sized")).toHaveText(/mm/);
  await check("the light source");
});
