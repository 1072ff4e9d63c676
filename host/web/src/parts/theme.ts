// Light or dark, as the person or else the system wants it, and the colours for what draws itself.

import { Signal } from "./signal";
import { browserStore } from "./storage";

export const themeChanged = new Signal();
const KEY = "greywhale-theme";
const dark = matchMedia("(prefers-color-scheme: dark)");
let chosenHere: string | null = null; // whether or not the browser keeps it

export function isDark(): boolean {
  const chosen = chosenHere ?? browserStore.read(KEY);
  return chosen ? chosen === "dark" : dark.matches;
}

function apply(): void {
  document.documentElement.dataset["theme"] = isDark() ? "dark" : "light";
  themeChanged.emit();
}

/** Takes the theme that was chosen before, and follows the system where none was. */
export function startTheme(): void {
  dark.addEventListener("change", apply);
  apply();
}

export function switchTheme(): void {
  chosenHere = isDark() ? "light" : "dark";
  browserStore.write(KEY, chosenHere);
  apply();
}

export type Colours = Readonly<Record<"ink" | "quiet" | "line" | "accent", string>> & { readonly joints: readonly string[] };

/** The colours of page.css as they are now. */
export function colours(): Colours {
  const style = getComputedStyle(document.documentElement);
  const of = (name: string): string => style.getPropertyValue(`--${name}`).trim();
  return {
    ink: of("ink"), quiet: of("quiet"), line: of("line"), accent: of("accent"),
    joints: [0, 1, 2, 3].map((joint) => of(`joint-${joint}`)),
  };
}
