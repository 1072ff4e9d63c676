// The controllers of four joints to touch: sets to drag, factors, the surface with the running arm on it, what the model
// predicts; apply, store, undo, compare.

import type { Services, Tuner } from "../../session/services";
import { Refusal, TABLE } from "../../link/schema";
import { upperFirst } from "../../link/refusal";
import { button, el, select, setText } from "../../parts/dom";
import type { View } from "../view";
import { physicalText } from "../../files/log";
import { JOINTS } from "../../session/samples";
import type { Session } from "../../session/session";
import { differences, Draft, jointsOf, ofRows, parameterName, rowsOf, withJoints, type Four } from "./draft";
import { FACTOR_NAMES, refusal, SETTING_NAMES, type FactorName, type Settings } from "../../session/law";
import { PredictPanel } from "./predict_panel";
import { CHANGE_CORNERS, ERROR_CORNERS, SetsEditor } from "./sets_editor";
import { operatingPoints, Surface } from "./surface";
import { TunePanel } from "./tune_panel";

const FACTORS: Readonly<Record<FactorName, string>> = {
  kp: "Kp 1/rad", kd: "Kd 1/rad", ki: "Ki V/(rad s)", ku_mv: "Ku mV", ce_ticks: "change over, periods",
};

export class ControllerView implements View {
  readonly name = "Controller";
  readonly element = el("div", { class: "controller" });
  private draft: Draft | null = null;
  private running: Four | null = null; // as they were taken last
  shownJoint = 0;
  private busy = false;
  private compared: { name: string; joints: Four } | null = null;
  private kept: Four | null = null; // B, while A is edited, and the other way round
  private place: "A" | "B" = "A";
  private readonly errorSets: SetsEditor;
  private readonly changeSets: SetsEditor;
  private readonly factors = new Map<FactorName, HTMLInputElement>();
  private readonly surface = new Surface();
  private readonly predict: PredictPanel | null;
  private readonly tune: TunePanel | null;
  private readonly tabs: HTMLButtonElement[];
  private readonly refused = el("p", { class: "problem", attrs: { role: "status" } });
  private readonly reading = el("p", { class: "quiet" }, "The board's controllers are being read.");
  private readonly editor = el("div", { class: "editor", hidden: true });
  private readonly toBoard = listed("Not yet on the board");
  private readonly toStore = listed("Not yet stored");
  private readonly toFile = listed("Against a file");
  private readonly files: HTMLSelectElement;
  private readonly buttons = {
    apply: button("Apply", () => void this.act(() => this.apply()), { class: "primary", title: "Run these controllers; they are not stored" }),
    store: button("Store", () => void this.act(() => this.session.store()), { title: "Write what runs to the board's memory" }),
    discard: button("Discard", () => this.discard(), { title: "Back to what the board runs" }),
    undo: button("Undo", () => this.draft?.undo(), { title: "One step back (U)" }),
    redo: button("Redo", () => this.draft?.redo(), { title: "One step on (R)" }),
    swap: button("A", () => void this.act(() => this.swap()), { title: "Run the other of two controllers (X)" }),
  };

  /** `tuner` searches within the page, where no host has a verb for it. */
  constructor(private readonly session: Session, private readonly services: Services | null, tuner: Tuner | null = null) {
    const moved = (name: keyof Settings, raw: number, grip: string): void =>
      this.draft?.set(this.shownJoint, name, raw, grip && `${this.shownJoint} ${grip}`);
    const letGo = (): void => this.draft?.letGo();
    this.errorSets = new SetsEditor("Sets of the error", ["NE", "ZE", "PE"], ERROR_CORNERS, moved, letGo);
    this.changeSets = new SetsEditor("Sets of the change of error", ["NCE", "ZCE", "PCE"], CHANGE_CORNERS, moved, letGo);
    this.predict = services ? new PredictPanel(services) : null;
    this.tune = tuner && new TunePanel(tuner, () => this.acceptable(), (rows) => this.draft?.replace(ofRows(rows)));
    this.tabs = Array.from({ length: JOINTS }, (_, joint) => button(`Joint ${joint}`, () => this.showJoint(joint)));
    this.files = select("Compare with", [["", "no file"]], (name) => void this.act(() => this.compare(name)));
    this.build();
    session.parametersChanged.on(() => this.take());
    session.changed.on(() => this.refreshButtons());
  }

