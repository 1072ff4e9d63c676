// One job: how far it is, what it says and asks, its result or its error.

import { button, el, setText } from "../../parts/dom";
import type { Job, Jobs, Json } from "../../session/services";
import { predictedBeside, trialsIn } from "./predicted";
import { SearchCurve } from "./search_curve";

/** The sentence by which a calibration asks for a joint. */
const ASKED = /\bjoint ([0-3])\b/;

export class JobCard {
  readonly element: HTMLElement;
  private readonly title: HTMLElement;
  private readonly state = el("span", { class: "pill", attrs: { role: "status" } });
  private readonly bar = el("progress", { attrs: { "aria-label": "Progress" } });
  private readonly text = el("p", { class: "quiet" });
  private readonly error = el("p", { class: "job-error", attrs: { role: "alert" } });
  private readonly said = el("pre", { class: "said", attrs: { tabindex: "0", "aria-label": "What the verb says" } });
  private readonly answer: HTMLFormElement;
  private readonly curve = new SearchCurve();
  private readonly joint = el("div", { class: "joint-picture", hidden: true, attrs: { role: "img" } });
  private readonly result = el("div", { class: "result" });
  private readonly stop: HTMLButtonElement;
  private shown: Job["state"] | null = null;

  constructor(id: string, verb: string, jobs: Jobs, attempt: (act: () => Promise<void>) => void) {
    this.title = el("h2", {}, verb);
    this.stop = button("Stop this", () => attempt(() => jobs.stop(id)));
    const line = el("input", { type: "text", attrs: { "aria-label": `Answer to ${verb}` } });
    this.answer = el("form", { class: "row", on: { submit: (event) => {
      event.preventDefault();
      attempt(() => jobs.answer(id, line.value));
      line.value = "";
    } } }, line, el("button", { type: "submit" }, "Answer"));
    this.element = el("section", { class: "card job" },
      el("div", { class: "row" }, this.title, this.state, el("span", { class: "gap" }), this.stop),
      this.bar, this.text, this.curve.element, this.error, this.said, this.joint, this.answer, this.result);
  }

  show(job: Job): void {
    const running = job.state === "running";
    setText(this.state, job.state);
    this.state.dataset["state"] = job.state === "failed" ? "fault" : running ? "following" : job.state;
    this.stop.hidden = this.bar.hidden = !running;
    this.answer.hidden = !running || !job.said.length; // a verb that asks has said what
    if (job.progress) {
      this.bar.max = job.progress.total || 1;
      this.bar.value = job.progress.done;
    } else {
      this.bar.removeAttribute("value");
    }
    setText(this.text, job.progress && running ? this.step(job.progress) : "");
    setText(this.error, job.error ?? "");
    const lines = job.said.filter((line) => line !== `greywhale: ${job.error}`).join("\n");
    this.said.hidden = !lines;
    this.showJoint(running && job.verb === "calibrate" ? job.said.at(-1) ?? "" : "");
    if (this.said.textContent !== lines) {
      this.said.textContent = lines;
      this.said.scrollTop = this.said.scrollHeight;
    }
    if (job.state !== this.shown && job.result !== null) this.showResult(job.result, job.summary);
    this.shown = job.state;
  }

  /** The positive way of the joint that a line asks for, a part of the picture that docs/calibrate.md has. */
  private showJoint(line: string): void {
    const asked = ASKED.exec(line)?.[1];
    this.joint.hidden = asked === undefined;
    if (asked === undefined || asked === this.joint.dataset["joint"]) return;
    this.joint.dataset["joint"] = asked;
    this.joint.setAttribute("aria-label", `The positive way of joint ${asked}`);
  }

  /** The step that is done now; a cost is in the curve, any other note stands beside. */
  private step(progress: NonNullable<Job["progress"]>): string {
    return this.curve.hear(progress) || !progress.note ? progress.text : `${progress.text} (${progress.note})`;
  }

