// The controllers of four joints to touch: sets to drag, factors, the surface with the running arm on it, what the model
// predicts; apply, store, undo, compare.

import type { Predictor, Services, Tuner } from "../../session/services";
import { Refusal, TABLE } from "../../link/schema";
import { upperFirst } from "../../link/refusal";
import { button, el, select, setText } from "../../parts/dom";
import type { View } from "../view";
import { JOINTS } from "../../session/samples";
import type { Session } from "../../session/session";
import { Differences } from "./differences";
import { areSame, Draft, jointsOf, ofRows, parameterName, rowsOf, withJoints, type Four } from "./draft";
import { refusal, SETTING_NAMES, type Settings } from "../../session/law";
import { FactorFields } from "./factor_fields";
import { Pair } from "./pair";
import { PredictPanel } from "./predict_panel";
import { CHANGE_CORNERS, ERROR_CORNERS, SetsEditor } from "./sets_editor";
import { operatingPoints, Surface } from "./surface";
import { TunePanel } from "./tune_panel";

export class ControllerView implements View {
  readonly name = "Controller";
  readonly element = el("div", { class: "controller" });
  private draft: Draft | null = null;
  private running: Four | null = null; // as they were taken last
  shownJoint = 0;
  private busy = false;
  private models: Promise<unknown> = Promise.resolve();
  private compared: { name: string; joints: Four } | null = null;
  private readonly pair = new Pair(() => void this.act(() => this.swap()));
  private readonly errorSets: SetsEditor;
  private readonly changeSets: SetsEditor;
  private readonly factors: FactorFields;
  private readonly surface = new Surface();
  private readonly predict: PredictPanel;
  private readonly tune: TunePanel;
  private readonly tabs: HTMLButtonElement[];
  private readonly refused = el("p", { class: "problem", attrs: { role: "status" } });
  private readonly reading = el("p", { class: "quiet" }, "The board's controllers are being read.");
  private readonly editor = el("div", { class: "editor", hidden: true });
  private readonly toBoard = new Differences("Not yet on the board", "runs");
  private readonly toStore = new Differences("Not yet stored", "stored");
  private readonly toFile = new Differences("Against a file", "in the file");
  private readonly files: HTMLSelectElement;
  private readonly buttons = {
    apply: button("Apply", () => void this.act(() => this.apply()), { class: "primary", title: "Run these controllers; they are not stored" }),
    store: button("Store", () => void this.act(() => this.session.store()), { title: "Write what runs to the board's memory" }),
    discard: button("Discard", () => this.discard(), { title: "Back to what the board runs" }),
    undo: button("Undo", () => this.draft?.undo(), { title: "One step back (U)" }),
    redo: button("Redo", () => this.draft?.redo(), { title: "One step on (R)" }),
  };

  /** `services` has files to compare with, where there is a host. */
  constructor(
    private readonly session: Session, predictor: Predictor, tuner: Tuner,
    private readonly services: Pick<Services, "state" | "controller"> | null = null,
  ) {
    const moved = (name: keyof Settings, raw: number, grip: string): void =>
      this.draft?.set(this.shownJoint, name, raw, grip && `${this.shownJoint} ${grip}`);
    const letGo = (): void => this.draft?.letGo();
    this.errorSets = new SetsEditor("Sets of the error", ["NE", "ZE", "PE"], ERROR_CORNERS, moved, letGo);
    this.changeSets = new SetsEditor("Sets of the change of error", ["NCE", "ZCE", "PCE"], CHANGE_CORNERS, moved, letGo);
    this.factors = new FactorFields((name, raw) => this.draft?.set(this.shownJoint, name, raw), (sentence) => {
      session.tell(`Joint ${this.shownJoint}: ${sentence}`);
      this.show();
    });
    this.predict = new PredictPanel(predictor);
    this.tune = new TunePanel(
      tuner, () => this.acceptable(), () => this.predict.model, (rows) => this.draft?.replace(ofRows(rows)));
    this.tabs = Array.from({ length: JOINTS }, (_, joint) => button(`Joint ${joint}`, () => this.showJoint(joint)));
    this.files = select("Compare with", [["", "no file"]], (name) => void this.act(() => this.compare(name)));
    this.build();
    session.parametersChanged.on(() => this.take());
    session.changed.on(() => this.refreshButtons());
  }

