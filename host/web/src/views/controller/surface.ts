// The control surface of one joint: what the law gives for each error and change, where the arm is on it, which rules fire.

import { el, setText } from "../../parts/dom";
import { colours, isDark, themeChanged } from "../../parts/theme";
import { TICKS_A_SECOND, type Samples } from "../../session/samples";
import { infer, inputs, RULES, type Inference, type Settings } from "../../session/law";

const CELLS = 72; // a side
const SIZE = 288; // pixels
const OUTPUTS = ["NU", "ZU", "PU"];
const ERROR_SETS = ["NE", "ZE", "PE"];
const CHANGE_SETS = ["NCE", "ZCE", "PCE"];
// Red, green, blue of -Ku, 0 and +Ku.
const LIGHT = { negative: [0, 103, 168], nothing: [246, 246, 246], positive: [208, 92, 0] };
const DARK = { negative: [91, 184, 240], nothing: [28, 42, 50], positive: [240, 154, 62] };
const TRAIL = 200; // points

export type Point = { readonly x: number; readonly y: number };

const SHOWN_TICKS = TICKS_A_SECOND;
const EVERY = 5;

/** x and y of the last second of one joint by the settings that run, oldest first. */
export function operatingPoints(samples: Samples, joint: number, settings: Settings, periodMs: number): Point[] {
  const back = settings.ce_ticks * periodMs;
  const first = Math.max(samples.first + back, samples.end - SHOWN_TICKS);
  const points: Point[] = [];
  for (let number = samples.end - 1; number >= first; number -= EVERY) {
    const error = samples.value(number, "error", joint);
    const change = error - samples.value(number - back, "error", joint);
    const [x, y] = inputs(error, change, settings, periodMs);
    points.push({ x, y });
  }
  return points.reverse();
}

export class Surface {
  readonly element: HTMLElement;
  private readonly field = el("canvas", { attrs: { "aria-hidden": "true" } });
  private readonly over = el("canvas", { attrs: { "aria-hidden": "true" } });
  private readonly words = el("p", { class: "quiet" });
  private readonly cells: HTMLTableCellElement[][];
  private settings: Settings | null = null;

  constructor() {
    this.field.width = this.field.height = CELLS;
    this.over.width = this.over.height = SIZE;
    this.cells = RULES.map((row) => row.map((output) => el("td", { class: "rule" }, OUTPUTS[output + 1]!)));
    const head = el("tr", {}, el("td"), ...CHANGE_SETS.map((name) => el("th", { attrs: { scope: "col" } }, name)));
    const body = this.cells.map((row, i) => el("tr", {}, el("th", { attrs: { scope: "row" } }, ERROR_SETS[i]!), ...row));
    this.element = el("div", { class: "surface" },
      el("figure", {},
        el("div", { class: "field" }, this.field, this.over),
        el("figcaption", { class: "quiet" }, "error → right, change of error ↑, blue −Ku to orange +Ku")),
      el("div", {}, el("table", { class: "rules", attrs: { "aria-label": "Rules, and which fire now" } },
        el("thead", {}, head), el("tbody", {}, ...body)), this.words));
    themeChanged.on(() => {
      if (this.settings) this.show(this.settings);
    });
  }

  /** Draws the surface of these settings. */
  show(settings: Settings): void {
    this.settings = settings;
    const { negative, nothing, positive } = isDark() ? DARK : LIGHT;
    const context = this.field.getContext("2d")!;
    const image = context.createImageData(CELLS, CELLS);
    for (let row = 0; row < CELLS; row++) {
      for (let column = 0; column < CELLS; column++) {
        const u = infer(middle(column), -middle(row), settings).u;
        const tone = Math.round(Math.abs(u) * 12) / 12; // steps show the contours
        const end = u < 0 ? negative : positive;
        const at = 4 * (row * CELLS + column);
        for (let part = 0; part < 3; part++) image.data[at + part] = nothing[part]! + tone * (end[part]! - nothing[part]!);
        image.data[at + 3] = 255;
      }
    }
    context.putImageData(image, 0, 0);
  }

  /** Draws where the arm is, the newest point last, and the rules that fire there. */
  showPoints(points: readonly Point[], settings: Settings): void {
    const context = this.over.getContext("2d")!;
    context.clearRect(0, 0, SIZE, SIZE);
    const shown = points.slice(-TRAIL);
    const { ink } = colours();
    context.strokeStyle = ink;
    context.globalAlpha = 0.6;
    context.lineWidth = 1.5;
    context.beginPath();
    for (const { x, y } of shown) context.lineTo(place(x), place(-y));
    context.stroke();
    context.globalAlpha = 1;
    const now = shown.at(-1);
    if (now) {
      context.fillStyle = ink;
      context.beginPath();
      context.arc(place(now.x), place(-now.y), 5, 0, 2 * Math.PI);
      context.fill();
      context.strokeStyle = isDark() ? "#000" : "#fff";
      context.stroke();
    }
    this.showRules(now ? infer(now.x, now.y, settings) : null, now);
  }

  private showRules(inference: Inference | null, now: Point | undefined): void {
    this.cells.forEach((row, i) => row.forEach((cell, j) => {
      const strength = inference ? inference.rules[i]![j]! : 0;
      cell.dataset["fires"] = strength > 0 ? "yes" : "no";
      cell.style.setProperty("--strength", strength.toFixed(2));
      setText(cell, `${OUTPUTS[RULES[i]![j]! + 1]!}${strength > 0 ? ` ${strength.toFixed(2)}` : ""}`);
    }));
    setText(this.words, inference && now
      ? `x ${now.x.toFixed(3)}, y ${now.y.toFixed(3)}, u ${inference.u.toFixed(3)}`
      : "No sample yet.");
  }
}

function middle(cell: number): number {
  return ((cell + 0.5) / CELLS) * 2 - 1;
}

function place(value: number): number {
  return ((value + 1) / 2) * SIZE;
}
