// A button that is grey says why: beside the pointer, to a screen reader, and in words where a finger has no pointer.

import { setText } from "./dom";

let named = 0;

/** Words that a button's reason may stand in. */
export function reasonFor(words: HTMLElement, ...buttons: HTMLButtonElement[]): void {
  words.id ||= `reason-${named++}`;
  for (const one of buttons) one.setAttribute("aria-describedby", words.id);
}

/** Greys a button as long as there is a reason; `usual` is its title else. */
export function grey(button: HTMLButtonElement, reason: string, usual: string): void {
  const title = reason || usual;
  if (button.disabled !== (reason !== "")) button.disabled = reason !== "";
  if (button.title !== title) button.title = title;
}

/** Shows a reason, or hides the words where there is none. */
export function showReason(words: HTMLElement, reason: string): void {
  setText(words, reason);
  words.hidden = !reason;
}
