// A motion of the leader that a person draws: angle over time, joint by joint, played as by a hand.

import { button, el, select, setText, svg } from "../parts/dom";
import type { BenchControls } from "../host";
import { JOINTS } from "../samples/samples";
import type { LeaderHand } from "./hand";

const COLUMNS = 120;
const WIDTH = 480;
const HEIGHT = 160;
const DURATIONS_S = [2, 4, 8, 16];

/** Angles at each column of the picture; null where nothing is drawn yet. */
type Drawing = (number | null)[];

export class DrawnMotion {
  readonly element: HTMLElement;
  private readonly drawings: Drawing[] = Array.from({ length: JOINTS }, () => new Array<number | null>(COLUMNS).fill(null));
  private readonly curves = this.drawings.map((_, joint) => svg("polyline", { class: `curve joint-${joint}` }));
  private readonly now = svg("line", { y1: 0, y2: HEIGHT, class: "base" });
  private readonly picture = svg("svg", {
    viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: "curves drawn", role: "img", "aria-label": "Drawn motion: angle over time",
  }, this.now, ...this.curves);
  private readonly play = button("Play", () => this.toggle());
  private joint = 0;
  private lastColumn: number | null = null;
  private durationS = DURATIONS_S[1]!;
  private begunMs: number | null = null;

  constructor(names: readonly string[], private readonly hand: LeaderHand, private readonly limits: BenchControls["leader"]) {
    const joint = select("Joint to draw", names.map((name, place) => [String(place), `${place} ${name}`] as const),
      (chosen) => { this.joint = Number(chosen); });
    const duration = select("Duration", DURATIONS_S.map((s) => [String(s), `${s} s`] as const),
      (chosen) => { this.durationS = Number(chosen); });
    duration.value = String(this.durationS);
    this.element = el("section", { class: "card" }, el("h2", {}, "Draw a motion"),
      el("div", { class: "row" }, joint, duration, this.play, button("Clear", () => this.clear())),
      this.picture,
      el("p", { class: "quiet" }, "Drag from left to right; the highest and lowest angles are the leader's limits."));
    this.wire();
    this.show();
  }

  private wire(): void {
    this.picture.addEventListener("pointerdown", (event) => {
      this.picture.setPointerCapture(event.pointerId);
      this.lastColumn = null;
      this.drawTo(event);
    });
    this.picture.addEventListener("pointermove", (event) => {
      if (this.picture.hasPointerCapture(event.pointerId)) this.drawTo(event);
    });
  }

  /** Draws a straight line from the last place to this one. */
  private drawTo(event: PointerEvent): void {
    const box = this.picture.getBoundingClientRect();
    const share = (at: number): number => Math.max(0, Math.min(1, at));
    const column = Math.round(share((event.clientX - box.left) / box.width) * (COLUMNS - 1));
    const low = this.limits.minimum[this.joint]!;
    const angle = low + (1 - share((event.clientY - box.top) / box.height)) * (this.limits.maximum[this.joint]! - low);
    const drawing = this.drawings[this.joint]!;
    const from = this.lastColumn ?? column;
    const first = this.lastColumn === null ? angle : drawing[from]!;
    for (let at = Math.min(from, column); at <= Math.max(from, column); at++) {
      drawing[at] = from === column ? angle : first + ((angle - first) * (at - from)) / (column - from);
    }
    this.lastColumn = column;
    this.show();
  }

  private clear(): void {
    for (const drawing of this.drawings) drawing.fill(null);
    this.begunMs = null;
    this.show();
  }

  private toggle(): void {
    this.begunMs = this.begunMs === null ? performance.now() : null;
    this.show();
  }

  private show(): void {
    this.play.disabled = this.drawings.every((drawing) => drawing.every((angle) => angle === null));
    setText(this.play, this.begunMs === null ? "Play" : "Stop playing");
    this.curves.forEach((curve, joint) => {
      const [low, high] = [this.limits.minimum[joint]!, this.limits.maximum[joint]!];
      curve.setAttribute("points", this.drawings[joint]!.flatMap((angle, column) => angle === null ? [] :
        [`${((column / (COLUMNS - 1)) * WIDTH).toFixed(1)},${(HEIGHT * (high - angle) / (high - low)).toFixed(1)}`]).join(" "));
    });
  }

  /** Leads where the drawing is now; to be called for each picture. */
  frame(): void {
    const share = this.begunMs === null ? 0 : (performance.now() - this.begunMs) / 1000 / this.durationS;
    for (const end of ["x1", "x2"]) this.now.setAttribute(end, String(Math.min(1, share) * WIDTH));
    if (this.begunMs === null) return;
    this.drawings.forEach((drawing, joint) => {
      const angle = angleAt(drawing, Math.min(1, share) * (COLUMNS - 1));
      if (angle !== null) this.hand.take(joint, angle);
    });
    if (share >= 1) this.toggle();
  }
}

/** The drawn angle nearest to a column; null where nothing is drawn. */
function angleAt(drawing: Drawing, column: number): number | null {
  let nearest: number | null = null;
  let distance = Infinity;
  drawing.forEach((angle, at) => {
    if (angle !== null && Math.abs(at - column) < distance) [nearest, distance] = [angle, Math.abs(at - column)];
  });
  return nearest;
}
