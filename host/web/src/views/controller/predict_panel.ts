// Predicts a step and a reach with the controllers that run and with the edited ones on a model: anew while a person drags.

import { el, fileField, select, setText, tableHead } from "../../parts/dom";
import { motionCanvas, paintMotions } from "../../parts/motions";
import type { NamedText } from "../../parts/named_text";
import { sentenceOf } from "../../parts/sentence";
import { themeChanged } from "../../parts/theme";
import { follows, type Follows } from "../../session/follows";
import { JOINTS } from "../../session/samples";
import type { Model, Prediction, Predictor } from "../../session/services";
import { pairOf } from "./numbers";

/** Whole parameter sets in raw values, and the board that has them. */
type Wish = { readonly running: readonly number[]; readonly edited: readonly number[]; readonly board: number };

const KINDS = ["step", "reach"] as const;
const TITLES = { step: "A step of 0.5 rad", reach: "A reach of 1 rad in 0.8 s" } as const;
const LEGEND = "Dashed: the leader. Thin: what the board runs. Bold: what is edited. Below, what runs → what is edited; errors are "
  + "root mean squares.";
const MRAD = 1000; // in a rad
const MEASURES: readonly (readonly [title: string, of: (one: Follows) => number | null, digits: number, none: string])[] = [
  ["overshoot, %", ({ overshoot }) => overshoot, 1, "–"],
  ["settles, s", ({ overshoot, settling }) => (overshoot === null ? null : settling), 2, "never"],
  ["error in step, mrad", ({ step }) => MRAD * step, 1, ""],
  ["error in reach, mrad", ({ reach }) => MRAD * reach, 1, ""],
];

export class PredictPanel {
  readonly element: HTMLElement;
  private readonly canvases = { step: motionCanvas("Predicted step"), reach: motionCanvas("Predicted reach") };
  private readonly problem = el("p", { class: "problem", attrs: { role: "status" } });
  private readonly says = el("p", { class: "quiet" });
  private readonly choice = select<string>("Model", [], (name) => this.choose(name));
  private readonly chosen = el("label", { class: "row", hidden: true }, el("span", { class: "quiet" }, "Model"), this.choice);
  private readonly rows = Array.from({ length: JOINTS }, (_, joint) =>
    el("tr", {}, el("th", { attrs: { scope: "row" } }, String(joint)), ...MEASURES.map(() => el("td"))));
  private models: readonly Model[] = [];
  private newest: Wish | null = null;
  private wanted: Wish | null = null;
  private busy = false;
  private joint = 0;
  private ran: { readonly key: string; readonly prediction: Prediction } | null = null; // so that a drag asks for one alone
  private found: { readonly running: Prediction; readonly edited: Prediction } | null = null;

  constructor(private readonly predictor: Predictor) {
    this.element = el("section", { class: "card predict" }, el("h2", {}, "The model predicts"),
      ...KINDS.map((kind) => el("figure", {}, el("figcaption", {}, TITLES[kind]), this.canvases[kind])),
      el("p", { class: "quiet" }, LEGEND),
      el("div", { class: "scroll", attrs: { tabindex: "0", role: "region", "aria-label": "What the model predicts for each joint" } },
        el("table", {}, tableHead("joint", ...MEASURES.map(([title]) => title)), el("tbody", {}, ...this.rows))),
      this.chosen, this.says, ...(predictor.read ? [this.fileField(predictor.read)] : []), this.problem);
    themeChanged.on(() => this.draw());
  }

  /** The model of now; null before they are read. */
  get model(): Model | null {
    return this.models.find(({ name }) => name === this.choice.value) ?? null;
  }

  /** Reads what there is to predict with. */
  async readModels(): Promise<void> {
    const before = this.choice.value;
    this.models = await this.predictor.models();
    this.choice.replaceChildren(...this.models.map(({ name }) => el("option", { value: name }, name)));
    if (this.models.some(({ name }) => name === before)) this.choice.value = before;
    this.chosen.hidden = this.models.length < 2;
    this.choose(this.choice.value);
  }

  private fileField(read: (file: NamedText) => Model): HTMLElement {
    return fileField("An arm.toml or model.toml of yours", ".toml", (file) => void file?.then(async (text) => {
      const { name } = read(text);
      await this.readModels();
      this.choose(name);
      setText(this.problem, "");
    }).catch((error: unknown) => setText(this.problem, sentenceOf(error))));
  }

  /** Asks for these controllers; while an answer is on its way only the newest wish waits. */
  want(wish: Wish): void {
    this.newest = this.wanted = wish;
    void this.serve();
  }

  showJoint(joint: number): void {
    this.joint = joint;
    this.draw();
  }

  private choose(name: string): void {
    this.choice.value = name;
    setText(this.says, this.model?.says ?? "");
    if (this.newest) this.want(this.newest);
  }

  private async serve(): Promise<void> {
    if (this.busy) return;
    this.busy = true;
    for (let model = this.model; this.wanted && model; model = this.model) {
      const wish = this.wanted;
      this.wanted = null;
      try {
        this.found = await this.predict(wish, model);
        setText(this.problem, "");
      } catch (error) {
        setText(this.problem, sentenceOf(error));
      }
      this.draw();
    }
    this.busy = false;
  }

  private async predict({ running, edited, board }: Wish, model: Model): Promise<{ running: Prediction; edited: Prediction }> {
    const key = [model.name, board, ...running].join();
    if (this.ran?.key !== key) this.ran = { key, prediction: await this.predictor.predict(running, board, model) };
    const same = running.every((value, index) => value === edited[index]);
    const { prediction } = this.ran;
    return { running: prediction, edited: same ? prediction : await this.predictor.predict(edited, board, model) };
  }

  draw(): void {
    if (!this.found) return;
    const { running, edited } = this.found;
    for (const kind of KINDS) {
      const { time_s, leader, follower } = edited[kind];
      paintMotions(this.canvases[kind], time_s, [leader, running[kind].follower, follower], this.joint);
    }
    const [before, after] = [follows(running), follows(edited)];
    this.rows.forEach((row, joint) => {
      row.dataset["shown"] = joint === this.joint ? "yes" : "";
      MEASURES.forEach(([, of, digits, none], place) =>
        setText(row.cells[place + 1]!, pairOf(of(before[joint]!), of(after[joint]!), digits, none)));
    });
    this.element.dataset["rms"] = String(after[this.joint]!.step);
  }
}
