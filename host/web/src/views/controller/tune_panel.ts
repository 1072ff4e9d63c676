// Lets a search tune: its course, what it changed in every joint, and the same hand followed by what was and what was found.

import { upperFirst } from "../../link/refusal";
import { curvesPicture } from "../../parts/curves";
import { button, el, setText } from "../../parts/dom";
import { motionCanvas, paintMotions } from "../../parts/motions";
import { sentenceOf } from "../../parts/sentence";
import { themeChanged } from "../../parts/theme";
import { JOINTS } from "../../session/samples";
import type { Model, Searched, Tuned, Tuner } from "../../session/services";
import { changesTable } from "./changes_table";

export type Rows = readonly (readonly number[])[];

const PROMISE = "What it finds takes the place of the edited controllers: Apply runs them, Undo brings yours back.";

export class TunePanel {
  readonly element: HTMLElement;
  private readonly start = button("Tune", () => void this.begin(), { class: "primary" });
  private readonly end = button("Stop the search", () => this.tuner.stop(), { hidden: true });
  private readonly words = el("p", { attrs: { role: "status" } });
  private readonly bar = el("progress", { hidden: true, attrs: { max: "1", "aria-label": "Progress of the search" } });
  private readonly course = el("figure", { hidden: true });
  private readonly changes = el("div");
  private readonly canvas = motionCanvas("The same hand, followed before and after");
  private readonly caption = el("figcaption");
  private readonly picture = el("figure", { hidden: true }, this.caption, this.canvas);
  private joint = 0;
  private tuned: Tuned | null = null;

  /**
   * `edited` are the controllers to begin with, null where a board would refuse them; `model` is what they are for;
   * `take` gets those that were found.
   */
  constructor(
    private readonly tuner: Tuner, private readonly edited: () => Rows | null, private readonly model: () => Model | null,
    private readonly take: (found: Rows) => void,
  ) {
    this.element = el("section", { class: "card tune" }, el("h2", {}, "Let it tune"),
      el("p", {}, `${tuner.promise} ${PROMISE}`), el("div", { class: "row" }, this.start, this.end, this.bar), this.words,
      this.changes, el("div", { class: "pictures" }, this.course, this.picture),
      el("details", {}, el("summary", {}, "How far this goes"), el("p", { class: "quiet" }, tuner.limits)));
    themeChanged.on(() => this.draw());
  }

  showJoint(joint: number): void {
    this.joint = joint;
    this.draw();
  }

  /** Searches, unless a search is under way. */
  async begin(): Promise<void> {
    if (this.start.disabled) return;
    this.element.scrollIntoView({ block: "nearest" });
    const [before, model] = [this.edited(), this.model()];
    if (!before || !model) {
      setText(this.words, before ? "The models are not read yet; try again." : "The board would refuse these controllers; mend them first.");
      return;
    }
    this.searching(true);
    setText(this.words, "The search begins.");
    try {
      this.tuned = await this.tuner.tune(before, model, (searched) => this.heard(searched));
      this.take(this.tuned.after);
      setText(this.words, "Found; Apply runs it. Below, before → after.");
      this.changes.replaceChildren(el("ul", {}, ...this.tuned.notes.map((note) => el("li", {}, upperFirst(note)))), changesTable(this.tuned));
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

  private heard({ share, words, curve: { unit, x, y } }: Searched): void {
    this.bar.value = share;
    setText(this.words, words);
    const each = y.length === JOINTS; // else the cost of all joints together
    this.course.hidden = !x.length;
    if (!x.length) return;
    this.course.replaceChildren(
      el("figcaption", { class: "quiet" }, ...(each
        ? ["Best cost of each joint: ", ...y.flatMap((_, joint) => [el("span", { class: `key key-${joint}` }), ` ${joint}  `])]
        : ["Best cost of all joints together"])),
      curvesPicture("Curve of the search", unit, y.map((costs, joint) => ({ x, y: costs, shade: each ? `joint-${joint}` : "accent" }))));
  }

  private draw(): void {
    this.picture.hidden = !this.tuned?.time_s.length;
    if (!this.tuned || this.picture.hidden) return;
    const { time_s, leader, followers } = this.tuned;
    setText(this.caption, `Joint ${this.joint} behind the same hand (dashed): before (thin), after (bold)`);
    paintMotions(this.canvas, time_s, [leader, ...followers], this.joint);
  }
}
