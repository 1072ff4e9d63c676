// The board's state, and the counters of firmware and link.

import { Clutch, ClutchAction, State, StopReason, SaveState, TABLE } from "../../link/schema";
import { upperFirst } from "../../link/refusal";
import { button, el, setText } from "../../parts/dom";
import type { Session } from "../../session/session";

const SUPPLY_MV = TABLE.named("supply_mv").index;

export class StatePanel {
  readonly element: HTMLElement;
  private readonly sentence = el("p", { class: "state-text" });
  private readonly clutchText = el("p", { class: "state-text" });
  private readonly clutch = button("", () => this.use(this.engaged() ? ClutchAction.is.disengage : ClutchAction.is.engage));
  private readonly reset = button("Reset", () => this.use(ClutchAction.is.reset), {
    title: "The leader's angles count as they are again; only while the motors are off",
  });
  private readonly rows = new Map<string, HTMLElement>();

  constructor(private readonly session: Session) {
    const names = [
      "last stop", "supply, as set", "ticks", "late ticks", "longest tick", "samples lost", "samples not sent", "frames damaged", "bytes lost",
      "no rule", "stored sets",
    ];
    const list = el("dl", { class: "facts" });
    for (const name of names) {
      const value = el("dd", {}, "–");
      this.rows.set(name, value);
      list.append(el("dt", {}, name), value);
    }
    this.element = el("section", { class: "card" }, el("h2", {}, "Board"), this.sentence, list,
      el("h2", {}, "Clutch"), this.clutchText, el("div", { class: "row" }, this.clutch, this.reset));
    session.changed.on(() => this.show());
    this.show();
  }

  private engaged(): boolean {
    return this.session.status?.clutch !== Clutch.is.disengaged;
  }

  private use(action: number): void {
    void this.session.attempt(() => this.session.clutch(action));
  }

  private showClutch(): void {
    const { status, link, motorsOn } = this.session;
    const there = status !== null && link.open;
    setText(this.clutchText, there ? `${upperFirst(Clutch.of(status.clutch).description)}.` : "");
    setText(this.clutch, this.engaged() ? "Disengage" : "Engage");
    this.clutch.disabled = !there;
    this.reset.disabled = !there || motorsOn || status.clutch === Clutch.is.engaged;
  }

  private show(): void {
    this.showClutch();
    const { status, link, samples, damaged, parameters } = this.session;
    if (!status || !link.open) {
      setText(this.sentence, link.sentence || "No board is there yet.");
      return;
    }
    setText(this.sentence, `${upperFirst(State.of(status.state).description)}.`);
    const facts: Record<string, string> = {
      "last stop": StopReason.of(status.stop_reason).description,
      "supply, as set": parameters ? `${parameters[SUPPLY_MV]! / 1000} V` : "being read", // no pin of the board measures it
      ticks: status.tick.toLocaleString("en"),
      "late ticks": String(status.late_ticks),
      "longest tick": `${status.tick_us_max} µs`,
      "samples lost": String(samples.lost),
      "samples not sent": String(status.telemetry_dropped),
      "frames damaged": String(status.frames_bad + damaged),
      "bytes lost": String(status.rx_overruns),
      "no rule": String(status.no_rule),
      "stored sets": `${status.saves}, ${SaveState.of(status.save_state).description}`,
    };
    for (const [name, text] of Object.entries(facts)) setText(this.rows.get(name)!, text);
  }
}
