// A small picture of curves over one quantity; costs, which may span decades, on a logarithmic height.

import { svg } from "./dom";

/** `shade` is a colour of page.css by its name, such as joint-0. */
export type Curve = { readonly x: readonly number[]; readonly y: readonly number[]; readonly shade: string };

const HEIGHT = 150;
const MARGIN = { left: 56, right: 10, top: 8, bottom: 22 };
const TITLE = 18; // the height of a title's line
const DECADES = 5; // a larger ratio is drawn by its logarithm

/** A picture with a title has plain heights, which span `least` at least: smaller changes are to look small. */
type Look = { readonly width?: number; readonly title?: string; readonly least?: number };

export function curvesPicture(
  label: string, unit: string, curves: readonly Curve[], { width = 480, title = "", least = 0 }: Look = {},
): SVGSVGElement {
  const heights = curves.flatMap(({ y }) => y);
  const missing = Math.max(0, least - (Math.max(...heights) - Math.min(...heights))) / 2;
  const [low, high] = [Math.min(...heights) - missing, Math.max(...heights) + missing];
  const end = Math.max(...curves.map(({ x }) => x.at(-1) ?? 0)) || 1;
  const scale = !title && low > 0 && high > DECADES * low ? Math.log10 : (value: number): number => value;
  const room = scale(high) - scale(low) || 1;
  const top = MARGIN.top + (title ? TITLE : 0);
  const across = (x: number): number => MARGIN.left + (x / end) * (width - MARGIN.left - MARGIN.right);
  const up = (y: number): number => HEIGHT - MARGIN.bottom - ((scale(y) - scale(low)) / room) * (HEIGHT - MARGIN.bottom - top);
  const digits = (y: number): string => String(Number(title ? y.toFixed(2) : y.toPrecision(3)));
  const text = (x: number, y: number, words: string, anchor: string): SVGElement =>
    svg("text", { x, y, class: "tick", "text-anchor": anchor }, words);
  return svg("svg", { viewBox: `0 0 ${width} ${HEIGHT}`, class: "curves", role: "img", "aria-label": label },
    ...(title ? [text(MARGIN.left, TITLE - 5, title, "start")] : []),
    ...[...new Set([low, high])].flatMap((y) => [
      svg("line", { x1: MARGIN.left, x2: width - MARGIN.right, y1: up(y), y2: up(y), class: "base" }),
      text(MARGIN.left - 6, up(y) + 4, digits(y), "end"),
    ]),
    text(MARGIN.left, HEIGHT - 5, "0", "start"),
    text(width - MARGIN.right, HEIGHT - 5, `${Number(end.toPrecision(3))} ${unit}`, "end"),
    ...curves.map(({ x, y, shade }) => svg("polyline", {
      points: x.map((at, place) => `${across(at).toFixed(1)},${up(y[place]!).toFixed(1)}`).join(" "), class: `curve ${shade}`,
    })));
}
