// The sets of a tuning, before and after, of every joint: the error's above those of its change.

import { el, svg } from "../../parts/dom";
import { objectIn, type Json } from "../../session/services";

const WIDTH = 240;
const HEIGHT = 46;
const EDGE = 3; // beside what is drawn

type Corners = readonly [negative: number, zeroBegins: number, zeroEnds: number, positive: number];
const INPUTS = {
  error: ["ne_c", "ze_a", "ze_c", "pe_b"],
  change: ["nce_c", "zce_a", "zce_c", "pce_b"],
} as const;
type Controllers = { readonly [name: string]: Json };

/** Pictures of the sets in a result, none where it has no controllers before and after. */
export function setsPictures(result: { readonly [key: string]: Json }): HTMLElement[] {
  const before = objectIn(result["before"]);
  const after = objectIn(result["after"]);
  const joints = [...new Set(Object.keys(after).map((name) => name.split(".")[0]!))];
  const pictures = joints.flatMap((joint) => {
    const pairs = Object.values(INPUTS).map((names) => [corners(before, joint, names), corners(after, joint, names)] as const);
    return pairs.every(([was, now]) => was && now) ? [jointSets(joint, pairs as [Corners, Corners][])] : [];
  });
  if (!pictures.length) return [];
  const caption = el("figcaption", { class: "quiet" }, "Sets of the error, and of its change below: ",
    el("span", { class: "key key-leader" }), " before  ", el("span", { class: "key key-accent" }), " after");
  return [el("figure", { class: "motions" }, caption, ...pictures)];
}

function corners(controllers: Controllers, joint: string, names: readonly string[]): Corners | null {
  const values = names.map((name) => controllers[`${joint}.${name}`]);
  return values.every((one) => typeof one === "number") ? (values as unknown as Corners) : null;
}

function jointSets(joint: string, pairs: readonly (readonly [Corners, Corners])[]): SVGSVGElement {
  const name = joint.replace("joint", "joint ");
  const title = svg("text", { x: EDGE, y: 12, class: "tick" }, name);
  const drawn = pairs.flatMap(([before, after], row) => {
    const foot = 16 + (row + 1) * (HEIGHT + EDGE);
    return [
      svg("line", { x1: EDGE, x2: WIDTH - EDGE, y1: foot, y2: foot, class: "base" }),
      ...lines(before).map((points) => line(points, foot, "leader")),
      ...lines(after).map((points) => line(points, foot, "accent")),
    ];
  });
  const height = 18 + pairs.length * (HEIGHT + EDGE);
  return svg("svg", { viewBox: `0 0 ${WIDTH} ${height}`, class: "curves", role: "img", "aria-label": `Sets of ${name}, before and after` },
    title, ...drawn);
}

type Point = readonly [place: number, height: number];

/** The three sets from -1 to 1, as high as 1. */
function lines([negative, zeroBegins, zeroEnds, positive]: Corners): readonly (readonly Point[])[] {
  return [
    [[-1, 1], [negative, 1], [0, 0]],
    [[zeroBegins, 0], [0, 1], [zeroEnds, 0]],
    [[0, 0], [positive, 1], [1, 1]],
  ];
}

function line(points: readonly Point[], foot: number, shade: string): SVGPolylineElement {
  const across = (place: number): number => EDGE + ((place + 1) / 2) * (WIDTH - 2 * EDGE);
  const text = points.map(([place, height]) => `${across(place).toFixed(1)},${(foot - height * (HEIGHT - EDGE)).toFixed(1)}`).join(" ");
  return svg("polyline", { points: text, class: `curve ${shade}` });
}
