// One step of the way to one's own arm as a numbered card: done or not, its result in the verb's own words, what comes next.

import { button, el, setText } from "../../parts/dom";
import { grey } from "../../parts/grey";
import type { Session } from "../../session/session";
import type { Step } from "./steps";

const MARKS = new Map([[true, "done"], [false, "not yet"], [null, "not known here"]] as const);

export class StepCard {
  readonly element: HTMLDetailsElement;
  private readonly mark = el("span", { class: "way-mark" });
  private readonly words = el("span", { class: "told" });
  private readonly actions = el("div", { class: "row" });
  private readonly result = el("div", { class: "way-result" });
  private shown = "";

  /** `docs` is the folder of the documentation, null for none. */
  constructor(private readonly session: Session, number: number, private readonly step: Step, docs: string | null) {
    const [page, title] = step.more;
    this.element = el("details", { class: "card way-step" },
      el("summary", {}, el("h3", {}, `${number} ${step.title}`), this.mark, this.words),
      el("p", { class: "quiet" }, step.about), this.actions, this.result,
      el("p", { class: "quiet" }, `If it fails: ${step.failed}`, ...(docs ? [" ", el("a", { href: `${docs}${page}` }, title)] : [])));
  }

  /** Shows how far the step is; `next` if it is the first that waits for a person. */
  show(next: boolean): void {
    const { done, words } = this.step.look();
    setText(this.mark, MARKS.get(done)!);
    this.element.dataset["done"] = String(done);
    this.element.dataset["next"] = String(next);
    setText(this.words, words);
    this.showActions(next);
  }

  /** Builds the buttons anew only where other ones are offered, so that none goes away under a finger. */
  private showActions(next: boolean): void {
    const actions = this.step.actions();
    const labels = [String(next), ...actions.map(({ label }) => label)].join("|");
    if (labels !== this.shown) {
      this.shown = labels;
      this.actions.replaceChildren(...actions.map(({ label, act }, place) =>
        button(next && !place ? `Next: ${label}` : label, act, next && !place ? { class: "primary" } : {})));
    }
    if (actions[0]?.label !== "Enable") return;
    grey(this.actions.firstElementChild as HTMLButtonElement, this.session.whyNotEnable, "Starts the motors through the soft start");
  }

  /** Puts the newest result of the step's verbs into it. */
  showResult(card: HTMLElement): void {
    this.result.replaceChildren(card);
  }
}
