// Before a verb moves the arm: its countdown over every view, with a Stop that keeps the arm still.

import type { Job, Jobs } from "../../session/services";
import { button, el, setText } from "../../parts/dom";
import type { Session } from "../../session/session";

export class Countdown {
  readonly element: HTMLElement;
  private readonly seconds = el("p", { class: "seconds" });
  private readonly words = el("p", { attrs: { role: "status" } });
  private readonly stop: HTMLButtonElement;
  private counted: string | null = null; // id of the job

  constructor(private readonly session: Session, jobs: Pick<Jobs, "listen">) {
    this.stop = button("Stop", () => void session.attempt(() => session.stop()), { class: "stop", title: "Motors stay off (space bar)" });
    this.element = el("div", { class: "countdown", hidden: true, attrs: { role: "alertdialog", "aria-label": "The arm is about to move" } },
      this.seconds, this.words, this.stop);
    jobs.listen((job) => this.heard(job));
    session.changed.on(() => {
      if (!session.link.open) this.count(null); // nobody would tell its end
    });
  }

  private heard({ id, verb, state, countdown }: Job): void {
    const counts = state === "running" && countdown > 0;
    if (!counts && id !== this.counted) return;
    const begins = counts && this.counted === null;
    this.count(counts ? id : null);
    setText(this.seconds, String(countdown));
    setText(this.words, `\`greywhale ${verb}\` is about to move the arm; the space bar or Stop keeps it still.`);
    if (begins) this.stop.focus();
  }

  private count(id: string | null): void {
    this.counted = id;
    this.session.counting = id !== null;
    this.element.hidden = id === null;
  }
}
