// Tells what stands in the way of the motors, under the header of every view: a fault with its remedy, or who else has the arm.

import { faultSentence } from "../link/refusal";
import { button, el, setText } from "../parts/dom";
import { grey, reasonFor, showReason } from "../parts/grey";
import type { Session } from "../session/session";

/** The element in which every view finds why its buttons are grey. */
export const REASON = "reason";

export class InTheWay {
  readonly element: HTMLElement;
  private readonly text = el("p");
  private readonly clear: HTMLButtonElement;
  private readonly fault: HTMLElement;
  private readonly reason = el("p", { class: "reason", hidden: true, attrs: { id: REASON, role: "status" } });

  /** `buttons` are those that the reason is about. */
  constructor(private readonly session: Session, ...buttons: HTMLButtonElement[]) {
    this.clear = button("Clear fault", () => void session.attempt(() => session.clearFault()));
    this.fault = el("div", { class: "fault", hidden: true, attrs: { role: "alert" } }, this.text, this.clear);
    this.element = el("div", { class: "in-the-way" }, this.fault, this.reason);
    reasonFor(this.reason, this.clear, ...buttons);
    session.changed.on(() => this.show());
  }

  private show(): void {
    const { faulty, status, link, whyNotChange } = this.session;
    this.fault.hidden = !faulty;
    if (faulty && status) setText(this.text, faultSentence(status));
    grey(this.clear, whyNotChange, "The motors stay off until somebody enables them");
    showReason(this.reason, link.open ? whyNotChange : "");
  }
}