  private build(): void {
    const { apply, store, discard, undo, redo } = this.buttons;
    this.element.append(
      el("div", { class: "tools" },
        ...this.tabs, el("span", { class: "gap" }), this.pair.element, undo, redo, discard, store, apply),
      this.refused,
      this.reading,
      this.editor);
    this.editor.append(
      el("div", { class: "side" },
        el("section", { class: "card" }, el("h2", {}, "Error"), this.errorSets.element,
          el("h2", {}, "Change of error"), this.changeSets.element,
          el("p", { class: "quiet" }, "Drag a corner, or choose it with Tab and move it with the arrow keys; Shift makes small steps."),
          this.factors.element),
        el("section", { class: "card" }, el("h2", {}, "Control surface"), this.surface.element)),
      el("div", { class: "side" },
        this.predict.element,
        el("section", { class: "card" }, this.toBoard.element, this.toStore.element,
          ...(this.services ? [this.toFile.element, this.files] : []))),
      this.tune.element);
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
      this.pair.begin(running);
      this.draft.changed.on(() => this.show());
    } else if (before && !areSame(before, running) && areSame(this.draft.joints, before)) {
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
    this.models = this.session.attempt(() => this.predict.readModels());
  }

  /** Begins a search as the button Tune does, once all that it needs is read; the view is in front. */
  async letTune(): Promise<void> {
    await this.session.readParameters();
    await this.models;
    void this.tune.begin();
  }

  private async listFiles(services: Pick<Services, "state">): Promise<void> {
    const { controllers, files } = await services.state();
    const named = files.filter(({ kind }) => kind === "controller" || kind === "parameters").map(({ name }) => name);
    const chosen = this.files.value;
    this.files.replaceChildren(...["", ...controllers, ...named].map((name) => el("option", { value: name }, name || "no file")));
    this.files.value = chosen;
  }

  showJoint(joint: number): void {
    this.shownJoint = joint;
    this.predict.showJoint(joint);
    this.tune.showJoint(joint);
    this.show();
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
    if (!this.draft) return;
    this.draft.replace(this.pair.swap(this.draft.joints));
    const { parameters } = this.session;
    if (!parameters || !areSame(this.draft.joints, jointsOf(parameters))) await this.apply();
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
    this.factors.show(settings);
    this.toBoard.show(draft.joints, jointsOf(parameters), "The board runs these controllers.");
    this.showStored(draft.joints);
    if (this.compared) this.toFile.show(draft.joints, this.compared.joints, `As in ${this.compared.name}.`);
    else this.toFile.say("");
    this.showRefusal(draft.joints, this.periodMs(parameters));
    if (this.acceptable()) this.predict.want({ running: parameters, edited: withJoints(parameters, draft.joints), board: hello?.board ?? 0 });
    this.refreshButtons();
  }

  private showStored(joints: Four): void {
    const { stored, storedCrc, storesNothing, parameters } = this.session;
    const running = parameters && jointsOf(parameters);
    if (stored && running && areSame(jointsOf(stored), running) && !areSame(joints, running)) {
      this.toStore.say(storesNothing ? "The same: nothing is stored, and the board starts with what it runs." : "The same: the board has stored what it runs.");
      return;
    }
    if (stored) {
      this.toStore.show(joints, jointsOf(stored), storesNothing
        ? "Nothing is stored: the board starts with these, its defaults."
        : "The board has stored these controllers.");
      return;
    }
    const why = storedCrc === null
      ? "Not known: a board tells what it runs, and stored before anybody watched. Store makes both the same."
      : "The board stores another set than it runs, which this page has not seen. Store makes both the same.";
    this.toStore.say(why);
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
    const { apply, store, discard, undo, redo } = this.buttons;
    const may = !this.busy && session.driver.you && session.driver.verb === null && session.link.open && draft !== null;
    const changed = may && session.parameters !== null
      && !areSame(draft.joints, jointsOf(session.parameters));
    apply.disabled = !changed || apply.dataset["refused"] === "yes";
    store.disabled = !may;
    discard.disabled = !changed;
    undo.disabled = !draft?.canUndo;
    redo.disabled = !draft?.canRedo;
    if (draft && session.parameters) this.pair.show(draft.joints, jointsOf(session.parameters), may);
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
      x: () => this.pair.press(),
      u: () => this.draft?.undo(),
      r: () => this.draft?.redo(),
    };
    act[event.key]?.();
    return event.key in act;
  }
}
