// Which joint a calibration asks for, and its positive way: a part of the picture that docs/calibrate.md has.

import { el } from "../parts/dom";

const ASKED = /\bjoint ([0-3])\b/;

export class JointPicture {
  readonly element = el("div", { class: "joint-picture", hidden: true, attrs: { role: "img" } });

  /** Shows the joint of the last line if that asks for one. */
  hear(said: readonly string[]): void {
    const joint = ASKED.exec(said.at(-1) ?? "")?.[1];
    this.element.hidden = joint === undefined;
    if (joint === undefined || joint === this.element.dataset["joint"]) return;
    this.element.dataset["joint"] = joint;
    this.element.setAttribute("aria-label", `The positive way of joint ${joint}`);
  }
}
