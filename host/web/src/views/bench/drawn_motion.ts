// A motion of the leader that a person draws: angle over time, joint by joint, played as by a hand.

import { button, el, onDrag, select, setText, svg } from "../../parts/dom";
import { JOINT_NAMES, JOINTS } from "../../session/samples";
import type { LeaderControl } from "./leader_control";
import { angleAt, pointed, shareOf, type Limits } from "./limits";
import { seldom } from "./seldom";
import { Stroke } from "./stroke";

const COLUMNS = 120;
const WIDTH = 480;
const HEIGHT = 160;
const DURATIONS_S = [2, 4, 8, 16];

export class DrawnMotion {
  readonly element: HTMLElement;
  private readonly strokes = Array.from({ length: JOINTS }, () => new Stroke(COLUMNS));
  private readonly curves = this.strokes.map((_, joint) => svg("polyline", { class: `curve joint-${joint}` }));
  private readonly now = svg("line", { y1: 0, y2: HEIGHT, class: "base" });
  private readonly picture = svg("svg", {
    viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: "curves drawn", role: "img", "aria-label": "Drawn motion: angle over time",
  }, this.now, ...this.curves);
  private readonly play = button("Play", () => this.toggle());
  private joint = 0;
  private durationS = DURATIONS_S[1]!;
  private begunMs: number | null = null;

  constructor(private readonly leaderControl: LeaderControl, private readonly limits: Limits) {
    const joint = select("Joint to draw", JOINT_NAMES.map((name, place) => [String(place), `${place} ${name}`] as const),
      (chosen) => { this.joint = Number(chosen); });
    const duration = select("Duration", DURATIONS_S.map((s) => [String(s), `${s} s`] as const),
      (chosen) => { this.durationS = Number(chosen); });
    duration.value = String(this.durationS);
    this.element = seldom("Draw a motion",
      el("div", { class: "row" }, joint, duration, this.play, button("Clear", () => this.clear())),
      this.picture,
      el("p", { class: "quiet" }, "Drag from left to right; the highest and lowest angles are the leader's limits."));
    onDrag(this.picture, (event) => {
      this.strokes[this.joint]!.lift();
      this.drawTo(event);
    }, (event) => this.drawTo(event));
    this.show();
  }

  private drawTo(event: PointerEvent): void {
    const [across, up] = pointed(this.picture, event);
    this.strokes[this.joint]!.drawTo(across, angleAt(this.limits, this.joint, up));
    this.show();
  }

  private clear(): void {
    for (const stroke of this.strokes) stroke.clear();
    this.begunMs = null;
    this.show();
  }

  private toggle(): void {
    this.begunMs = this.begunMs === null ? performance.now() : null;
    this.show();
  }

  private show(): void {
    this.play.disabled = this.strokes.every(({ empty }) => empty);
    setText(this.play, this.begunMs === null ? "Play" : "Stop playing");
    this.curves.forEach((curve, joint) => {
      curve.setAttribute("points", this.strokes[joint]!.angles.flatMap((angle, column) => angle === null ? [] :
        [`${((column / (COLUMNS - 1)) * WIDTH).toFixed(1)},${(HEIGHT * (1 - shareOf(this.limits, joint, angle))).toFixed(1)}`]).join(" "));
    });
  }

  /** Leads where the drawing is now; to be called for each picture. */
  frame(): void {
    const share = this.begunMs === null ? 0 : Math.min(1, (performance.now() - this.begunMs) / 1000 / this.durationS);
    for (const end of ["x1", "x2"]) this.now.setAttribute(end, String(share * WIDTH));
    if (this.begunMs === null) return;
    this.strokes.forEach((stroke, joint) => {
      const angle = stroke.at(share);
      if (angle !== null) this.leaderControl.take(joint, angle);
    });
    if (share >= 1) this.toggle();
  }
}