  private build(): void {
    const fields = FACTOR_NAMES.map((name) => {
      const parameter = TABLE.named(parameterName(0, name));
      const input = el("input", { type: "number", title: parameter.description, attrs: {
        step: "any", min: String(parameter.minimum * parameter.lsb), max: String(parameter.maximum * parameter.lsb),
      }, on: { change: () => this.typed(name) } });
      this.factors.set(name, input);
      return el("label", { class: "factor" }, el("span", {}, FACTORS[name]), input);
    });
    const { apply, store, discard, undo, redo, swap } = this.buttons;
    this.element.append(
      el("div", { class: "tools" }, ...this.tabs, el("span", { class: "gap" }), undo, redo, swap, discard, store, apply),
      this.refused,
      this.reading,
      this.editor);
    this.editor.append(
      el("div", { class: "side" },
        el("section", { class: "card" }, el("h2", {}, "Error"), this.errorSets.element,
          el("h2", {}, "Change of error"), this.changeSets.element, el("div", { class: "factors" }, ...fields)),
        el("section", { class: "card" }, el("h2", {}, "Not yet on the board"), this.toBoard,
          el("h2", {}, "Not yet stored"), this.toStore,
          ...(this.services ? [el("h2", {}, "Against a file"), this.files, this.toFile] : []))),
      el("div", { class: "side" },
        el("section", { class: "card" }, el("h2", {}, "Control surface"), this.surface.element),
        ...(this.predict ? [this.predict.element] : []), ...(this.tune ? [this.tune.element] : [])));
  }

  /** One thing at a time: while the board takes a set, no other one may begin. */
  private async act(act: () => Promise<void>): Promise<void> {
    if (this.busy) return;
    this.busy = true;
    this.refreshButtons();
    await this.session.attempt(act);
    this.busy = false;
    this.refreshButtons();
  }

  /** Takes what the board runs, where nothing is edited that would be lost. */
  private take(): void {
    const { parameters } = this.session;
    if (!parameters) return;
    const running = jointsOf(parameters);
    const before = this.running;
    this.running = running;
    if (!this.draft) {
      this.draft = new Draft(running);
      this.kept = this.draft.joints;
      this.draft.changed.on(() => this.show());
    } else if (before && differences(before, running).length && !differences(this.draft.joints, before).length) {
      this.draft.replace(running);
    }
    this.show();
  }

  enter(): void {
    void this.act(async () => {
      if (this.session.link.open) await this.session.readParameters(); // else the session reads them once it is
      this.take();
      if (this.services) await this.listFiles(this.services);
    });
  }

  private async listFiles(services: Services): Promise<void> {
    const { controllers, files } = await services.state();
    const named = files.filter(({ kind }) => kind === "controller" || kind === "parameters").map(({ name }) => name);
    const chosen = this.files.value;
    this.files.replaceChildren(...["", ...controllers, ...named].map((name) => el("option", { value: name }, name || "no file")));
    this.files.value = chosen;
  }

  showJoint(joint: number): void {
    this.shownJoint = joint;
    this.predict?.showJoint(joint);
    this.tune?.showJoint(joint);
    this.show();
  }

  private typed(name: FactorName): void {
    const parameter = TABLE.named(parameterName(this.shownJoint, name));
    const input = this.factors.get(name)!;
    const raw = Math.round(Number(input.value) / parameter.lsb);
    if (input.value === "" || !(raw >= parameter.minimum && raw <= parameter.maximum)) {
      const [low, high] = [parameter.minimum, parameter.maximum].map((one) => physicalText(parameter, one));
      this.session.tell(`${parameter.name.replace("0", String(this.shownJoint))} is ${input.value || "empty"}; choose a value from ${low} to ${high}.`);
      this.show();
      return;
    }
    this.draft?.set(this.shownJoint, name, raw);
  }

  private discard(): void {
    const { parameters } = this.session;
    if (parameters) this.draft?.replace(jointsOf(parameters));
  }

  /** Runs what is edited. Motors that run are stopped for it, and start again through the soft start. */
  private async apply(): Promise<void> {
    const { draft, session } = this;
    if (!draft) return;
    await session.withMotorsOff(async () => session.apply(withJoints(await session.readParameters(), draft.joints)));
  }

  /** Puts the other of A and B in place of the edited one, and runs it. */
  private async swap(): Promise<void> {
    if (!this.draft || !this.kept) return;
    const other = this.kept;
    this.kept = this.draft.joints;
    this.place = this.place === "A" ? "B" : "A";
    this.draft.replace(other);
    await this.apply();
  }

  private async compare(name: string): Promise<void> {
    if (!this.services || !this.draft || !name) {
      this.compared = null;
    } else {
      const raw = await this.services.controller(name);
      const joints = this.draft.joints.map((settings, joint) => {
        const other: Record<string, number> = { ...settings };
        for (const one of SETTING_NAMES) other[one] = raw[parameterName(joint, one)] ?? settings[one];
        return other as Settings;
      });
      this.compared = { name, joints };
    }
    this.show();
  }

