// The logs of the host's folder: one, or two laid over each other, with the paper's measures of each.

import { button, el, select, setText, tableHead } from "../../parts/dom";
import { themeChanged } from "../../parts/theme";
import type { View } from "../view";
import type { Services } from "../../session/services";
import { Charts } from "../live/charts";
import { moveByKey, timeButtons } from "../live/time_buttons";
import { TimeWindow } from "../live/window";
import { JOINTS, QUANTITIES, QUANTITY_TITLES, samplesIn, TICKS_A_SECOND, type Samples } from "../../session/samples";
import type { Session } from "../../session/session";
import { LogMeasures } from "./measures";

const MOST_CHOSEN = 2;

type Chosen = { readonly name: string; readonly samples: Samples };

export class LogsView implements View {
  readonly name = "Logs";
  readonly withoutBoard = true;
  readonly element: HTMLElement;
  private chosen: readonly Chosen[] = [];
  private names: readonly string[] = []; // as chosen, before they are all read
  private joint = 0;
  private stale = true;
  private readonly extent = { firstTime: 0, lastTime: 0 };
  private readonly window = new TimeWindow(this.extent, Infinity);
  private readonly charts = new Charts([], this.window);
  private readonly measures: LogMeasures;
  private readonly list = el("div", { class: "logs-list", attrs: { role: "group", "aria-label": "Logs of the folder" } });
  private readonly moment = el("th", { attrs: { scope: "col" } }, "at the cursor");
  private readonly values = el("tbody");
  private readonly picture = el("div", { hidden: true });
  private readonly hint = el("p", { class: "quiet" }, "Choose a log, or two to lay them over each other.");

  constructor(private readonly session: Session, private readonly services: Services) {
    this.measures = new LogMeasures(services);
    const joints = Array.from({ length: JOINTS }, (_, joint) => [String(joint), `joint ${joint}`] as const);
    this.picture.append(
      el("div", { class: "tools", attrs: { role: "toolbar", "aria-label": "Time and joint" } },
        select("Joint shown", joints, (joint) => this.showJoint(Number(joint))),
        button("Whole", () => this.showAll(), { title: "Show all of the logs (double click)" }),
        ...timeButtons(this.window),
        el("span", { class: "quiet" }, "leader dashed, follower solid; each log begins at 0 s")),
      this.charts.element,
      el("table", { class: "values" }, tableHead(this.moment, ...QUANTITY_TITLES), this.values),
      this.measures.element);
    this.element = el("div", { class: "logs" },
      el("section", { class: "card" }, el("h2", {}, "Logs"), this.hint, this.list), this.picture);
    this.charts.showOnly(this.joint);
    this.charts.element.addEventListener("dblclick", () => this.showAll());
    this.window.changed.on(() => { this.stale = true; });
    themeChanged.on(() => this.rebuild());
  }

  enter(): void {
    this.rebuild();
    void this.session.attempt(() => this.refresh());
  }

  private rebuild(): void {
    this.charts.rebuild();
    this.stale = true;
  }

  private async refresh(): Promise<void> {
    const logs = (await this.services.state()).files.filter(({ kind }) => kind === "log");
    if (!logs.length) setText(this.hint, "The folder holds no log yet: record one in the view Do.");
    else setText(this.hint, "Choose a log, or two to lay them over each other.");
    this.list.replaceChildren(...logs.map(({ name }) => button(name, () => void this.session.attempt(() => this.choose(name)))));
    this.markChosen();
  }

  private markChosen(): void {
    for (const choice of this.list.children) {
      choice.setAttribute("aria-pressed", String(this.names.includes(choice.textContent ?? "")));
    }
  }

  /** Takes a log, in place of the oldest choice where there are enough; or puts back one that was chosen. */
  private async choose(name: string): Promise<void> {
    const names = this.names.includes(name)
      ? this.names.filter((one) => one !== name) : [...this.names, name].slice(-MOST_CHOSEN);
    this.names = names;
    this.markChosen();
    const read = await Promise.allSettled(names.map((one) => this.read(one)));
    if (this.names !== names) return; // a later choice goes on
    const sound = read.flatMap((one) => one.status === "fulfilled" ? [one.value] : []);
    const refused = read.find((one) => one.status === "rejected");
    const before = refused ? this.chosen.filter((one) => !names.includes(one.name)) : []; // they make room for nothing
    this.lay([...before, ...sound].slice(-MOST_CHOSEN));
    this.names = this.chosen.map((one) => one.name);
    this.markChosen();
    await this.measures.measure(this.names);
    if (refused) throw refused.reason;
  }

  private async read(name: string): Promise<Chosen> {
    return this.chosen.find((one) => one.name === name) ?? { name, samples: samplesIn(await this.services.log(name)) };
  }

  private lay(chosen: readonly Chosen[]): void {
    this.chosen = chosen;
    this.picture.hidden = !chosen.length;
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
