// The three fuzzy sets of one input as a picture whose corners can be dragged, or moved by the arrow keys.

import { upperFirst } from "../../link/refusal";
import { onDrag, svg } from "../../parts/dom";
import { cornerRange, SET_UNIT, type SetName, type Settings } from "../../session/law";

const WIDTH = 520;
const HEIGHT = 132;
const MARGIN = { left: 14, right: 14, top: 20, bottom: 22 };
const STEP = 164; // 0.01
const FINE_STEP = 16;

export type Corners = readonly [negative: SetName, left: SetName, right: SetName, positive: SetName];
export const ERROR_CORNERS: Corners = ["ne_c", "ze_a", "ze_c", "pe_b"];
export const CHANGE_CORNERS: Corners = ["nce_c", "zce_a", "zce_c", "pce_b"];

function xOf(raw: number): number {
  return MARGIN.left + ((raw / SET_UNIT + 1) / 2) * (WIDTH - MARGIN.left - MARGIN.right);
}

function yOf(membership: number): number {
  return HEIGHT - MARGIN.bottom - membership * (HEIGHT - MARGIN.top - MARGIN.bottom);
}

export class SetsEditor {
  readonly element: SVGSVGElement;
  private readonly shapes = ["negative", "zero", "positive"].map((part) => svg("polygon", { class: `set set-${part}` }));
  private readonly handles: Map<SetName, SVGGElement>;
  private readonly point = svg("line", { class: "operating", y1: yOf(0), y2: yOf(1) });

  constructor(
    title: string, labels: readonly string[], private readonly corners: Corners,
    private readonly moved: (name: SetName, raw: number, grip: string) => void, private readonly letGo: () => void,
  ) {
    const ticks = [-1, -0.5, 0, 0.5, 1].map((value) =>
      svg("text", { class: "tick", x: xOf(value * SET_UNIT), y: HEIGHT - 6, "text-anchor": "middle" }, String(value)));
    const names = labels.map((label, place) =>
      svg("text", { class: "set-name", x: xOf((place - 1) * 0.93 * SET_UNIT), y: 13, "text-anchor": "middle" }, label));
    this.handles = new Map(corners.map((name) => [name, this.handle(name)]));
    this.element = svg("svg", { class: "sets", viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "group", "aria-label": title },
      svg("line", { class: "base", x1: xOf(-SET_UNIT), x2: xOf(SET_UNIT), y1: yOf(0), y2: yOf(0) }),
      ...ticks, ...names, ...this.shapes, this.point, ...this.handles.values());
  }

  private handle(name: SetName): SVGGElement {
    const [least, most] = cornerRange(name);
    const handle = svg("g", {
      class: "handle", tabindex: 0, role: "slider", "aria-label": upperFirst(name), // the paper's name: Ne_c
      "aria-valuemin": least / SET_UNIT, "aria-valuemax": most / SET_UNIT,
    }, svg("circle", { class: "reach", r: 16 }), svg("circle", { class: "knob", r: 6 }));
    onDrag(handle, (event) => {
      handle.focus();
      event.preventDefault();
    }, ({ clientX }) => this.move(name, this.rawAt(clientX), name));
    handle.addEventListener("pointerup", this.letGo);
    handle.addEventListener("keydown", (event) => {
      const sign = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
      if (!sign) return;
      event.preventDefault();
      event.stopPropagation();
      const now = Number(handle.dataset["raw"]);
      this.move(name, now + sign * (event.shiftKey ? FINE_STEP : STEP), "");
    });
    return handle;
  }

  private rawAt(clientX: number): number {
    const box = this.element.getBoundingClientRect();
    const x = ((clientX - box.left) / box.width) * WIDTH;
    return (((x - MARGIN.left) / (WIDTH - MARGIN.left - MARGIN.right)) * 2 - 1) * SET_UNIT;
  }

  private move(name: SetName, raw: number, grip: string): void {
    const [least, most] = cornerRange(name);
    this.moved(name, Math.round(Math.max(least, Math.min(most, raw))), grip);
  }

  show(settings: Settings): void {
    const [n, left, right, p] = this.corners.map((name) => settings[name]) as [number, number, number, number];
    const end = SET_UNIT;
    const outlines = [
      [[-end, 0], [-end, 1], [n, 1], [0, 0]], [[left, 0], [0, 1], [right, 0]], [[0, 0], [p, 1], [end, 1], [end, 0]],
    ];
    outlines.forEach((points, place) => this.shapes[place]!.setAttribute(
      "points", points.map(([raw, membership]) => `${xOf(raw!)},${yOf(membership!)}`).join(" ")));
    this.corners.forEach((name, place) => {
      const handle = this.handles.get(name)!;
      const raw = settings[name];
      handle.setAttribute("transform", `translate(${xOf(raw)} ${yOf(place === 0 || place === 3 ? 1 : 0)})`);
      handle.setAttribute("aria-valuenow", String(Number((raw / SET_UNIT).toFixed(4))));
      handle.dataset["raw"] = String(raw);
    });
  }

  /** The place of the running arm now, -1..1. */
  showPoint(x: number | null): void {
    this.point.style.display = x === null ? "none" : "";
    if (x === null) return;
    const at = String(xOf(x * SET_UNIT));
    this.point.setAttribute("x1", at);
    this.point.setAttribute("x2", at);
  }
}
