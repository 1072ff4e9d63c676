// A small picture of curves over one quantity, on a logarithmic height where they span decades.

import { svg } from "./dom";

/** `shade` is a colour of page.css by its name, such as joint-0. */
export type Curve = { readonly x: readonly number[]; readonly y: readonly number[]; readonly shade: string };

const WIDTH = 480;
const HEIGHT = 150;
const MARGIN = { left: 56, right: 10, top: 8, bottom: 22 };
const DECADES = 5; // a larger ratio is drawn by its logarithm

export function curvesPicture(label: string, unit: string, curves: readonly Curve[]): SVGSVGElement {
  const heights = curves.flatMap(({ y }) => y);
  const [low, high] = [Math.min(...heights), Math.max(...heights)];
  const end = Math.max(...curves.map(({ x }) => x.at(-1) ?? 0)) || 1;
  const scale = low > 0 && high > DECADES * low ? Math.log10 : (value: number): number => value;
  const room = scale(high) - scale(low) || 1;
  const across = (x: number): number => MARGIN.left + (x / end) * (WIDTH - MARGIN.left - MARGIN.right);
  const up = (y: number): number =>
    HEIGHT - MARGIN.bottom - ((scale(y) - scale(low)) / room) * (HEIGHT - MARGIN.top - MARGIN.bottom);
  const text = (x: number, y: number, words: string, anchor: string): SVGElement =>
    svg("text", { x, y, class: "tick", "text-anchor": anchor }, words);
  return svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: "curves", role: "img", "aria-label": label },
    ...[...new Set([low, high])].flatMap((y) => [
      svg("line", { x1: MARGIN.left, x2: WIDTH - MARGIN.right, y1: up(y), y2: up(y), class: "base" }),
      text(MARGIN.left - 6, up(y) + 4, String(Number(y.toPrecision(3))), "end"),
    ]),
    text(MARGIN.left, HEIGHT - 5, "0", "start"),
    text(WIDTH - MARGIN.right, HEIGHT - 5, `${Number(end.toPrecision(3))} ${unit}`, "end"),
    ...curves.map(({ x, y, shade }) => svg("polyline", {
      points: x.map((at, place) => `${across(at).toFixed(1)},${up(y[place]!).toFixed(1)}`).join(" "), class: `curve ${shade}`,
    })));
}
