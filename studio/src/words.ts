// The page's words, in each language a file. What the library says (findings, keys) it says in English.

import en from "./words/en.json";
import ja from "./words/ja.json";

export type Word = keyof typeof en;
export type Language = "en" | "ja";

const LANGUAGES: Record<Language, Record<Word, string>> = { en, ja };

let language: Language = "en";

/** A word or sentence, with what its braces stand for. */
export function word(name: Word, parts: Record<string, string | number> = {}): string {
  return LANGUAGES[language][name].replace(/\{(\w+)\}/g, (_, part: string) => String(parts[part] ?? ""));
}

export function languageNow(): Language {
  return language;
}

/** The language that the page was left in, or that the browser asks for. */
export function preferred(): Language {
  const kept = localStorage.getItem("language");
  if (kept === "en" || kept === "ja") return kept;
  return navigator.language.startsWith("ja") ? "ja" : "en";
}

/** Puts the page into a language: texts (data-word), names for those who do not see (data-label), tips (data-tip). */
export function speak(next: Language) {
  language = next;
  localStorage.setItem("language", next);
  document.documentElement.lang = next;
  for (const element of document.querySelectorAll<HTMLElement>("[data-word]")) {
    element.textContent = word(element.dataset.word as Word);
  }
  for (const element of document.querySelectorAll<HTMLElement>("[data-label]")) {
    element.setAttribute("aria-label", word(element.dataset.label as Word));
    element.title = word(element.dataset.label as Word);
  }
}
