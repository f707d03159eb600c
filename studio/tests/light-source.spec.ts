import { expect, greys, test } from "./studio.js";

// A tablet, lying.
test.use({ viewport: { width: 1180, height: 820 }, hasTouch: true, deviceScaleFactor: 2 });

test("a tablet is the light source: true size, nudged by touch", async ({ page }) => {
  await page.goto("/source.html");
  // The ball's display is 36.5 mm wide.
  await expect(page.locator("#sized")).toHaveText(/36\.5 × 36\.5 mm/);
  await page.locator("#device").selectOption("ipad-10.9");
  const canvas = page.locator("#light");
  const width = async () => (await canvas.boundingBox())!.width;
  // 264 pixels in an inch, two of them in each of the page's.
  const expected = (36.5 * 264) / 25.4 / 2;
  await expect.poll(width).toBeCloseTo(expected, 0);
  expect((await greys(page, page.locator("#stage"))).variance).toBeGreaterThan(100);

  const place = async () => (await canvas.boundingBox())!.x;
  const before = await place();
  await page.mouse.move(300, 300);
  await page.mouse.down();
  await page.mouse.move(350, 300, { steps: 5 });
  await page.mouse.up();
  await expect.poll(place).toBeCloseTo(before + 50, 0);
  await page.locator("#stage").focus();
  await page.keyboard.press("Shift+ArrowRight");
  // A millimetre.
  await expect.poll(place).toBeCloseTo(before + 50 + 264 / 25.4 / 2, 0);

  await page.locator("summary").click();
  await page.locator("#length").fill("428");
  // The bar is the card then: 428 of the page's pixels are 85.6 mm.
  await expect.poll(width).toBeCloseTo((36.5 * 428) / 85.6, 0);
  await page.mouse.click(300, 200);
  await expect(page.locator("#controls")).toBeHidden();
  await page.screenshot({ path: "test-results/source.png" });
});
