// All parameters of the board: read, change, store; a controller.toml onto the board, the whole set into a file.

import { controllerIn } from "../../files/controller_file";
import { parameterFile, statedIn } from "../../files/parameter_file";
import { rawAsGiven } from "../../files/raw_value";
import type { Parameter } from "../../link/declared";
import { TABLE } from "../../link/schema";
import { button, download, el, fileField, setText, tableHead } from "../../parts/dom";
import { grey } from "../../parts/grey";
import { haveSameCalibration } from "../calibrate/earlier";
import type { View } from "../view";
import type { NamedText } from "../../parts/named_text";
import { physicalText } from "../../files/log";
import type { Calibrations } from "../../session/services";
import { JOINT_NAMES } from "../../session/samples";
import type { Session } from "../../session/session";

export class ParametersView implements View {
  readonly name = "Parameters";
  readonly element: HTMLElement;
  private readonly inputs: readonly HTMLInputElement[];
  private edited: ReadonlyMap<number, number> = new Map(); // raw values by index, not yet on the board
  private readonly said = el("p", { class: "quiet", attrs: { role: "status" } });
  private readonly kept = el("p", { class: "quiet" }); // of what runs
  private readonly apply = button("Apply", () => this.act(() => this.run()), { class: "primary" });
  private readonly store = button("Store", () => this.act(() => this.keepRunning()));
  private readonly save = button("Save to a file", () => this.act(() => this.keep()));
  private readonly discard = button("Discard", () => this.edit(new Map()));
  private readonly search = el("input", { type: "search", title: "Shows the rows that have all of these words (/)",
    attrs: { placeholder: "Name or meaning", "aria-label": "Search parameters", "aria-keyshortcuts": "/" }, on: { input: () => this.filter() } });
  private readonly found = el("span", { class: "quiet", attrs: { role: "status" } });
  private readonly rows: readonly HTMLElement[];
  private readonly changes = el("ul", { class: "differences", attrs: { tabindex: "0", "aria-label": "Changes" } });
  private waiting = 0;
  private last: Promise<void> = Promise.resolve();

  constructor(private readonly session: Session, private readonly calibrations: Calibrations) {
    this.inputs = TABLE.parameters.map((parameter) => this.field(parameter));
    const head = tableHead("parameter", "value", "unit", "from", "to");
    this.rows = TABLE.parameters.map((parameter, place) => el("tr", { title: parameter.description },
      el("th", { attrs: { scope: "row" } }, parameter.name), el("td", {}, this.inputs[place]!), el("td", {}, parameter.unit),
      el("td", {}, physicalText(parameter, parameter.minimum)), el("td", {}, physicalText(parameter, parameter.maximum))));
    this.element = el("section", { class: "card" },
      el("div", { class: "tools" }, fileField("Upload a controller.toml", ".toml", (file) => file && this.act(async () => this.upload(await file))),
        fileField("Restore a parameter file", ".toml", (file) => file && this.act(async () => this.restore(await file)))),
      el("div", { class: "tools" }, this.apply, this.store, this.discard, this.save),
      this.said, this.kept, this.changes,
      el("div", { class: "tools" }, this.search, this.found),
      el("div", { class: "scroll" }, el("table", {}, head, el("tbody", {}, ...this.rows))));
    this.filter();
    session.parametersChanged.on(() => this.show());
    session.changed.on(() => this.refreshButtons());
    this.refreshButtons();
  }

  enter(): void {
    this.act(async () => void await this.session.readParameters());
  }

  key({ key }: KeyboardEvent): boolean {
    if (key !== "/") return false;
    this.search.focus();
    return true;
  }

  /** Shows the parameters whose name, meaning or joint has every word that is sought. */
  private filter(): void {
    const words = this.search.value.toLowerCase().split(/\s+/);
    const shown = TABLE.parameters.filter(({ name, description }, place) => {
      const joint = JOINT_NAMES.find((_, number) => name.startsWith(`joint${number}.`)) ?? "";
      const text = `${name} ${description} ${joint}`.toLowerCase();
      return !(this.rows[place]!.hidden = !words.every((word) => text.includes(word)));
    }).length;
    setText(this.found, `${shown} of ${TABLE.parameters.length} parameters`);
  }

  private field(parameter: Parameter): HTMLInputElement {
    const { index, name, description } = parameter;
    const input = el("input", { type: "number", title: description, attrs: { step: "any", "aria-label": name } });
    input.addEventListener("change", () => {
      const next = new Map(this.edited);
      try {
        next.set(index, rawAsGiven(parameter, input.value === "" ? NaN : Number(input.value)));
        if (next.get(index) === this.session.parameters?.[index]) next.delete(index);
      } catch (error) {
        this.session.tell((error as Error).message);
      }
      this.edit(next);
    });
    return input;
  }

  private edit(edited: ReadonlyMap<number, number>): void {
    this.edited = edited;
    setText(this.said, "");
    this.show();
  }

