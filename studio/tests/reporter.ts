// A line for each test, as `cargo xtask test` counts them.

import type { FullResult, Reporter, TestCase, TestResult } from "@playwright/test/reporter";

export default class Lines implements Reporter {
  onTestEnd(test: TestCase, result: TestResult) {
    const passed = result.status === "passed";
    console.log(`${passed ? "ok" : "not ok"} ${test.title} (${(result.duration / 1000).toFixed(1)} s)`);
    for (const line of result.stdout) process.stdout.write(`  ${line}`);
    for (const error of result.errors) console.log(error.message ?? error.value);
  }

  onStdErr(text: string | Buffer) {
    process.stderr.write(text);
  }

  onError(error: { message?: string }) {
    console.log(`not ok ${error.message}`);
  }

  onEnd(result: FullResult) {
    if (result.status !== "passed") console.log(`the tests ended as ${result.status}`);
  }
}
