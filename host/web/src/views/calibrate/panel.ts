// A step as a person sees it: its title, what is asked, its buttons, and why one of them cannot be pressed now.

import { button, el, setText } from "../../parts/dom";
import { grey } from "../../parts/grey";
import { sentenceOf } from "../../parts/sentence";
import type { Session } from "../../session/session";

const OFF = "Calibrate with the motors off; press Stop first.";

/** A button of a step, and the reason why it cannot be pressed now. */
export type Action = { readonly button: HTMLButtonElement; readonly whyNot: () => string; readonly usual: string };

export class StepPanel {
  /** Title, words, body, problem, buttons and the reason, in this order. */
  readonly elements: readonly HTMLElement[];
  readonly body = el("div", { class: "step-body" });
  private busy = ""; // what is under way, in a sentence
  private pressed = ""; // the label of the last button
  private actions: readonly Action[] = [];
  private readonly title = el("h3");
  private readonly asked = el("p", { attrs: { role: "status" } });
  private readonly problem = el("p", { class: "problem", attrs: { role: "alert" } });
  private readonly row = el("div", { class: "row" });
  private readonly reason = el("p", { class: "reason", attrs: { role: "status" } });

  constructor(private readonly session: Session) {
    this.elements = [this.title, this.asked, this.body, this.problem, this.row, this.reason];
  }

  /** The reason why nothing can be done now, in a sentence; empty where something can. */
  whyNot(): string {
    const { link, whyNotChange, motorsOn } = this.session;
    if (!link.open) return link.sentence || "No board is there yet.";
    return this.busy || whyNotChange || (motorsOn ? OFF : "");
  }

  refresh(): void {
    for (const { button: one, whyNot, usual } of this.actions) grey(one, whyNot(), usual);
    const reason = this.whyNot();
    setText(this.reason, reason);
    this.reason.hidden = !reason;
  }

  /** Shows a step; `beside` are buttons that stand elsewhere. */
  show(title: string, asked: string, body: readonly HTMLElement[], actions: readonly Action[], beside: readonly Action[]): void {
    setText(this.title, title);
    this.ask(asked);
    this.body.replaceChildren(...body);
    this.row.replaceChildren(...actions.map(({ button: one }) => one));
    this.actions = [...actions, ...beside];
    this.refresh();
    this.keepFocus();
  }

  ask(words: string): void {
    setText(this.asked, words);
  }

  tell(problem: string): void {
    setText(this.problem, problem);
  }

  /** One more button, in the body. */
  add(action: Action): void {
    this.actions = [...this.actions, action];
  }

  /** Nothing but to begin again is left of this step. */
  offerAgain(): void {
    const [goOn, again] = this.actions;
    setText(goOn!.button, "Again");
    again!.button.hidden = true;
  }

  forgetFocus(): void {
    this.pressed = "";
  }

  action(label: string, act: () => Promise<void>, usual: string, primary = false, whyNot = (): string => this.whyNot()): Action {
    const press = (): void => {
      this.pressed = label;
      void this.attempt(act);
    };
    return { button: button(label, press, primary ? { class: "primary" } : {}), whyNot, usual };
  }

  /** Runs what a person asked for; an error stands in the step. */
  async attempt(act: () => Promise<void>): Promise<void> {
    this.tell("");
    try {
      await act();
    } catch (error) {
      this.tell(sentenceOf(error));
    }
    this.refresh();
    this.keepFocus();
  }

  /** Does something during which nothing else can be done. */
  async alone(what: string, act: () => Promise<void>): Promise<void> {
    this.busy = what;
    this.refresh();
    try {
      await act();
    } finally {
      this.busy = "";
    }
  }

  /** Whoever goes on by the keyboard stays at the button that was pressed, or its like in the next step, else at the first. */
  private keepFocus(): void {
    if (document.activeElement !== document.body || !this.pressed) return; // a button that is gone, or grey, has no focus
    const like = this.actions.find(({ button: one }) => one.textContent === this.pressed && this.row.contains(one));
    (like ?? this.actions[0])?.button.focus();
  }
}
