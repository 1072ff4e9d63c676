// Before the arm moves by itself: a countdown over every view, with a Stop that keeps the arm still.

import type { Job, Jobs } from "../../session/services";
import { button, el, setText } from "../../parts/dom";
import type { Session } from "../../session/session";

const SECONDS = 3; // as the terminal counts
const LOOK_MS = 100;

export class Countdown {
  readonly element: HTMLElement;
  private readonly seconds = el("p", { class: "seconds" });
  private readonly words = el("p", { attrs: { role: "status" } });
  private readonly stop: HTMLButtonElement;
  private counted: string | null = null; // id of the job, or what this page is about to do

  /** It counts for the verbs of a host, where there is one, and for what the page itself is about to do. */
  constructor(private readonly session: Session, jobs: Pick<Jobs, "listen"> | null = null) {
    this.stop = button("Stop", () => void session.attempt(() => session.stop()), { class: "stop", title: "Motors stay off (space bar)" });
    this.element = el("div", { class: "countdown", hidden: true, attrs: { role: "alertdialog", "aria-label": "The arm is about to move" } },
      this.seconds, this.words, this.stop);
    jobs?.listen((job) => this.heard(job));
    session.changed.on(() => {
      if (!session.link.open) this.count(null); // nobody would tell its end
    });
  }

  /** Counts before this page moves the arm; false where it was stopped, or nobody sees it. */
  async before(what: string): Promise<boolean> {
    const { session } = this;
    const stops = session.stopsAsked;
    const goesOn = (): boolean => session.stopsAsked === stops && session.link.open && document.visibilityState === "visible";
    for (let left = SECONDS; left > 0 && goesOn(); left--) {
      this.show(what, left, what);
      for (let waited = 0; waited < 1000 && goesOn(); waited += LOOK_MS) await new Promise((settle) => setTimeout(settle, LOOK_MS));
    }
    this.count(null);
    return goesOn();
  }

  private heard({ id, verb, state, countdown }: Job): void {
    if (state === "running" && countdown > 0) this.show(id, countdown, `\`greywhale ${verb}\` is about to move the arm`);
    else if (id === this.counted) this.count(null);
  }

  private show(id: string, left: number, what: string): void {
    const begins = this.counted === null;
    this.count(id);
    setText(this.seconds, String(left));
    setText(this.words, `${what}; the space bar or Stop keeps it still.`);
    if (begins) this.stop.focus();
  }

  private count(id: string | null): void {
    this.counted = id;
    this.session.counting = id !== null;
    this.element.hidden = id === null;
  }
}
