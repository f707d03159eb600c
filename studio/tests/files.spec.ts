import { execFileSync } from "node:child_process";
import { mkdtempSync, openSync, readFileSync, statSync, truncateSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { expect, greys, npy, open, ROOT, run, scene, sceneText, settled, test, useText, watch } from "./studio.js";

const folder = mkdtempSync(join(tmpdir(), "midair-studio-"));

test("the map that is taken away is the program's", async ({ page }) => {
  for (const [name, file] of [["ball", "ball.toml"], ["cube", "paper/cube.toml"]] as const) {
    await open(page);
    await useText(page, scene(file));
    await expect(page.locator("#parts [role=option]", { hasText: name })).toBeVisible();
    await settled(page);
    await page.locator("#format").selectOption("npy");
    const saved: Record<string, string> = {};
    const both = new Promise<void>((resolve) => page.on("download", async (download) => {
      const path = join(folder, `${name}-${download.suggestedFilename()}`);
      await download.saveAs(path);
      saved[download.suggestedFilename()] = path;
      if (saved["map.npy"] && saved["status.npy"]) resolve();
    }));
    await page.locator("[data-take=map]").click();
    await both;
    run(folder, "compensate", join(ROOT, "scenes", file), "--format", "npy", "--out", name);
    const [ours, theirs] = [npy(saved["map.npy"]!), npy(join(folder, name, "map.npy"))];
    expect(ours.shape).toEqual(theirs.shape);
    let [largest, compared, apart] = [0, 0, 0];
    for (let at = 0; at < ours.numbers.length; at++) {
      const [a, b] = [ours.numbers[at]!, theirs.numbers[at]!];
      if (Number.isNaN(a) !== Number.isNaN(b)) apart++;
      if (Number.isNaN(a)) continue;
      compared++;
      largest = Math.max(largest, Math.abs(a - b));
    }
    expect(apart).toBe(0);
    expect(compared).toBeGreaterThan(ours.numbers.length / 4);
    console.log(`${name}: the page's map and the program's differ by ${largest.toExponential(1)} at most`);
    expect(largest).toBeLessThanOrEqual(1e-6);
    const [own, other] = [npy(saved["status.npy"]!), npy(join(folder, name, "status.npy"))];
    expect(Buffer.from(own.numbers).equals(Buffer.from(other.numbers))).toBe(true);
    page.removeAllListeners("download");
  }
});

test("everything can be taken away", async ({ page }) => {
  await open(page);
  await page.locator("#text-details summary").click();
  await useText(page, scene("ball.toml").replace("resolution = [1024, 1024]", "resolution = [64, 64]"));
  await expect(page.locator("#figures")).toHaveText(/^64 × 64/);
  await settled(page);
  const take = async (what: string) => {
    const [download] = await Promise.all([page.waitForEvent("download"), page.locator(`[data-take=${what}]`).click()]);
    return { name: download.suggestedFilename(), bytes: readFileSync((await download.path())!) };
  };
  expect((await take("scene")).bytes.toString()).toBe(await sceneText(page));
  expect((await take("display")).bytes.subarray(1, 4).toString()).toBe("PNG");
  expect((await take("drawing")).bytes.toString()).toContain("<svg");
  expect(JSON.parse((await take("report")).bytes.toString()).image.formed).toBeGreaterThan(0.5);
  const formats = await page.locator("#format option").allTextContents();
  expect(formats.length).toBeGreaterThan(10);
  for (const format of formats) {
    await page.locator("#format").selectOption(format);
    expect((await take("map")).bytes.length, format).toBeGreaterThan(100);
    // Formats of several files: the others follow.
    await page.waitForTimeout(700);
  }
});

test("a link holds the scene, and a broken one is refused", async ({ page, context, watched }) => {
  await open(page);
  await useText(page, scene("paper/cylinder.toml"));
  await expect(page.locator("#parts [role=option]", { hasText: "cylinder" })).toBeVisible();
  await page.locator("#link").click();
  await expect(page.locator("#told")).toHaveText(/whole scene/);
  const link = page.url();
  const other = await context.newPage();
  watch(other, watched);
  await other.goto(link);
  await settled(other);
  expect(await sceneText(other)).toBe(scene("paper/cylinder.toml"));
  for (const broken of ["#1=", "#1=AAAA", "#2=abc", `#1=${"A".repeat(5000)}`, link.slice(link.indexOf("#"), -20)]) {
    await other.goto(`/${broken}`);
    await other.reload();
    await expect(other.locator("#message")).toBeVisible();
    await expect(other.locator("#parts [role=option]", { hasText: "ball" })).toBeVisible();
  }
  await other.close();
});

test("meshes are dropped: good, broken, and far too large", async ({ page }) => {
  await open(page);
  const good = join(folder, "cow.obj");
  writeFileSync(good, readFileSync(join(ROOT, "scenes/meshes/spot.obj")));
  const large = join(folder, "large.stl");
  openSync(large, "w");
  truncateSync(large, 100e6);
  expect(statSync(large).size).toBe(100e6);
  const broken = join(folder, "broken.obj");
  writeFileSync(broken, "v 1 2\nf 1 2 9\nnonsense");

  const before = await sceneText(page);
  await page.locator("#file").setInputFiles(broken);
  await expect(page.locator("#message-text")).toHaveText(/broken\.obj/);
  expect(await sceneText(page)).toBe(before);
  await page.locator("#file").setInputFiles(large);
  await expect(page.locator("#message-text")).toHaveText(/large\.stl/);
  expect(await sceneText(page)).toBe(before);
  await page.locator("#file").setInputFiles(good);
  await expect.poll(() => sceneText(page)).toContain('file = "cow.obj"');
  await expect(page.locator("#message")).toBeHidden();
  await settled(page);

  // The gallery's cow comes with its mesh, and answers in time.
  await page.locator("#gallery-button").click();
  await page.locator("[data-scene='spot.toml']").click();
  await expect(page.locator("#parts [role=option]", { hasText: "spot" })).toBeVisible();
  await settled(page);
  console.log(`a mesh of 5,856 triangles: the whole map in ${await page.locator("#figures").getAttribute("data-time")} ms`);
});

test("pictures and films are one's own, and broken ones are refused", async ({ page }) => {
  await open(page);
  const broken = join(folder, "broken.png");
  writeFileSync(broken, "\x89PNG\r\n\x1a\n\0\0", "latin1");
  await page.locator("#file").setInputFiles(broken);
  await expect(page.locator("#message-text")).toHaveText(/./);
  await page.locator("#message-close").click();
  const odd = join(folder, "odd.xyz");
  writeFileSync(odd, "x");
  await page.locator("#file").setInputFiles(odd);
  await expect(page.locator("#message-text")).toHaveText(/odd\.xyz/);

  const picture = join(folder, "white.png");
  execFileSync("ffmpeg", ["-loglevel", "error", "-y", "-f", "lavfi", "-i", "color=white:s=64x64", "-frames:v", "1", picture]);
  await page.locator("#file").setInputFiles(picture);
  await expect.poll(async () => (await greys(page, page.locator("#view"))).mean).toBeGreaterThan(200);

  const film = join(folder, "film.webm");
  execFileSync("ffmpeg", ["-loglevel", "error", "-y", "-f", "lavfi", "-i", "testsrc2=s=1920x1080:r=30:d=2", "-c:v", "libvpx", "-deadline", "realtime", "-b:v", "4M", film]);
  await page.locator("#file").setInputFiles(film);
  await expect(page.locator("#warp")).toBeVisible();
  const drawn = () => page.evaluate(() => ({ ...(window as unknown as { midair: { film: { frames: number; time: number } } }).midair.film, now: performance.now() }));
  await expect.poll(async () => (await drawn()).frames).toBeGreaterThan(5);
  const first = await drawn();
  await page.waitForTimeout(2000);
  await expect.poll(async () => (await drawn()).frames).toBeGreaterThan(first.frames + 3);
  const last = await drawn();
  const rate = (1000 * (last.frames - first.frames)) / (last.now - first.now);
  console.log(`film, 1920 x 1080, graphics in software: ${rate.toFixed(1)} frames/s, ${((last.time - first.time) / (last.frames - first.frames)).toFixed(1)} ms a frame on the page's thread`);
  expect((await greys(page, page.locator("#warp"))).variance).toBeGreaterThan(300);
});

test("all scenes of the gallery open", async ({ page }) => {
  await open(page);
  const files = await page.locator("#examples [data-scene]").evaluateAll((buttons) => buttons.map((button) => (button as HTMLElement).dataset["scene"]!));
  expect(files.length).toBeGreaterThan(10);
  for (const file of files) {
    await page.locator("#gallery-button").click();
    await page.locator(`[data-scene='${file}']`).click();
    await expect.poll(() => sceneText(page), file).toBe(scene(file));
    await settled(page);
    await expect(page.locator("#message")).toBeHidden();
  }
});
