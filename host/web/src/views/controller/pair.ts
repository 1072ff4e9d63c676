// Two controllers to compare on the arm: the one that is edited and another one, named A and B; and which of them runs.

import { button, el, setText } from "../../parts/dom";
import { areSame, type Four } from "./draft";

type Letter = "A" | "B";

export class Pair {
  readonly element: HTMLElement;
  private readonly words = el("span", { class: "runs", attrs: { role: "status" } });
  private readonly other: HTMLButtonElement;
  private kept: Four | null = null; // the one that is not edited
  private edited: Letter = "A";

  constructor(swap: () => void) {
    this.other = button("Run B", swap, { title: "Run and edit the other of two controllers (X)" });
    this.element = el("span", { class: "pair", attrs: { role: "group", "aria-label": "Two controllers, A and B" } }, this.words, this.other);
  }

  /** Both begin as these. */
  begin(joints: Four): void {
    this.kept = joints;
  }

  /** Keeps the edited controllers, and answers with the others, which are edited from now on. */
  swap(edited: Four): Four {
    const other = this.kept ?? edited;
    this.kept = edited;
    this.edited = this.edited === "A" ? "B" : "A";
    return other;
  }

  press(): void {
    this.other.click();
  }

  show(edited: Four, running: Four, may: boolean): void {
    const other = this.edited === "A" ? "B" : "A";
    const is = (one: Four | null): boolean => one !== null && areSame(one, running);
    const runs = is(edited) ? this.edited : is(this.kept) ? other : null;
    setText(this.words, runs === null ? `${this.edited} is edited and does not run yet`
      : runs === this.edited ? `${runs} runs` : `${runs} runs, ${this.edited} is edited`);
    setText(this.other, runs === other ? `Edit ${other}` : `Run ${other}`);
    this.other.disabled = !may;
  }
}