  /** One thing after the other. */
  private act(act: () => Promise<void>): void {
    this.waiting++;
    this.refreshButtons();
    this.last = this.last.then(async () => {
      await this.session.attempt(act);
      this.waiting--;
      this.refreshButtons();
    });
  }

  private async run(): Promise<void> {
    const before = await this.session.readParameters();
    const raw = [...before];
    for (const [index, value] of this.edited) raw[index] = value;
    if (!haveSameCalibration(before, raw)) await this.calibrations.keep(before, this.session.hello!.board, "found");
    await this.session.apply(raw);
    this.edit(new Map());
    setText(this.said, "The changes run; Store keeps them.");
  }

  private async keepRunning(): Promise<void> {
    await this.session.store();
    const { parameters, hello } = this.session;
    if ((await this.calibrations.list()).length) await this.calibrations.keep(parameters!, hello!.board, "set");
    setText(this.said, "What runs is stored.");
  }

  /** Runs and stores what a controller file says; every other parameter keeps its value. */
  private async upload(file: NamedText): Promise<void> {
    const values = controllerIn(file);
    const before = await this.session.readParameters();
    const raw = TABLE.parameters.map(({ name, index }) => values.get(name) ?? before[index]!);
    await this.session.apply(raw);
    await this.session.store();
    const changed = raw.filter((value, index) => value !== before[index]).length;
    setText(this.said, `${file.name} runs and is stored; ${changed} ${changed === 1 ? "parameter has" : "parameters have"} changed.`);
  }

  /** Shows where a parameter file differs from what runs. */
  private async restore(file: NamedText): Promise<void> {
    const stated = statedIn(file);
    await this.session.readParameters();
    this.edit(stated);
    const [count, kept] = [this.changed().length, TABLE.parameters.length - stated.size];
    const older = kept ? ` It is older and does not state ${kept === 1 ? "one parameter, which keeps its value" : `${kept} parameters, which keep their values`}.` : "";
    setText(this.said, (!count ? `${file.name} is what runs.`
      : `${file.name} changes ${count === 1 ? "one parameter" : `${count} parameters`}: Apply runs it, Store then keeps it.`) + older);
  }

  private async keep(): Promise<void> {
    download("parameters.toml", parameterFile(await this.session.readParameters()), "application/toml");
  }

  /** The parameters that Apply would change. */
  private changed(): Parameter[] {
    const { parameters } = this.session;
    return TABLE.parameters.filter(({ index }) => parameters && (this.edited.get(index) ?? parameters[index]) !== parameters[index]);
  }

  private show(): void {
    const { parameters } = this.session;
    const changed = this.changed();
    TABLE.parameters.forEach((parameter, place) => {
      const input = this.inputs[place]!;
      const raw = this.edited.get(parameter.index) ?? parameters?.[parameter.index];
      if (document.activeElement !== input) input.value = raw === undefined ? "" : physicalText(parameter, raw);
      input.classList.toggle("edited", changed.includes(parameter));
    });
    this.changes.hidden = !changed.length;
    this.changes.replaceChildren(...changed.map((parameter) => {
      const [before, after] = [parameters![parameter.index]!, this.edited.get(parameter.index)!].map((raw) => physicalText(parameter, raw));
      return el("li", {}, el("span", {}, parameter.name), el("span", {}, `${before} → ${after} ${parameter.unit}`));
    }));
    this.refreshButtons();
  }

  private refreshButtons(): void {
    const { link, whyNotChange, motorsOn } = this.session;
    const busy = this.waiting > 0 ? "One moment." : "";
    const may = busy || (link.open ? "" : "No board is there.");
    const change = may || whyNotChange;
    const unchanged = this.changed().length ? "" : "Nothing is changed here.";
    grey(this.apply, change || unchanged || (motorsOn ? "Parameters change with the motors off; press Stop first." : ""), "Run what is changed here; it is not stored");
    grey(this.discard, busy || (this.edited.size ? "" : "Nothing is changed here."), "What is changed here is forgotten");
    grey(this.store, change, "Write what runs to the board's memory");
    grey(this.save, may, "All parameters, as greywhale params restore takes them");
    setText(this.kept, this.whatIsKept());
  }

  /** How what runs compares with what the board starts with. */
  private whatIsKept(): string {
    const { parameters, stored, storedCrc, storesNothing } = this.session;
    if (!parameters) return "";
    if (!stored && storedCrc !== null) return "The board has stored another set than the one that runs.";
    if (!stored) return "What the board has stored is not known before it starts or stores.";
    const count = stored.filter((value, index) => value !== parameters[index]).length;
    if (!count) return storesNothing ? "Nothing is stored: the board starts with what runs, its defaults." : "The board has stored what runs.";
    return `${count === 1 ? "One parameter is" : `${count} parameters are`} not stored: the board starts with ${storesNothing ? "its defaults" : "what it has stored"}.`;
  }
}
