// A card for what is seldom used: open where the screen has room for it, else only its title.

import { el } from "../../parts/dom";

const TALL = "(min-height: 900px)";

export function seldom(title: string, ...children: readonly Node[]): HTMLDetailsElement {
  const card = el("details", { class: "card" }, el("summary", {}, title), ...children);
  card.open = matchMedia(TALL).matches;
  return card;
}