  private show(): void {
    const { draft } = this;
    const { parameters, hello } = this.session;
    if (!draft || !parameters) return;
    this.reading.hidden = true;
    this.editor.hidden = false;
    const settings = draft.joints[this.shownJoint]!;
    this.tabs.forEach((tab, joint) => tab.setAttribute("aria-pressed", String(joint === this.shownJoint)));
    this.errorSets.show(settings);
    this.changeSets.show(settings);
    this.surface.show(settings);
    for (const name of FACTOR_NAMES) {
      const input = this.factors.get(name)!;
      if (document.activeElement !== input) input.value = physicalText(TABLE.named(parameterName(this.shownJoint, name)), settings[name]);
    }
    list(this.toBoard, draft.joints, jointsOf(parameters), "The board runs these controllers.");
    this.showStored(draft.joints);
    if (this.compared) list(this.toFile, draft.joints, this.compared.joints, `As in ${this.compared.name}.`);
    else this.toFile.replaceChildren();
    this.showRefusal(draft.joints, this.periodMs(parameters));
    this.predict?.want(withJoints(parameters, draft.joints), hello?.board ?? 0);
    this.refreshButtons();
  }

  private showStored(joints: Four): void {
    const { stored, storedCrc, storesNothing } = this.session;
    if (stored) {
      list(this.toStore, joints, jointsOf(stored), storesNothing
        ? "Nothing is stored: the board starts with these, its defaults."
        : "The board has stored these controllers.");
      return;
    }
    const why = storedCrc === null
      ? "Not known: a board tells what it runs, and stored before anybody watched. Store makes both the same."
      : "The board stores another set than it runs, which this page has not seen. Store makes both the same.";
    this.toStore.replaceChildren(el("li", { class: "quiet" }, why));
  }

  private periodMs(parameters: readonly number[]): number {
    return parameters[TABLE.named("period_ms").index]!;
  }

  private showRefusal(joints: Four, periodMs: number): void {
    const at = joints.findIndex((settings) => refusal(settings, periodMs) !== Refusal.is.none);
    const why = at < 0 ? null : Refusal.of(refusal(joints[at]!, periodMs));
    setText(this.refused, why ? `The board would refuse joint ${at}: ${why.description}. ${upperFirst(why.remedy)}` : "");
    this.buttons.apply.dataset["refused"] = why ? "yes" : "";
  }

  private acceptable(): number[][] | null {
    return this.draft && this.buttons.apply.dataset["refused"] !== "yes" ? rowsOf(this.draft.joints) : null;
  }

  private refreshButtons(): void {
    const { draft, session } = this;
    const { apply, store, discard, undo, redo, swap } = this.buttons;
    const may = !this.busy && session.driver.you && session.driver.verb === null && session.link.open && draft !== null;
    const changed = may && session.parameters !== null
      && differences(draft.joints, jointsOf(session.parameters)).length > 0;
    apply.disabled = !changed || apply.dataset["refused"] === "yes";
    store.disabled = !may;
    discard.disabled = !changed;
    undo.disabled = !draft?.canUndo;
    redo.disabled = !draft?.canRedo;
    swap.disabled = !may;
    setText(swap, `${this.place} / ${this.place === "A" ? "B" : "A"}`);
  }

  frame(): void {
    const { parameters, samples } = this.session;
    if (!parameters || !this.draft) return;
    const running = jointsOf(parameters)[this.shownJoint]!;
    const points = operatingPoints(samples, this.shownJoint, running, this.periodMs(parameters));
    const settings = this.draft.joints[this.shownJoint]!;
    this.surface.showPoints(points, settings);
    const now = points.at(-1);
    this.errorSets.showPoint(now ? now.x : null);
    this.changeSets.showPoint(now ? now.y : null);
  }

  key(event: KeyboardEvent): boolean {
    const act: Readonly<Record<string, () => void>> = {
      x: () => this.buttons.swap.click(),
      u: () => this.draft?.undo(),
      r: () => this.draft?.redo(),
    };
    act[event.key]?.();
    return event.key in act;
  }
}

/** A list that may be longer than its place. */
function listed(label: string): HTMLUListElement {
  return el("ul", { class: "differences", attrs: { tabindex: "0", "aria-label": label } });
}

/** Differences as lines: name, mine, then the other's value. */
function list(into: HTMLElement, mine: Four, other: Four, none: string): void {
  const found = differences(mine, other);
  into.replaceChildren(...found.map(({ name, mine: raw, other: otherRaw }) => {
    const parameter = TABLE.named(name);
    return el("li", {}, el("span", {}, name), el("span", {}, `${physicalText(parameter, raw)} (${physicalText(parameter, otherRaw)})`));
  }));
  if (!found.length) into.append(el("li", { class: "quiet" }, none));
}
