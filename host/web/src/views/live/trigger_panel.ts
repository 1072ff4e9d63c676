// Capture: waits for an event, then holds the charts with the event in view.

import { button, el, select, setText } from "../../parts/dom";
import { JOINTS, QUANTITIES, TICKS_A_SECOND, type Quantity } from "../../session/samples";
import type { Session } from "../../session/session";
import { Trigger, type Condition } from "./trigger";
import type { TimeWindow } from "./window";

const BEFORE_SHARE = 0.3; // of the span lies before the event
const KINDS = [
  ["rising", "rises through"], ["falling", "falls through"], ["level", "is beyond ±"], ["fault", "a fault"],
] as const;

export class TriggerPanel {
  readonly element: HTMLElement;
  private trigger: Trigger | null = null;
  private until: number | null = null; // the time up to which samples are still wanted, in ticks
  private kind: Condition["kind"] = "rising";
  private quantity: Quantity = "error";
  private joint = 0;
  private readonly level = el("input", {
    type: "number", value: "0.1", attrs: { step: "any", "aria-label": "Level in rad or V" },
  });
  private readonly state = el("p", { class: "quiet", attrs: { "aria-live": "polite" } });
  private readonly arm = button("Wait for it", () => this.toggle());

  constructor(private readonly session: Session, private readonly window: TimeWindow) {
    const what = select("Quantity", QUANTITIES.map((name) => [name, name] as const), (name) => { this.quantity = name; });
    what.value = this.quantity;
    const joint = select("Joint", Array.from({ length: JOINTS }, (_, i) => [String(i), `joint ${i}`] as const),
      (text) => { this.joint = Number(text); });
    const kind = select("Event", KINDS, (name) => {
      this.kind = name;
      for (const other of [what, joint, this.level]) other.disabled = name === "fault";
    });
    this.element = el("section", { class: "card" }, el("h2", {}, "Capture"),
      el("div", { class: "row" }, joint, what, kind, this.level), el("div", { class: "row" }, this.arm), this.state);
  }

  private toggle(): void {
    if (this.trigger) {
      this.end("");
      return;
    }
    const at = Number(this.level.value);
    if (this.kind !== "fault" && (this.level.value === "" || !Number.isFinite(at))) {
      setText(this.state, "The level is not a number; give one in rad or V.");
      return;
    }
    const { kind, quantity, joint } = this;
    this.trigger = new Trigger(this.session.samples, kind === "fault" ? { kind } : { kind, quantity, joint, at });
    this.window.follow();
    setText(this.arm, "Wait no longer");
    setText(this.state, "Waiting.");
  }

  private end(text: string): void {
    this.trigger = null;
    this.until = null;
    setText(this.arm, "Wait for it");
    setText(this.state, text);
  }

  /** Looks at the newest samples. */
  look(): void {
    if (!this.trigger) return;
    const { samples } = this.session;
    if (this.until === null) {
      const number = this.trigger.look();
      if (number === null) return;
      const time = samples.timeOf(number);
      this.until = time + (1 - BEFORE_SHARE) * this.window.spanTicks;
      setText(this.state, `It happened at ${(time / TICKS_A_SECOND).toFixed(3)} s.`);
    }
    if (samples.lastTime >= this.until) {
      this.window.show(this.until - this.window.spanTicks, this.until);
      this.end(this.state.textContent ?? "");
    }
  }
}
