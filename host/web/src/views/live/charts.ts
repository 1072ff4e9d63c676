// Charts over one span of time: angles, errors, voltages, of one source of samples or of several over each other.
// They draw what a Picture of each source holds, and share one cursor.

import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { el } from "../../parts/dom";
import { colours, type Colours } from "../../parts/theme";
import { draw, emptyPicture, type Picture } from "../../session/picture";
import { JOINTS, TICKS_A_SECOND, traceOf, type Quantity, type Samples } from "../../session/samples";
import type { TimeWindow } from "./window";
import { ZOOM_STEP } from "./window";

type Plan = { readonly title: string; readonly unit: string; readonly of: readonly Quantity[]; readonly least: number };

const PLANS: readonly Plan[] = [
  { title: "Angle", unit: "rad", of: ["leader", "follower"], least: 0.1 },
  { title: "Error", unit: "rad", of: ["error"], least: 0.01 },
  { title: "Voltage", unit: "V", of: ["voltage"], least: 1 },
];
const PIXELS_A_COLUMN = 1.5;

/** A part of the charts: the one that shows how a joint follows, as low as may stand beside other things. */
export const ANGLE_ALONE: Look = { plans: PLANS.slice(0, 1), heights: [128] };
const WHOLE: Look = { plans: PLANS, heights: [230, 150, 150] };
const NARROW_HEIGHTS = [170, 120, 120]; // at most, where it is narrow
type Look = { readonly plans: readonly Plan[]; readonly heights: readonly number[] };

/** Samples to draw, and the colours of their joints. */
export type Layer = { readonly samples: Samples; readonly shade: (shades: Colours, joint: number) => string };

export class Charts {
  private static made = 0;
  readonly element = el("div", { class: "charts" });
  /** Time under the cursor in ticks, null while it is elsewhere. */
  cursor: number | null = null;
  private readonly sync = uPlot.sync(`charts-${Charts.made++}`).key;
  private pictures: Picture[] = [];
  private plots: { plot: uPlot; traces: readonly number[] }[] = [];
  private readonly shown = new Array<boolean>(JOINTS).fill(true);

  constructor(private layers: readonly Layer[], private readonly window: TimeWindow, private readonly look = WHOLE) {
    new ResizeObserver(() => this.resize()).observe(this.element);
  }

  /** True if the last picture shows each sample. */
  get exact(): boolean {
    return this.pictures.every((picture) => picture.exact);
  }

  lay(layers: readonly Layer[]): void {
    this.layers = layers;
    this.rebuild();
  }

  showJoint(joint: number, shown: boolean): void {
    this.shown[joint] = shown;
    this.rebuild();
  }

  /** Shows this joint alone. */
  showOnly(joint: number): void {
    this.shown.fill(false);
    this.showJoint(joint, true);
  }

  /** Makes the charts anew, as after a change of colours. */
  rebuild(): void {
    for (const { plot } of this.plots) plot.destroy();
    this.element.replaceChildren();
    const shades = colours();
    this.pictures = this.layers.map(emptyPicture);
    const { plans } = this.look;
    this.plots = plans.map((plan, place) => {
      const traces = plan.of.flatMap((quantity) =>
        [...this.shown.keys()].filter((joint) => this.shown[joint]).map((joint) => traceOf(quantity, joint)));
      const frame = el("section", { class: "chart", attrs: { "aria-label": `${plan.title} in ${plan.unit}` } },
        el("h3", {}, `${plan.title} `, el("span", { class: "unit" }, plan.unit)));
      this.element.append(frame);
      const plot = new uPlot(
        this.options(plan, traces, shades, place === plans.length - 1),
        [[], ...this.layers.flatMap(() => traces.map(() => []))], frame,
      );
      this.wire(plot);
      return { plot, traces };
    });
    this.resize();
  }

