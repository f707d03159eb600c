// Small things that the page is made of.

export function by<T extends HTMLElement = HTMLElement>(id: string): T {
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no #${id}`);
  return element as T;
}

export function onClick(id: string, action: () => void) {
  by(id).addEventListener("click", action);
}

/** Of buttons with this data attribute, the one of a value is pressed. */
export function press(group: string, name: string, value: string) {
  for (const button of by(group).querySelectorAll<HTMLElement>(`[data-${name}]`)) {
    button.setAttribute("aria-pressed", String(button.dataset[name] === value));
  }
}

/** Buttons with a data attribute that choose one of several things. */
export function chooser(group: string, name: string, chosen: (value: string) => void) {
  by(group).addEventListener("click", (event) => {
    const value = (event.target as HTMLElement).closest<HTMLElement>(`[data-${name}]`)?.dataset[name];
    if (value === undefined) return;
    press(group, name, value);
    chosen(value);
  });
}

/** Says what went wrong, and what helps, until it is closed or something goes right. */
export function complain(message: string, remedy: string | null) {
  by("message-text").textContent = message;
  by("message-remedy").textContent = remedy ?? "";
  by("message").hidden = false;
}

export function appease() {
  by("message").hidden = true;
}
