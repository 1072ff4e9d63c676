// One job: how far it is, what it says and asks, its result or its error.

import { button, el, setText } from "../../parts/dom";
import { objectIn, type Job, type Jobs, type Json } from "../../session/services";
import type { Telling } from "../../session/host_types";
import type { ReadLog } from "./motions_picture";
import { predictedBeside, trialsIn } from "./predicted";
import { SearchCurve } from "./search_curve";
import { setsPictures } from "./sets_picture";
import { tellingElements, type OpenVerb } from "./telling";

/** What a card's buttons and pictures need of the view around it. */
export type Around = { readonly open: OpenVerb; readonly log: ReadLog };

export class JobCard {
  readonly element: HTMLElement;
  private readonly title: HTMLElement;
  private readonly state = el("span", { class: "pill", attrs: { role: "status" } });
  private readonly bar = el("progress", { attrs: { "aria-label": "Progress" } });
  private readonly text = el("p", { class: "quiet" });
  private readonly error = el("p", { class: "job-error", attrs: { role: "alert" } });
  private readonly said = el("pre", { class: "said", attrs: { tabindex: "0", "aria-label": "What the verb says" } });
  private readonly curve = new SearchCurve();
  private readonly result = el("div", { class: "result" });
  private readonly stop: HTMLButtonElement;
  private shown: Job["state"] | null = null;

  constructor(
    id: string, verb: string, jobs: Jobs, attempt: (act: () => Promise<void>) => void, private readonly around: Around,
  ) {
    this.title = el("h2", {}, verb);
    this.stop = button("Stop this", () => attempt(() => jobs.stop(id)));
    this.element = el("section", { class: "card job" },
      el("div", { class: "row" }, this.title, this.state, el("span", { class: "gap" }), this.stop),
      this.bar, this.text, this.curve.element, this.error, this.said, this.result);
  }

  show(job: Job): void {
    const running = job.state === "running";
    setText(this.state, job.state);
    this.state.dataset["state"] = job.state === "failed" ? "fault" : running ? "following" : job.state;
    this.stop.hidden = this.bar.hidden = !running;
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
    if (this.said.textContent !== lines) {
      this.said.textContent = lines;
      this.said.scrollTop = this.said.scrollHeight;
    }
    if (job.state !== this.shown && job.result !== null) this.showResult(job.result, job.telling);
    this.shown = job.state;
  }

  /** The step that is done now; a cost is in the curve, any other note stands beside. */
  private step(progress: NonNullable<Job["progress"]>): string {
    return this.curve.hear(progress) || !progress.note ? progress.text : `${progress.text} (${progress.note})`;
  }

  /** What the terminal says first; who wants each number opens the details. */
  private showResult(result: Json, telling: Telling | null): void {
    const record = objectIn(result);
    this.curve.end(record["curves"] ?? null);
    const trials = trialsIn(record);
    const pictures = [...setsPictures(record), ...(trials.length ? [predictedBeside(trials)] : [])];
    const told = tellingElements(telling ?? { parts: [], steps: [] }, this.around.log, this.around.open, pictures);
    this.result.replaceChildren(
      el("div", { class: "told", attrs: { role: "group", "aria-label": "Result" } }, ...told), details(result, telling === null));
  }
}

/** The answer as a program gets it. */
function details(result: Json, open: boolean): HTMLElement {
  const text = el("pre", { class: "said", attrs: { tabindex: "0", "aria-label": "Details" } }, jsonText(result));
  return el("details", open ? { attrs: { open: "" } } : {}, el("summary", {}, "Details"), text);
}

/** JSON with a line for each value; what holds plain values alone stands in one. */
function jsonText(value: Json, indent = ""): string {
  const inner = typeof value === "object" && value !== null ? Object.values(value) : [];
  if (!inner.some((one) => typeof one === "object" && one !== null)) return JSON.stringify(value);
  const deeper = `${indent}  `;
  const lines = Array.isArray(value)
    ? value.map((one: Json) => deeper + jsonText(one, deeper))
    : Object.entries(value as object).map(([key, one]) => `${deeper}${JSON.stringify(key)}: ${jsonText(one as Json, deeper)}`);
  const [begin, end] = Array.isArray(value) ? "[]" : "{}";
  return `${begin}\n${lines.join(",\n")}\n${indent}${end}`;
}