  private options(plan: Plan, traces: readonly number[], shades: Colours, last: boolean): uPlot.Options {
    const axis = {
      stroke: shades.quiet,
      grid: { stroke: shades.line, width: 1 },
      ticks: { stroke: shades.line, width: 1, size: 4 },
      font: "12px system-ui, sans-serif",
    };
    return {
      width: 600,
      height: 180,
      legend: { show: false },
      cursor: {
        sync: { key: this.sync }, drag: { x: true, y: false, setScale: false }, points: { show: false },
      },
      scales: {
        x: { time: false, range: () => [this.window.begin / TICKS_A_SECOND, this.window.end / TICKS_A_SECOND] },
        y: { range: (_plot, low, high) => roomFor(low, high, plan.least) },
      },
      axes: [
        { ...axis, size: last ? 30 : 8, values: last ? (_plot, ticks) => ticks.map(timeText) : () => [] },
        { ...axis, size: 54, space: 24 },
      ],
      series: [{}, ...this.layers.flatMap(({ shade }) => traces.map((trace) => ({
        stroke: shade(shades, trace % JOINTS),
        width: trace < JOINTS ? 1 : 1.5,
        ...(trace < JOINTS ? { dash: [5, 4] } : {}),
        points: { show: false },
        spanGaps: false,
      })))],
      hooks: {
        setCursor: [(plot) => {
          const { left } = plot.cursor;
          this.cursor = left === undefined || left < 0 ? null : plot.posToVal(left, "x") * TICKS_A_SECOND;
        }],
        setSelect: [(plot) => {
          const { left, width } = plot.select;
          if (width > 3) {
            this.window.show(plot.posToVal(left, "x") * TICKS_A_SECOND, plot.posToVal(left + width, "x") * TICKS_A_SECOND);
          }
          plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
        }],
      },
    };
  }

  private wire(plot: uPlot): void {
    plot.over.addEventListener("wheel", (event) => {
      event.preventDefault();
      if (event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY)) {
        this.window.pan(Math.sign(event.deltaX || event.deltaY) * 0.1);
      } else {
        const about = plot.posToVal(event.offsetX, "x") * TICKS_A_SECOND;
        this.window.zoom(event.deltaY > 0 ? ZOOM_STEP : 1 / ZOOM_STEP, about);
      }
    }, { passive: false });
    plot.over.addEventListener("dblclick", () => this.window.follow());
  }

  private resize(): void {
    const width = Math.floor(this.element.clientWidth);
    if (!width) return;
    const narrow = width < 560;
    this.plots.forEach(({ plot }, place) => {
      const usual = this.look.heights[place]!;
      const height = narrow ? Math.min(usual, NARROW_HEIGHTS[place]!) : usual;
      plot.setSize({ width, height: place === this.plots.length - 1 ? height + 22 : height });
    });
  }

  /** Draws the window as it is now. */
  draw(): void {
    const width = this.plots[0]?.plot.bbox.width ?? 0;
    if (!width || !this.layers.length) return;
    const columns = Math.floor(width / devicePixelRatio / PIXELS_A_COLUMN);
    this.layers.forEach(({ samples }, place) =>
      draw(samples, this.window.begin, this.window.end, columns, this.pictures[place]!));
    for (const { plot, traces } of this.plots) {
      const tables = this.pictures.map(({ x, y }): uPlot.AlignedData => [x, ...traces.map((trace) => y[trace]!)]);
      plot.setData(tables.length === 1 ? tables[0]! : uPlot.join(tables));
    }
  }
}

function timeText(seconds: number): string {
  return `${Number(seconds.toFixed(3))} s`;
}

/** A range with some room that moves in steps, so that a noisy signal does not shake the axis. */
function roomFor(low: number | null, high: number | null, least: number): [number, number] {
  if (low === null || high === null || !Number.isFinite(low)) return [-least, least];
  const span = Math.max(high - low, least);
  const step = 2 ** Math.floor(Math.log2(span / 4));
  const bottom = Math.floor((low - 0.05 * span) / step) * step;
  const top = Math.ceil((high + 0.05 * span) / step) * step;
  return [bottom, top];
}
