// The way to one's own arm: its steps as cards, of which the next one is open.

import { el } from "../../parts/dom";
import { JobCard } from "../verbs/job_card";
import type { Job, Services } from "../../session/services";
import type { Session } from "../../session/session";
import { Facts } from "./facts";
import { StepCard } from "./step_card";
import { stepsOf, type Paths, type Step } from "./steps";

export class Way {
  readonly element: HTMLElement;
  private readonly facts: Facts;
  private readonly steps: readonly Step[];
  private readonly cards: readonly StepCard[];
  private readonly results = new Map<string, JobCard>(); // by job
  private next = -1;
  private reading = false;

  /** `services` are those of a host, `docs` the folder of the documentation; null without. */
  constructor(private readonly session: Session, private readonly services: Services | null, private readonly paths: Paths, docs: string | null) {
    this.facts = new Facts(session, services, (job) => this.heard(job));
    this.steps = stepsOf(this.facts, paths);
    this.cards = this.steps.map((step, place) => new StepCard(session, place + 1, step, docs));
    this.element = el("section", { class: "way", attrs: { "aria-label": "The way to your own arm" } },
      el("h2", {}, "The way to your own arm"),
      el("p", { class: "quiet" }, paths.practice
        ? "Practise it here: each step is the one that a real arm needs."
        : "Each step says whether it is done, as the board and the folder are now."),
      el("div", { class: "way-steps" }, ...this.cards.map(({ element }) => element)));
    session.changed.on(() => this.show());
    session.parametersChanged.on(() => {
      this.facts.compare();
      this.show();
    });
  }

  /** Looks at the folder, where there is one; several verbs may have ended at once. */
  enter(): void {
    if (this.reading) return;
    this.reading = true;
    void this.session.attempt(() => this.facts.readFolder()).then(() => {
      this.reading = false;
      this.show();
    });
  }

  private show(): void {
    const next = this.steps.findIndex((step) => step.look().done === false);
    this.cards.forEach((card, place) => card.show(place === next));
    if (next === this.next) return;
    if (this.next >= 0) this.cards[this.next]!.element.open = false;
    if (next >= 0) this.cards[next]!.element.open = true;
    this.next = next;
  }

  private heard(job: Job): void {
    const { services } = this;
    const place = this.steps.findIndex(({ verbs }) => verbs.includes(job.verb));
    if (!services || place < 0) return;
    let card = this.results.get(job.id);
    if (!card) {
      card = new JobCard(job.id, job.verb, services.jobs, (act) => void this.session.attempt(act), {
        open: (verb, given) => this.paths.open?.(verb, given),
        log: (file) => services.log(file),
      });
      this.results.set(job.id, card);
      this.cards[place]!.showResult(card.element);
    }
    card.show(job);
    if (job.state === "running") this.show();
    else this.enter();
  }
}
