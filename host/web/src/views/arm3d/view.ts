// The arm in a view of its own.

import { el } from "../../parts/dom";
import type { View } from "../view";
import type { ArmPicture } from "./picture";

export class ArmView implements View {
  readonly name = "Arm";
  readonly element = el("div");

  constructor(private readonly picture: ArmPicture) {}

  enter(): void {
    this.picture.showIn(this.element);
  }

  frame(): void {
    this.picture.frame();
  }
}
