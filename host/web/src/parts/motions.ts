// A small picture of how one joint follows: each follower, the last one in the joint's colour, and the
// leader dashed over them.

import { el } from "./dom";
import { colours } from "./theme";

type Motion = readonly (readonly number[])[]; // rows of four joints

const WIDTH = 300;
const HEIGHT = 150;
const MARGIN = { left: 40, right: 8, top: 8, bottom: 20 };
const LEAST_LABEL = 50; // pixels between two labels of the time

export function motionCanvas(label: string): HTMLCanvasElement {
  const element = el("canvas", { attrs: { role: "img", "aria-label": label } });
  element.width = 2 * WIDTH;
  element.height = 2 * HEIGHT;
  return element;
}

export function paintMotions(
  canvas: HTMLCanvasElement, times: readonly number[], [leader, ...followers]: readonly Motion[], joint: number,
): void {
  const shades = colours();
  const context = canvas.getContext("2d")!;
  context.setTransform(2, 0, 0, 2, 0, 0);
  context.clearRect(0, 0, WIDTH, HEIGHT);
  const traces = [leader!, ...followers].map((rows) => rows.map((row) => row[joint]!));
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
  const apart = [0.5, 1, 2, 5].find((seconds) => x(seconds) - x(0) > LEAST_LABEL) ?? end;
  for (let time = 0; time <= end; time += apart) context.fillText(`${Number(time.toFixed(2))} s`, Math.min(x(time), WIDTH - 18), HEIGHT - 5);
  const draw = (values: readonly number[], shade: string, width: number, dash: readonly number[] = []): void => {
    context.strokeStyle = shade;
    context.lineWidth = width;
    context.setLineDash([...dash]);
    line(context, values.map((value, row) => [x(times[row]!), y(value)]));
  };
  const [led, ...followed] = traces;
  followed.forEach((values, place) => {
    const last = place === followed.length - 1;
    draw(values, last ? shades.joints[joint]! : shades.quiet, last ? 2.4 : 1.2);
  });
  draw(led!, shades.ink, 1.2, [5, 4]);
  context.setLineDash([]);
}

function line(context: CanvasRenderingContext2D, points: readonly (readonly [number, number])[]): void {
  context.beginPath();
  for (const [x, y] of points) context.lineTo(x, y);
  context.stroke();
}
