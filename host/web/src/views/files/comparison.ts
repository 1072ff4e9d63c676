// Logs laid over each other, with the paper's measures of each.

import { button, el, select, setText, tableHead } from "../../parts/dom";
import { themeChanged } from "../../parts/theme";
import type { Services } from "../../session/services";
import { Charts } from "../live/charts";
import { moveByKey, timeButtons } from "../live/time_buttons";
import { TimeWindow } from "../live/window";
import { JOINTS, QUANTITIES, QUANTITY_TITLES, samplesIn, TICKS_A_SECOND, type Samples } from "../../session/samples";
import type { Session } from "../../session/session";
import { LogMeasures } from "./measures";

const MOST_CHOSEN = 2;

type Chosen = { readonly name: string; readonly samples: Samples };

export class LogComparison {
  readonly element = el("div", { class: "comparison", hidden: true });
  private chosen: readonly Chosen[] = [];
  /** The logs as they were chosen, before they are all read. */
  names: readonly string[] = [];
  private joint = 0;
  private stale = true;
  private readonly extent = { firstTime: 0, lastTime: 0 };
  private readonly window = new TimeWindow(this.extent, Infinity);
  private readonly charts = new Charts([], this.window);
  private readonly measures: LogMeasures;
  private readonly moment = el("th", { attrs: { scope: "col" } }, "at the cursor");
  private readonly values = el("tbody");

  /** `marked` hears when other logs are chosen. */
  constructor(session: Session, private readonly services: Services, private readonly marked: () => void) {
    this.measures = new LogMeasures(services, (act) => session.attempt(act));
    const joints = Array.from({ length: JOINTS }, (_, joint) => [String(joint), `joint ${joint}`] as const);
    this.element.append(
      el("div", { class: "tools", attrs: { role: "toolbar", "aria-label": "Time and joint" } },
        select("Joint shown", joints, (joint) => this.showJoint(Number(joint))),
        button("Whole", () => this.showAll(), { title: "Show all of the logs (double click)" }),
        ...timeButtons(this.window),
        el("span", { class: "quiet" }, "leader dashed, follower solid; each log begins at 0 s")),
      this.charts.element,
      el("table", { class: "values" }, tableHead(this.moment, ...QUANTITY_TITLES), this.values),
      this.measures.element);
    this.charts.showOnly(this.joint);
    this.charts.element.addEventListener("dblclick", () => this.showAll());
    this.window.changed.on(() => { this.stale = true; });
    themeChanged.on(() => this.rebuild());
  }

  rebuild(): void {
    this.charts.rebuild();
    this.stale = true;
  }

  /** Takes a log, in place of the oldest choice where there are enough; or puts back one that was chosen. */
  async choose(name: string): Promise<void> {
    const names = this.names.includes(name)
      ? this.names.filter((one) => one !== name) : [...this.names, name].slice(-MOST_CHOSEN);
    this.names = names;
    this.marked();
    const read = await Promise.allSettled(names.map((one) => this.read(one)));
    if (this.names !== names) return; // a later choice goes on
    const sound = read.flatMap((one) => one.status === "fulfilled" ? [one.value] : []);
    const refused = read.find((one) => one.status === "rejected");
    const before = refused ? this.chosen.filter((one) => !names.includes(one.name)) : []; // they make room for nothing
    this.lay([...before, ...sound].slice(-MOST_CHOSEN));
    this.names = this.chosen.map((one) => one.name);
    this.marked();
    await this.measures.measure(this.names);
    if (refused) throw refused.reason;
  }

  /** Forgets logs that are no longer there as they were read. */
  async drop(gone: string): Promise<void> {
    if (this.names.includes(gone)) await this.choose(gone);
  }

  private async read(name: string): Promise<Chosen> {
    return this.chosen.find((one) => one.name === name) ?? { name, samples: samplesIn(await this.services.log(name)) };
  }

  private lay(chosen: readonly Chosen[]): void {
    this.chosen = chosen;
    this.element.hidden = !chosen.length;
    this.extent.lastTime = Math.max(0, ...chosen.map(({ samples }) => samples.lastTime));
    this.charts.lay(chosen.map(({ samples }, place) => ({ samples, shade: (shades) => shades.joints[place]! })));
    this.values.replaceChildren(...chosen.map(({ name }, place) => el("tr", {},
      el("th", { attrs: { scope: "row" } }, el("span", { class: `key key-${place}` }), name), ...QUANTITIES.map(() => el("td")))));
    this.showAll();
  }

  private showJoint(joint: number): void {
    this.joint = joint;
    this.charts.showOnly(joint);
    this.measures.showJoint(joint);
    this.stale = true;
  }

  private showAll(): void {
    this.window.show(0, this.extent.lastTime);
  }

  frame(): void {
    if (this.stale) this.charts.draw();
    this.stale = false;
    this.showValues();
  }

  private showValues(): void {
    const { cursor } = this.charts;
    setText(this.moment, cursor === null ? "at the cursor" : `at ${(cursor / TICKS_A_SECOND).toFixed(3)} s`);
    this.chosen.forEach(({ samples }, place) => {
      const number = cursor === null ? samples.end : samples.at(cursor);
      const cells = this.values.children[place]!.querySelectorAll("td");
      QUANTITIES.forEach((quantity, column) =>
        setText(cells[column]!, number < samples.end ? samples.text(number, quantity, this.joint) : "–"));
    });
  }

  key(event: KeyboardEvent): boolean {
    return moveByKey(this.window, event.key);
  }
}
