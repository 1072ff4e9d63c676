// Episodes: logs of one task after the other, begun and ended by a key; the last one may be discarded.

import { Fault } from "../../link/schema";
import { button, el, setText } from "../../parts/dom";
import { grey } from "../../parts/grey";
import { nextEpisode } from "../../files/log";
import { TICKS_A_SECOND } from "../../session/samples";
import type { Session } from "../../session/session";
import { keepLog, type Keeper } from "./keep";
import { Trigger } from "./trigger";

type Running = { readonly from: number; readonly task: string; readonly fault: Trigger };

export class EpisodesPanel {
  readonly element: HTMLElement;
  private readonly task = el("input", { type: "text", attrs: { placeholder: "What the arm does", "aria-label": "Task", size: "28" } });
  private readonly next = button("Begin episode", () => this.beginOrEnd(), { title: "Begin or end an episode (R)" });
  private readonly drop = button("Discard", () => this.discard());
  private readonly state = el("p", { class: "quiet", attrs: { "aria-live": "polite" } });
  private running: Running | null = null;
  private readonly kept: string[] = [];
  private working: Promise<unknown> = Promise.resolve(); // one after the other, so that no two get one number

  constructor(private readonly session: Session, private readonly keeper: Keeper) {
    this.element = el("section", { class: "card" }, el("h2", {}, "Episodes"), el("div", { class: "row" }, this.task),
      el("div", { class: "row" }, this.next, this.drop), this.state);
    this.show();
  }

  beginOrEnd(): void {
    const { samples } = this.session;
    const task = this.task.value.trim();
    if (this.running) {
      this.look();
      this.end(samples.end);
    } else if (task) {
      this.running = { from: samples.end, task, fault: new Trigger(samples, { kind: "fault" }) };
    } else {
      this.session.tell("An episode has a task; write what the arm does, such as: Put the cup on the plate.");
    }
    this.show();
  }

  /** Discards the episode that runs, or else the last one. */
  discard(): void {
    if (this.running) this.running = null;
    else if (!this.whyNotDiscard) this.work(() => this.remove());
    this.show();
  }

  /** Looks at the newest samples: a fault ends an episode. */
  look(): void {
    const { running, session: { samples } } = this;
    if (!running) return;
    const number = running.fault.look();
    if (number !== null) this.end(number + 1, `The board is in fault: ${Fault.of(samples.fault[number % samples.capacity]!).description}.`);
    else this.show();
  }

  private end(to: number, cause = ""): void {
    const { running, session } = this;
    if (!running) return;
    this.running = null;
    if (cause) session.tell(`The episode has ended. ${cause}`);
    this.work(async () => {
      const name = nextEpisode([...await this.keeper.names(), ...this.kept]);
      const kept = await keepLog(session, this.keeper, name, running.from, to, { task: running.task, cause });
      if (kept) this.kept.push(kept);
    });
  }

  private async remove(): Promise<void> {
    const name = this.kept.at(-1);
    if (!name || !this.keeper.discard) return;
    await this.keeper.discard(name);
    this.kept.pop();
    this.session.tell(`${name} is discarded.`, "info");
  }

  private work(act: () => Promise<void>): void {
    this.working = this.working.then(() => this.session.attempt(act)).then(() => this.show());
  }

  private get whyNotDiscard(): string {
    if (this.running) return "";
    if (!this.kept.length) return "This page has kept no episode yet.";
    return this.keeper.discard ? "" : `${this.kept.at(-1)!} is among your browser's downloads; delete it there.`;
  }

  private show(): void {
    const { running, kept, session: { samples } } = this;
    setText(this.next, running ? "End episode" : "Begin episode");
    this.next.setAttribute("aria-pressed", String(running !== null));
    this.task.disabled = running !== null;
    grey(this.drop, this.whyNotDiscard, `Discard ${running ? "the episode that runs" : "the last episode"} (D)`);
    const ticks = running && samples.end > running.from ? samples.lastTime - samples.timeOf(running.from) + 1 : 0;
    const last = kept.length ? `${kept.length} kept, the last is ${kept.at(-1)!}.` : "";
    setText(this.state, running ? `${(ticks / TICKS_A_SECOND).toFixed(1)} s so far.` : last);
  }
}