  /** The terminal's words first; who wants each number opens the details. */
  private showResult(result: Json, summary: string | null): void {
    const { curves = null, ...rest }: Entries = isRecord(result) ? result : { result };
    this.curve.end(curves);
    const trials = trialsIn(rest);
    const shown = trials.length ? { ...rest, trials: trials.map(({ predicted, measured, ...other }) => other) } : rest;
    const details = describe(shown, 0);
    this.result.replaceChildren(
      ...(summary ? [inWords(summary)] : []),
      ...(trials.length ? [predictedBeside(trials)] : []),
      summary ? el("details", {}, el("summary", {}, "Details"), details) : details);
  }
}

const COLUMNS = /\S {2,}\S/; // of a line that stands in a table

/** A text as a terminal prints it: sentences break where the page ends, lines of tables do not. */
function inWords(text: string): HTMLElement {
  const lines = text.split("\n").map((line) => el("div", COLUMNS.test(line) ? { class: "columns" } : {}, line || "\u00a0"));
  return el("div", { class: "summary", attrs: { tabindex: "0", role: "region", "aria-label": "Result" } }, ...lines);
}

const DEEPEST = 6;
const MOST_SHOWN = 24; // of a list of numbers
const MOST_COLUMNS = 4;

/** JSON as nested tables; numbers with the digits that a person reads. */
function describe(value: Json, depth: number): HTMLElement {
  if (Array.isArray(value) && value.every((one) => typeof one !== "object" || one === null)) {
    const more = value.length > MOST_SHOWN ? `, ... (${value.length} in all)` : "";
    return el("span", {}, value.slice(0, MOST_SHOWN).map(plain).join(", ") + more);
  }
  if (typeof value !== "object" || value === null) return el("span", {}, plain(value as Exclude<Json, object>));
  if (isMatrix(value)) return el("span", {}, `${value.length} x ${value[0]?.length ?? 0} numbers`);
  if (Array.isArray(value) && value.length > 1 && value.every(isRecord)) return table(value.filter(isRecord));
  if (Array.isArray(value) && value.length === 1) return describe(value[0] as Json, depth);
  if (depth >= DEEPEST) return el("code", {}, JSON.stringify(value));
  const rows = Object.entries(value).map(([key, inner]) =>
    el("div", { class: "entry" }, el("span", { class: "quiet" }, key.replace(/_/g, " ")), describe(inner as Json, depth + 1)));
  return el("div", { class: "entries" }, ...rows);
}

function isMatrix(value: Json): value is readonly (readonly number[])[] {
  const isRow = (row: Json): boolean => Array.isArray(row) && row.length > 0 && row.every((one) => typeof one === "number");
  return Array.isArray(value) && value.length > 1 && value.every(isRow);
}

type Entries = { readonly [key: string]: Json };

function isRecord(value: Json): value is Entries {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

/** Objects of one kind: four joints side by side, many findings one below the other. */
function table(records: readonly Entries[]): HTMLElement {
  const keys = [...new Set(records.flatMap((record) => Object.keys(record)))];
  const cell = (record: Entries, key: string): HTMLElement => el("td", {}, describe(record[key] ?? null, DEEPEST));
  const head = (key: string, scope: string): HTMLElement => el("th", { attrs: { scope } }, key.replace(/_/g, " "));
  const rows = records.length > MOST_COLUMNS
    ? [el("tr", {}, ...keys.map((key) => head(key, "col"))), ...records.map((record) => el("tr", {}, ...keys.map((key) => cell(record, key))))]
    : keys.map((key) => el("tr", {}, head(key, "row"), ...records.map((record) => cell(record, key))));
  return el("div", { class: "scroll", attrs: { tabindex: "0" } }, el("table", {}, el("tbody", {}, ...rows)));
}

function plain(value: Json): string {
  if (typeof value === "number") return Number.isInteger(value) ? String(value) : String(Number(value.toPrecision(5)));
  return value === null ? "–" : String(value);
}
