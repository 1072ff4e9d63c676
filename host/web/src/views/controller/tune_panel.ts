// Lets a search tune from the edited controllers: its course, and the same hand followed by what was and what was found.

import { curvesPicture } from "../../parts/curves";
import { button, el, setText } from "../../parts/dom";
import { motionCanvas, paintMotions } from "../../parts/motions";
import { sentenceOf } from "../../parts/sentence";
import { themeChanged } from "../../parts/theme";
import type { Searched, Tuned, Tuner } from "../../session/services";

export type Rows = readonly (readonly number[])[];

const PROMISE = "GWO-WOA tries 500 sets of four controllers, and begins with those that you see. It searches as greywhale "
  + "tune does, with the same costs on the same motions. What it finds takes the place of the edited controllers: Apply runs "
  + "them, Undo brings yours back.";
const LEFT_OUT = "It tunes the arm as this page begins with it, at the board's own period and limits; what you broke, loaded or "
  + "changed on the bench it does not know. Left out are: identification, as the arm's numbers are known here, and so the "
  + "other arms that a recording would allow; rivals for the last place; the report with its held-out motions; and the least "
  + "error that a supply allows. greywhale tune tries 2400 sets.";

export class TunePanel {
  readonly element: HTMLElement;
  private readonly start = button("Tune", () => void this.tune(), { class: "primary" });
  private readonly end = button("Stop the search", () => this.tuner.stop(), { hidden: true });
  private readonly words = el("p", { attrs: { role: "status" } });
  private readonly bar = el("progress", { hidden: true, attrs: { "aria-label": "Progress of the search" } });
  private readonly course = el("figure", { hidden: true });
  private readonly canvas = motionCanvas("The same hand, followed before and after");
  private readonly caption = el("figcaption");
  private readonly picture = el("figure", { hidden: true }, this.caption, this.canvas);
  private joint = 0;
  private tuned: Tuned | null = null;

  /** `edited` are the controllers to begin with, null where a board would refuse them; `take` gets those that were found. */
  constructor(private readonly tuner: Tuner, private readonly edited: () => Rows | null, private readonly take: (found: Rows) => void) {
    this.element = el("section", { class: "card tune" }, el("h2", {}, "Let it tune"),
      el("p", {}, PROMISE), el("div", { class: "row" }, this.start, this.end, this.bar), this.words, this.course, this.picture,
      el("details", {}, el("summary", {}, "What this leaves out"), el("p", { class: "quiet" }, LEFT_OUT)));
    themeChanged.on(() => this.draw());
  }

  showJoint(joint: number): void {
    this.joint = joint;
    this.draw();
  }

  private async tune(): Promise<void> {
    const before = this.edited();
    if (!before) {
      setText(this.words, "The board would refuse these controllers; mend them first.");
      return;
    }
    this.searching(true);
    setText(this.words, "The search begins.");
    try {
      this.tuned = await this.tuner.tune(before, (searched) => this.heard(searched));
      this.take(this.tuned.after);
      setText(this.words, sentence(this.tuned));
      this.draw();
    } catch (error) {
      setText(this.words, sentenceOf(error));
    }
    this.searching(false);
  }

  private searching(on: boolean): void {
    this.start.disabled = on;
    this.end.hidden = this.bar.hidden = !on;
    this.element.dataset["searching"] = on ? "yes" : "";
  }

  private heard({ evaluations, budget, cost, curve }: Searched): void {
    this.bar.max = budget;
    this.bar.value = evaluations;
    const total = cost.reduce((sum, one) => sum + one, 0);
    setText(this.words, `${evaluations} of ${budget} sets; the best cost together ${total.toFixed(2)}.`);
    const x = curve.map(([at]) => at);
    const drawn = cost.map((_, joint) => ({ x, y: curve.map(([, costs]) => costs[joint]!), shade: `joint-${joint}` }));
    this.course.hidden = false;
    this.course.replaceChildren(
      el("figcaption", { class: "quiet" }, "Best cost of each joint: ",
        ...cost.flatMap((_, joint) => [el("span", { class: `key key-${joint}` }), ` ${joint}  `])),
      curvesPicture("Curve of the search", "sets", drawn));
  }

  private draw(): void {
    if (!this.tuned) return;
    const { time_s, leader, followers, mse } = this.tuned;
    this.picture.hidden = false;
    const [before, after] = mse.map((row) => `${(1000 * Math.sqrt(row[this.joint]!)).toFixed(1)}`);
    setText(this.caption, `Joint ${this.joint} behind the same hand (dashed), predicted: error rms ${before} mrad before (thin), ${after} mrad after (bold)`);
    paintMotions(this.canvas, time_s, [leader, ...followers], this.joint);
  }
}

function sentence({ calmed }: Tuned): string {
  const named = (as_before: boolean): string =>
    calmed.filter((one) => one.as_before === as_before).map(({ joint }) => `joint ${joint}`).join(", ");
  const [kept, calmer] = [named(true), named(false)];
  return "Found; Apply runs it."
    + (calmer ? ` Steadier than the search had it, with less voltage or integral: ${calmer}.` : "")
    + (kept ? ` As before, since what was found came to rest less well: ${kept}.` : "");
}
