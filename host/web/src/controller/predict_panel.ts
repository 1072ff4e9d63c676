// What the model predicts for a step and a reach with the edited controllers: asked anew while a person drags.

import { el, setText } from "../parts/dom";
import { colours } from "../parts/theme";
import type { Host, Predicted, Prediction } from "../host";

const WIDTH = 300;
const HEIGHT = 150;
const MARGIN = { left: 40, right: 8, top: 8, bottom: 20 };

export class PredictPanel {
  readonly element: HTMLElement;
  private readonly pictures = {
    step: { canvas: canvas("Predicted step"), words: el("span", { class: "quiet" }) },
    reach: { canvas: canvas("Predicted reach"), words: el("span", { class: "quiet" }) },
  };
  private readonly problem = el("p", { class: "problem", attrs: { role: "status" } });
  private wanted: { raw: readonly number[]; board: number } | null = null;
  private busy = false;
  private joint = 0;
  private last: Prediction | null = null;

  constructor(private readonly host: Host) {
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
        this.last = await this.host.predict(raw, board);
        setText(this.problem, "");
      } catch (error) {
        setText(this.problem, error instanceof Error ? error.message : String(error));
      }
      this.draw();
    }
    this.busy = false;
  }

  draw(): void {
    if (!this.last) return;
    for (const kind of ["step", "reach"] as const) {
      const { canvas, words } = this.pictures[kind];
      paint(canvas, this.last[kind], this.joint);
      const rms = Math.sqrt(this.last[kind].mse[this.joint]!);
      setText(words, `error rms ${(1000 * rms).toFixed(1)} mrad`);
    }
    this.element.dataset["rms"] = String(Math.sqrt(this.last.step.mse[this.joint]!));
  }
}

function canvas(label: string): HTMLCanvasElement {
  const element = el("canvas", { attrs: { role: "img", "aria-label": label } });
  element.width = 2 * WIDTH;
  element.height = 2 * HEIGHT;
  return element;
}

function paint(canvas: HTMLCanvasElement, motion: Predicted, joint: number): void {
  const shades = colours();
  const context = canvas.getContext("2d")!;
  context.setTransform(2, 0, 0, 2, 0, 0);
  context.clearRect(0, 0, WIDTH, HEIGHT);
  const times = motion.time_s;
  const traces = [motion.leader, motion.follower].map((rows) => rows.map((row) => row[joint]!));
  const all = traces.flat();
  const [low, high] = [Math.min(...all), Math.max(...all)];
  const room = Math.max(high - low, 0.05);
  const end = times.at(-1) ?? 1;
  const x = (time: number): number => MARGIN.left + (time / end) * (WIDTH - MARGIN.left - MARGIN.right);
  const y = (value: number): number =>
    HEIGHT - MARGIN.bottom - ((value - low) / room) * (HEIGHT - MARGIN.top - MARGIN.bottom);
  context.font = "11px system-ui, sans-serif";
  context.fillStyle = shades.quiet;
  context.strokeStyle = shades.line;
  context.textAlign = "right";
  for (const value of [low, low + room / 2, low + room]) {
    context.fillText(value.toFixed(2), MARGIN.left - 6, y(value) + 4);
    line(context, [[x(0), y(value)], [x(end), y(value)]]);
  }
  context.textAlign = "center";
  for (let time = 0; time <= end; time += 0.5) context.fillText(`${Number(time.toFixed(2))} s`, Math.min(x(time), WIDTH - 18), HEIGHT - 5);
  traces.forEach((values, place) => {
    context.strokeStyle = place ? shades.joints[joint]! : shades.quiet;
    context.lineWidth = place ? 2 : 1.2;
    context.setLineDash(place ? [] : [5, 4]);
    line(context, values.map((value, row) => [x(times[row]!), y(value)]));
  });
  context.setLineDash([]);
}

function line(context: CanvasRenderingContext2D, points: readonly (readonly [number, number])[]): void {
  context.beginPath();
  for (const [x, y] of points) context.lineTo(x, y);
  context.stroke();
}
