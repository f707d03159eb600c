import { apart, expect, open, scene, sceneText, select, settled, test, useText, view } from "./studio.js";

test("a part is dragged, and all follows within the time that is promised", async ({ page }) => {
  await open(page);
  await page.evaluate(() => {
    const long: number[] = [];
    new PerformanceObserver((list) => long.push(...list.getEntries().map((entry) => entry.duration))).observe({ type: "longtask" });
    Object.assign(window, { long });
  });
  await select(page, "ball");
  const grip = () => page.evaluate(() => (window as unknown as { midair: { grip(axis: "x"): { x: number; y: number } } }).midair.grip("x"));
  await expect.poll(async () => (await grip()).x).toBeGreaterThan(0);
  await page.waitForTimeout(200);
  const from = await grip();
  await page.mouse.move(from.x, from.y);
  await page.waitForTimeout(100);
  await page.mouse.down();
  for (let step = 1; step <= 40; step++) {
    await page.mouse.move(from.x + step, from.y);
    await page.waitForTimeout(40);
  }
  await page.mouse.up();
  await expect.poll(() => sceneText(page)).toMatch(/position = \[/);
  await settled(page);
  const text = await sceneText(page);
  const position = /name = "ball"[\s\S]*?position = \[([^\]]*)\]/.exec(text)![1]!.split(",").map(Number);
  expect(Math.abs(position[0]!)).toBeGreaterThan(1);
  expect(position.slice(1).map((c) => Math.abs(c))).toEqual([0, 0]);

  const [times, long] = await page.evaluate(() => [
    performance.getEntriesByName("drag").map((entry) => entry.duration).sort((a, b) => a - b),
    (window as unknown as { long: number[] }).long,
  ]);
  const at = (share: number) => times[Math.min(times.length - 1, Math.floor(share * times.length))]!;
  console.log(`${times.length} answers to a drag: median ${at(0.5).toFixed(0)} ms, 95th percentile ${at(0.95).toFixed(0)} ms; long tasks: ${long.map((time) => time.toFixed(0)).join(", ") || "none"}`);
  // It followed the hand, not its last place alone.
  expect(times.length).toBeGreaterThan(1);
  await page.locator("#undo").click();
  await expect.poll(() => sceneText(page)).toBe(scene("ball.toml"));
});

test("a number is typed, undone and done again", async ({ page }) => {
  await open(page);
  await select(page, "ball");
  const radius = page.locator("[id='f-element.0.shape.radius']");
  await expect(radius).toHaveValue("25");
  await radius.fill("30");
  await radius.press("Tab");
  await expect.poll(() => sceneText(page)).toContain("radius = 30");
  await expect(radius).toHaveValue("30");
  await page.locator("#undo").click();
  await expect(radius).toHaveValue("25");
  await page.locator("#redo").click();
  await expect(radius).toHaveValue("30");
  // What no set-up can be is refused, and what was there stays.
  await radius.fill("-3");
  await radius.press("Tab");
  await expect(page.locator("#message")).toBeVisible();
  await expect(radius).toHaveValue("30");
});

test("parts come and go, shapes and materials are exchanged", async ({ page }) => {
  await open(page);
  const kinds = await page.locator("#add option").evaluateAll((options) => options.map((option) => (option as HTMLOptionElement).value).filter(Boolean));
  const schema = await page.locator("#add option").count();
  expect(schema).toBe(15);
  // Alone: two solids in one another are a finding, no fault, but mirrors within them would be.
  await select(page, "ball");
  await page.locator("#remove").click();
  await expect.poll(() => sceneText(page)).not.toContain("[[element]]");
  for (const kind of kinds) {
    await page.locator("#add").selectOption(kind);
    await expect.poll(() => sceneText(page), kind).toContain(`kind = "${kind}"`);
    await expect(page.locator("#message")).toBeHidden();
    await page.locator("#undo").click();
    await expect.poll(() => sceneText(page)).not.toContain("[[element]]");
  }
  await page.locator("#add").selectOption("cylinder");
  await expect.poll(() => sceneText(page)).toContain("cylinder");
  await select(page, "cylinder");
  await page.locator("[id='f-element.0.shape.kind']").selectOption("box");
  await expect.poll(() => sceneText(page)).toContain('kind = "box"');
  await page.locator("[id='f-element.0.material.which']").selectOption("glass");
  await expect.poll(() => sceneText(page)).toContain('glass = "N-BK7"');
  expect(await sceneText(page)).not.toContain("ior");
  await page.locator("#duplicate").click();
  await expect(page.locator("#parts [role=option]", { hasText: "cylinder 2" })).toBeVisible();
});

test("the eye moves: with the compensation, or away from it", async ({ page }) => {
  await open(page);
  const reference = await view(page, "reference");
  const home = apart(await view(page, "compensated"), reference);
  await select(page, "Viewer's eye");
  await page.locator("#follow").uncheck();
  await settled(page);
  const before = await view(page, "compensated");
  await page.locator("#space").focus();
  for (let step = 0; step < 4; step++) await page.keyboard.press("Shift+ArrowRight");
  await expect.poll(async () => apart(await view(page, "compensated"), before)).toBeGreaterThan(3);
  expect(await sceneText(page)).toBe(scene("ball.toml"));
  expect(apart(await view(page, "compensated"), reference)).toBeGreaterThan(home);
  await page.locator("#follow").check();
  await settled(page);
  await page.locator("#space").focus();
  await page.keyboard.press("Shift+ArrowRight");
  await expect.poll(() => sceneText(page)).toContain("position = [10.0, 0.0, 800.0]");
});

test("what is wrong is said with its line, and the scene stays", async ({ page }) => {
  await open(page);
  const good = await sceneText(page);
  for (const [text, words] of [
    [good.replace("radius = 25.0", "radius = 1e9"), /Line 24.*radius/s],
    [good.replace("size = [28.0, 28.0]", "sise = [28.0, 28.0]"), /Line \d+.*sise/s],
    ["\u0000\u0001 hostile [[[[", /Line 1/],
    ["a = [".repeat(20_000), /./],
    ["", /./],
  ] as const) {
    await useText(page, text);
    await expect(page.locator("#message")).toBeVisible();
    await expect(page.locator("#message-text")).toHaveText(words);
    await page.locator("#message-close").click();
    await expect(page.locator("#parts [role=option]", { hasText: "ball" })).toBeVisible();
  }
  await useText(page, good);
  await settled(page);
});

test("a finding's remedy is a button", async ({ page }) => {
  await open(page);
  await useText(page, (await sceneText(page)).replace("size = [36.5, 36.5]", "size = [20.0, 20.0]"));
  await expect(page.locator("#formed")).not.toHaveText(/100 %/);
  const before = await page.locator("#formed").textContent();
  await page.locator("#findings button").first().click();
  await expect(page.locator("#formed")).not.toHaveText(before!);
  await expect(page.locator("#message")).toBeHidden();
});
