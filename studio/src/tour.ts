// A tour of five steps.

import { by, onClick } from "./page.js";
import { word, type Word } from "./words.js";

const STEPS: [Word, string][] = [["tour1", "setup"], ["tour2", "properties"], ["tour3", "seen"], ["tour4", "findings"], ["tour5", "take"]];

export function tour() {
  const box = by("tour");
  let at = -1;
  const show = (step: number) => {
    document.querySelector(".toured")?.classList.remove("toured");
    at = step;
    const [text, place] = STEPS[at] ?? [null, null];
    box.hidden = !text;
    if (!text) return by("tour-button").focus();
    by("tour-text").textContent = `${at + 1}/${STEPS.length} ${word(text)}`;
    by(place).classList.add("toured");
    by(place).scrollIntoView({ block: "nearest" });
    by("tour-next").focus();
  };
  onClick("tour-button", () => show(0));
  onClick("tour-next", () => show(at + 1));
  onClick("tour-close", () => show(STEPS.length));
  box.addEventListener("keydown", (event) => {
    if (event.key === "Escape") show(STEPS.length);
  });
}
