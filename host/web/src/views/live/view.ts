// The live view: charts of every tick, what stands under the cursor, running measures, capture and export.

import { button, el, select, setText, tableHead } from "../../parts/dom";
import { themeChanged } from "../../parts/theme";
import type { View } from "../view";
import { JOINT_NAMES, QUANTITIES, QUANTITY_TITLES, TICKS_A_SECOND } from "../../session/samples";
import type { Session } from "../../session/session";
import { Charts } from "./charts";
import { EpisodesPanel } from "./episodes";
import { DOWNLOADS, keepLog, type Keeper } from "./keep";
import { MeasuresTable } from "./measures_table";
import { StatePanel } from "./state_panel";
import { moveByKey, timeButtons } from "./time_buttons";
import type { TorquePanel } from "./torque_panel";
import { TriggerPanel } from "./trigger_panel";
import { TimeWindow } from "./window";

const SPANS_S = [1, 2, 5, 10, 30, 60, 600];

export class LiveView implements View {
  readonly name = "Live";
  readonly element: HTMLElement;
  private readonly window: TimeWindow;
  private readonly charts: Charts;
  private readonly pause = button("Pause", () => this.window.toggle(), { title: "Pause or go on (P)" });
  private readonly span: HTMLSelectElement;
  private readonly resolution = el("span", { class: "quiet" });
  private readonly values: HTMLTableCellElement[][] = [];
  private readonly moment = el("th", { attrs: { scope: "col" } }, "joint");
  private readonly measures: MeasuresTable;
  private readonly trigger: TriggerPanel;
  private readonly episodes: EpisodesPanel;
  private readonly record: HTMLButtonElement;
  private recordedFrom: number | null = null; // sample

  /** `torque` tells torques from outside, where a host can. */
  constructor(private readonly session: Session, private readonly keeper: Keeper = DOWNLOADS, private readonly torque: TorquePanel | null = null) {
    this.record = button("Record", () => this.recordOrEnd(), { title: `Begin a log; its end ${keeper.where}` });
    this.window = new TimeWindow(session.samples);
    this.charts = new Charts([{ samples: session.samples, shade: (shades, joint) => shades.joints[joint]! }], this.window);
    this.measures = new MeasuresTable(session.samples);
    this.trigger = new TriggerPanel(session, this.window);
    this.episodes = new EpisodesPanel(session, keeper);
    this.span = select("Span shown", SPANS_S.map((s) => [String(s), s < 60 ? `${s} s` : `${s / 60} min`] as const),
      (seconds) => this.window.setSpan(Number(seconds) * TICKS_A_SECOND));
    this.element = el("div", { class: "live with-side" },
      el("div", { class: "live-main" }, this.tools(), this.charts.element, this.table()),
      el("aside", { class: "side" }, ...(torque ? [torque.element] : []), this.episodes.element, new StatePanel(session).element, this.measures.element, this.trigger.element));
    this.window.changed.on(() => this.showWindow());
    themeChanged.on(() => this.charts.rebuild());
    this.showWindow();
  }

  private tools(): HTMLElement {
    return el("div", { class: "tools", attrs: { role: "toolbar", "aria-label": "Time" } },
      this.pause,
      this.span,
      ...timeButtons(this.window),
      button("Save view", () => void this.session.attempt(() => this.export()), { title: `Makes a log of what is in view, and ${this.keeper.where}` }),
      this.record,
      this.resolution);
  }

  private table(): HTMLElement {
    const rows = JOINT_NAMES.map((name, joint) => {
      const cells = QUANTITIES.map(() => el("td", {}, "–"));
      this.values.push(cells);
      const box = el("input", { type: "checkbox", checked: true, on: {
        change: (event) => this.charts.showJoint(joint, (event.target as HTMLInputElement).checked),
      } });
      const label = el("label", {}, box, el("span", { class: `key key-${joint}` }), `${joint} `, el("span", { class: "wide" }, name));
      return el("tr", {}, el("th", { attrs: { scope: "row" } }, label), ...cells);
    });
    return el("table", { class: "values" }, tableHead(this.moment, ...QUANTITY_TITLES), el("tbody", {}, ...rows));
  }

  private showWindow(): void {
    setText(this.pause, this.window.live ? "Pause" : "Go on");
    this.pause.setAttribute("aria-pressed", String(!this.window.live));
    const seconds = String(this.window.spanTicks / TICKS_A_SECOND);
    const known = [...this.span.options].some(({ value }) => value === seconds);
    this.span.value = known ? seconds : "";
  }

  private async export(): Promise<void> {
    const { samples } = this.session;
    const from = samples.at(this.window.begin);
    const to = Math.min(samples.end, samples.at(this.window.end) + 1);
    if (to <= from) {
      this.session.tell("There is no sample in view; wait for some, or show another time.");
      return;
    }
    await this.keep("view", from, to);
  }

  private recordOrEnd(): void {
    const { session: { samples }, recordedFrom: from } = this;
    this.recordedFrom = from === null ? samples.end : null;
    setText(this.record, from === null ? "End recording" : "Record");
    this.record.setAttribute("aria-pressed", String(from === null));
    if (from === null) return;
    if (samples.end > from) void this.session.attempt(() => this.keep("recording", from, samples.end));
  }

  private async keep(name: string, from: number, to: number): Promise<void> {
    const { samples } = this.session;
    const begin = (samples.timeOf(Math.max(from, samples.first)) / TICKS_A_SECOND).toFixed(0);
    await keepLog(this.session, this.keeper, `${name}-${begin}s.csv`, from, to);
  }

  enter(): void {
    this.charts.rebuild();
    this.torque?.enter();
  }

  leave(): void {
    this.torque?.leave();
  }

  frame(): void {
    this.trigger.look();
    this.episodes.look();
    this.charts.draw();
    this.showValues();
    this.measures.refresh();
    this.torque?.frame();
    setText(this.resolution, this.charts.exact ? "every sample" : "each column from its least to its greatest sample");
  }

  private showValues(): void {
    const { samples } = this.session;
    const { cursor } = this.charts;
    if (!samples.end) return;
    const number = cursor === null ? samples.end - 1 : Math.min(samples.at(cursor), samples.end - 1);
    const shown = samples.timeOf(number) / TICKS_A_SECOND;
    setText(this.moment, cursor === null ? "now" : `at ${shown.toFixed(3)} s`);
    this.values.forEach((cells, joint) => QUANTITIES.forEach((quantity, place) => {
      setText(cells[place]!, samples.text(number, quantity, joint));
    }));
    this.element.dataset["tick"] = String(samples.timeOf(number));
    this.element.dataset["first"] = String(samples.timeOf(samples.first));
    this.element.dataset["count"] = String(number + 1 - samples.first);
  }

  key(event: KeyboardEvent): boolean {
    if (event.key === "p") this.window.toggle();
    else if (event.key === "r") this.episodes.beginOrEnd();
    else if (event.key === "d") this.episodes.discard();
    else return moveByKey(this.window, event.key);
    return true;
  }
}
