// The paper's measures of the chosen logs, as the verb `evaluate` says them.

import { el, setText, tableHead } from "../../parts/dom";
import type { Services, Job } from "../../session/services";

type JointMeasures = {
  readonly mse_rad2: number;
  readonly steady_state_error_rad: number | null;
  readonly settling_error_rad: number | null;
  readonly time_delay_s: number | null;
};
type Evaluation = { readonly joints: readonly JointMeasures[]; readonly remarks: readonly string[] };

const COLUMNS = [
  ["mean squared error rad²", "mse_rad2", 6],
  ["steady-state error rad", "steady_state_error_rad", 4],
  ["settling error rad", "settling_error_rad", 4],
  ["delay s", "time_delay_s", 4],
] as const;

export class LogMeasures {
  readonly element = el("div");
  private readonly body = el("tbody");
  private readonly words = el("p", { class: "problem", attrs: { role: "status" } });
  private logs: readonly string[] = [];
  private joint = 0;
  private asked = ""; // the id of the job that measures them
  private readonly ended = new Map<string, Job>(); // jobs of evaluate, which may end before their id is known here
  private readonly own = new Set<string>(); // jobs that were asked for here; their cards stand nowhere else

  constructor(private readonly services: Pick<Services, "jobs">, private readonly attempt: (act: () => Promise<void>) => Promise<boolean>) {
    this.element.append(
      el("div", { class: "scroll", attrs: { tabindex: "0", role: "region", "aria-label": "Measures" } },
        el("table", { class: "values" }, tableHead("log", ...COLUMNS.map(([title]) => title)), this.body)),
      this.words);
    services.jobs.listen((job) => {
      if (job.verb !== "evaluate" || job.state === "running") return;
      this.ended.set(job.id, job);
      if (job.id === this.asked) this.show();
      this.putAway(job.id);
    });
  }

  /** Takes the card of an own job that has ended out of the list of all jobs: its result stands here. */
  private putAway(id: string): void {
    if (!this.own.has(id) || !this.ended.has(id)) return;
    this.own.delete(id);
    void this.attempt(() => this.services.jobs.putAway(id));
  }

  /** Has these logs measured. */
  async measure(logs: readonly string[]): Promise<void> {
    this.logs = logs;
    this.asked = "";
    this.show();
    if (!logs.length) return;
    const id = await this.services.jobs.start("evaluate", { logs });
    this.own.add(id);
    this.putAway(id);
    if (this.logs !== logs) return; // others were chosen meanwhile
    this.asked = id;
    this.show();
  }

  showJoint(joint: number): void {
    this.joint = joint;
    this.show();
  }

  private show(): void {
    const job = this.ended.get(this.asked);
    const found = (job?.result ?? { logs: [] }) as unknown as { readonly logs: readonly Evaluation[] };
    this.body.replaceChildren(...this.logs.map((log, place) => el("tr", {},
      el("th", { attrs: { scope: "row" } }, el("span", { class: `key key-${place}` }), log),
      ...COLUMNS.map(([, name, digits]) => {
        const value = found.logs[place]?.joints[this.joint]?.[name];
        return el("td", {}, value === undefined ? (job ? "" : "…") : value === null ? "–" : value.toFixed(digits));
      }))));
    setText(this.words, job?.error ?? found.logs.flatMap(({ remarks }) => remarks).join(" "));
  }
}
