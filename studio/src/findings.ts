// What the preflight finds, in words, with what helps as a button.

import type { Check, Line } from "../core/midair_web.js";
import { by } from "./page.js";
import { word } from "./words.js";

export function showFindings(check: Check, apply: (lines: Line[]) => void) {
  const percent = (share: number) => `${(100 * share).toFixed(share > 0.999 && share < 1 ? 2 : 1).replace(/\.0$/, "")} %`;
  by("formed").textContent = word("formed", { formed: percent(check.image.formed) });
  const list = by("findings");
  const items = check.findings.map((finding) => {
    const item = document.createElement("li");
    item.className = finding.severity;
    const sentence = document.createElement("p");
    sentence.textContent = finding.sentence;
    item.append(sentence);
    if (finding.remedy) {
      const remedy = document.createElement("p");
      remedy.className = "remedy";
      remedy.textContent = word("remedy", { remedy: finding.remedy });
      item.append(remedy);
    }
    if (finding.lines.length > 0) {
      const button = document.createElement("button");
      button.textContent = word("apply");
      button.title = finding.lines.map((line) => `${line.key} = ${JSON.stringify(line.value)}`).join("\n");
      button.addEventListener("click", () => apply(finding.lines));
      item.append(button);
    }
    return item;
  });
  list.replaceChildren(...items);
  if (items.length === 0) {
    const item = document.createElement("li");
    item.textContent = word("noFindings");
    list.append(item);
  }
}
