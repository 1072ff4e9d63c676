// The first view: the arm as it moves, what its potentiometers read, things to try, and the way to one's own arm.

import { el } from "../../parts/dom";
import type { ArmPicture } from "../arm3d/picture";
import type { View } from "../view";
import type { Way } from "./way";

/** A part of the view that is drawn with it. */
export type Part = Pick<View, "element" | "enter" | "leave" | "frame">;

export class StartView implements View {
  readonly name = "Start";
  readonly withoutBoard = true;
  readonly element: HTMLElement;
  private readonly parts: readonly Part[];
  private readonly place = el("div");

  /** `beside` stands beside the arm, from the top down. */
  constructor(private readonly arm: ArmPicture, beside: readonly Part[], way: Way) {
    this.parts = [...beside, way];
    this.element = el("div", { class: "start" },
      el("div", { class: "with-side" }, this.place, el("div", { class: "side" }, ...beside.map(({ element }) => element))),
      way.element);
  }

  enter(): void {
    this.arm.showIn(this.place);
    for (const part of this.parts) part.enter?.();
  }

  leave(): void {
    for (const part of this.parts) part.leave?.();
  }

  frame(): void {
    this.arm.frame();
    for (const part of this.parts) part.frame?.();
  }
}
