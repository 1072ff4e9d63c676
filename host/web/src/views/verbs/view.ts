// Every verb of greywhale by a form, and what it does: progress, questions, results and errors as in the terminal.

import { button, el } from "../../parts/dom";
import type { View } from "../view";
import type { Services, Job, Verb } from "../../session/services";
import type { Session } from "../../session/session";
import { VerbForm } from "./form";
import { JobCard } from "./job_card";

export class DoView implements View {
  readonly name = "Do";
  readonly withoutBoard = true;
  readonly element: HTMLElement;
  private readonly list = el("div", { class: "verbs", attrs: { role: "group", "aria-label": "Verbs" } });
  private readonly reading = el("p", { class: "quiet", hidden: true, attrs: { role: "status" } }, "Reading what can be done ...");
  private readonly form = el("div");
  private readonly jobs = el("div", { class: "side jobs" });
  private readonly none = el("p", { class: "quiet" }, "Nothing was started yet.");
  private showReason = (): void => undefined; // of the verb whose form is there
  private readonly cards = new Map<string, JobCard>();

  constructor(private readonly session: Session, private readonly services: Services) {
    this.jobs.append(this.none);
    this.element = el("div", { class: "editor" },
      el("section", { class: "card" }, el("h2", {}, "What shall greywhale do?"), this.reading, this.list, this.form),
      this.jobs);
    session.changed.on(() => this.showReason());
    services.jobs.listen((job) => this.heard(job));
  }

  enter(): void {
    if (this.list.childElementCount) return;
    this.reading.hidden = false;
    const read = this.session.attempt(async () => {
      const verbs = await this.services.jobs.verbs();
      this.list.replaceChildren(...verbs.map((verb) => {
        return button(verb.verb, () => void this.session.attempt(() => this.choose(verb)), {
          title: verb.help, attrs: { "aria-pressed": "false" },
        });
      }));
    });
    void read.then(() => { this.reading.hidden = true; });
  }

  /** Shows the form of a verb with values filled in. */
  async open(name: string, given: Readonly<Record<string, unknown>>): Promise<void> {
    const verb = (await this.services.jobs.verbs()).find((one) => one.verb === name);
    if (!verb) return;
    await this.choose(verb, given);
    this.form.scrollIntoView({ block: "nearest" });
    this.form.querySelector<HTMLButtonElement>("button[type=submit]")?.focus();
  }

  private async choose(verb: Verb, given: Readonly<Record<string, unknown>> = {}): Promise<void> {
    for (const choice of this.list.children) choice.setAttribute("aria-pressed", String(choice.textContent === verb.verb));
    const { files } = await this.services.state();
    const form = new VerbForm(verb, files, (asked) =>
      void this.session.attempt(async () => void await this.services.jobs.start(verb.verb, asked)));
    form.fill(given);
    this.form.replaceChildren(form.element);
    this.showReason = () => form.show(this.whyNot(verb));
    this.showReason();
  }

  /** The reason why a verb cannot be started from this page now, in a sentence; empty where it can. */
  private whyNot({ board }: Verb): string {
    const { link, whyNotChange } = this.session;
    if (board === "none") return "";
    if (!link.open && board === "lent") return link.sentence || "No board is there yet.";
    return whyNotChange;
  }

  private heard(job: Job): void {
    let card = this.cards.get(job.id);
    if (!card) {
      card = new JobCard(job.id, job.verb, this.services.jobs, (act) => void this.session.attempt(act), {
        open: (verb, given) => void this.session.attempt(() => this.open(verb, given)),
        log: (file) => this.services.log(file),
      });
      this.cards.set(job.id, card);
      this.none.remove();
      this.jobs.prepend(card.element);
      if (job.state === "running") card.element.scrollIntoView({ block: "nearest" });
    }
    card.show(job);
  }
}
