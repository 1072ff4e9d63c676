// Predicts a step and a reach with the edited controllers on the model: anew while a person drags.

import { el, setText } from "../../parts/dom";
import { motionCanvas, paintMotions } from "../../parts/motions";
import { sentenceOf } from "../../parts/sentence";
import type { Services, Prediction } from "../../session/services";

export class PredictPanel {
  readonly element: HTMLElement;
  private readonly pictures = {
    step: { canvas: motionCanvas("Predicted step"), words: el("span", { class: "quiet" }) },
    reach: { canvas: motionCanvas("Predicted reach"), words: el("span", { class: "quiet" }) },
  };
  private readonly problem = el("p", { class: "problem", attrs: { role: "status" } });
  private wanted: { raw: readonly number[]; board: number } | null = null;
  private busy = false;
  private joint = 0;
  private last: Prediction | null = null;

  constructor(private readonly services: Services) {
    this.element = el("section", { class: "card predict" }, el("h2", {}, "The model predicts"),
      ...(["step", "reach"] as const).map((kind) => el("figure", {},
        el("figcaption", {}, kind === "step" ? "Step " : "Reach ", this.pictures[kind].words), this.pictures[kind].canvas)),
      this.problem);
  }

  /** Asks for these controllers; while an answer is on its way only the newest wish waits. */
  want(raw: readonly number[], board: number): void {
    this.wanted = { raw, board };
    void this.serve();
  }

  showJoint(joint: number): void {
    this.joint = joint;
    this.draw();
  }

  private async serve(): Promise<void> {
    if (this.busy) return;
    this.busy = true;
    while (this.wanted) {
      const { raw, board } = this.wanted;
      this.wanted = null;
      try {
        this.last = await this.services.predict(raw, board);
        setText(this.problem, "");
      } catch (error) {
        setText(this.problem, sentenceOf(error));
      }
      this.draw();
    }
    this.busy = false;
  }

  draw(): void {
    if (!this.last) return;
    for (const kind of ["step", "reach"] as const) {
      const { canvas, words } = this.pictures[kind];
      const { time_s, leader, follower } = this.last[kind];
      paintMotions(canvas, time_s, [leader, follower], this.joint);
      const rms = Math.sqrt(this.last[kind].mse[this.joint]!);
      setText(words, `error rms ${(1000 * rms).toFixed(1)} mrad`);
    }
    this.element.dataset["rms"] = String(Math.sqrt(this.last.step.mse[this.joint]!));
  }
}
