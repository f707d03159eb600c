import { defineConfig } from "@playwright/test";

// The program serves the page; the browser is Debian's, with WebGL in software.
const program = process.env["MIDAIR"] ?? "../target/debug/midair";
const at = "http://127.0.0.1:8474/";

export default defineConfig({
  testDir: "tests",
  outputDir: "test-results",
  workers: 1,
  timeout: 240_000,
  expect: { timeout: 40_000 },
  reporter: "./tests/reporter.ts",
  webServer: { command: `${program} studio --no-browser --port 8474 --page ../target/studio`, url: at, reuseExistingServer: false },
  use: {
    baseURL: at,
    // Each pixel is drawn by the processor; pictures for the book are larger.
    viewport: process.env["PICTURES"] ? { width: 1500, height: 900 } : { width: 1200, height: 720 },
    launchOptions: {
      executablePath: process.env["CHROMIUM"] ?? "/usr/bin/chromium",
      args: ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--no-sandbox"],
    },
  },
});
