// Every verb of greywhale by a form, and what it does: progress, questions, results and errors as in the terminal.

import { button, el } from "../../parts/dom";
import { sentenceOf } from "../../parts/sentence";
import type { View } from "../view";
import type { HostState, Services, Job, Verb } from "../../session/services";
import type { Session } from "../../session/session";
import { makeField } from "./fields";
import { VerbForm, type Given } from "./form";
import { JobCard } from "./job_card";
import type { OpenVerb } from "./telling";
import { Questions } from "./questions";

type Shown = { readonly element: HTMLElement; readonly card: JobCard; readonly foot: HTMLElement; ended: boolean; error: string };

export class DoView implements View {
  readonly name = "Do";
  readonly withoutBoard = true;
  readonly element: HTMLElement;
  private readonly list = el("div", { class: "verbs" });
  private readonly reading = el("p", { class: "quiet", hidden: true, attrs: { role: "status" } }, "Reading what can be done ...");
  private readonly form = el("section", { class: "card", hidden: true });
  private readonly jobs = el("div", { class: "side jobs" });
  private readonly none = el("p", { class: "quiet" }, "Nothing was started yet.");
  private readonly allAway = button("Put all away that ended", () => void this.session.attempt(() => this.putAllAway()), { hidden: true });
  private readonly cards = new Map<string, Shown>();
  private readonly choices = new Map<string, HTMLButtonElement>();
  private read: Promise<readonly Verb[]> | null = null;
  private shown: { readonly verb: Verb; readonly form: VerbForm } | null = null;
  private turn = 0;
  private started = ""; // the id of the job that the form has started

  /** `next` opens what comes after a verb. */
  constructor(private readonly session: Session, private readonly services: Services, private readonly next: OpenVerb) {
    this.jobs.append(this.none, this.allAway);
    this.element = el("div", { class: "do" },
      el("section", { class: "card" }, el("h2", {}, "What shall greywhale do?"), this.reading, this.list), this.form, this.jobs);
    session.changed.on(() => this.showReason());
    services.jobs.listen((job) => this.heard(job), (id) => this.forget(id));
  }

  enter(): void {
    void this.session.attempt(async () => void await this.verbs());
  }

  /** Opens the form of a verb with these fields filled in. Whoever calls it brings the view to the front. */
  async open(name: string, given: Given = {}): Promise<void> {
    const turn = ++this.turn;
    this.shown = null;
    this.form.replaceChildren();
    await this.session.attempt(async () => {
      const verb = (await this.verbs()).find((one) => one.verb === name);
      if (!verb) throw new Error(`There is no form for \`${name}\`; run \`greywhale ${name}\` in a terminal.`);
      const state = await this.services.state();
      if (turn !== this.turn) return; // another form was asked for meanwhile
      const form = this.formOf(verb, state);
      this.shown = { verb, form };
      this.started = "";
      this.form.replaceChildren(form.element);
      this.form.hidden = false;
      for (const [one, choice] of this.choices) choice.setAttribute("aria-pressed", String(one === name));
      form.fill(given);
      this.showReason();
      this.form.scrollIntoView({ block: "nearest" });
      if (Object.keys(given).length) form.focus();
    });
  }

  /** The verbs, which are read once, and listed. */
  private verbs(): Promise<readonly Verb[]> {
    this.reading.hidden = this.choices.size > 0;
    this.read ??= this.services.jobs.verbs().then((verbs) => {
      this.listVerbs(verbs);
      return verbs;
    }, (error: unknown) => {
      this.read = null; // the next look asks again
      throw error;
    }).finally(() => { this.reading.hidden = true; });
    return this.read;
  }

  private listVerbs(verbs: readonly Verb[]): void {
    for (const name of new Set(verbs.map(({ group }) => group))) {
      const group = el("div", { class: "verb-group", attrs: { role: "group", "aria-label": name } }, el("h3", {}, name));
      for (const { verb, title, help } of verbs.filter((one) => one.group === name)) {
        const choice = button(title, () => void this.open(verb), { title: `${help} (${verb})`, attrs: { "aria-pressed": "false", "data-verb": verb } });
        this.choices.set(verb, choice);
        group.append(choice);
      }
      this.list.append(group);
    }
  }

  private formOf(verb: Verb, state: HostState): VerbForm {
    const fields = verb.arguments.map((argument) => argument.kind === "answers"
      ? new Questions(argument, (answers) => this.services.questions(answers), (act) => void this.session.attempt(act))
      : makeField(argument, state));
    const form: VerbForm = new VerbForm(verb, state, fields, (given) => void this.session.attempt(async () => {
      try {
        this.started = await this.services.jobs.start(verb.verb, given);
        this.blame(); // it may have failed before its id is known here
      } catch (error) {
        if (!form.blame(sentenceOf(error))) throw error;
      }
    }));
    return form;
  }

  private showReason(): void {
    this.shown?.form.refuse(this.whyNot(this.shown.verb));
  }

  /** The reason why a verb cannot be started from this page now, in a sentence; empty where it can. */
  private whyNot({ board }: Verb): string {
    const { link, whyNotChange } = this.session;
    if (board === "none") return "";
    if (!link.open && board === "lent") return link.sentence || "No board is there yet.";
    return whyNotChange;
  }

  private heard(job: Job): void {
    const shown = this.cards.get(job.id) ?? this.add(job);
    shown.card.show(job);
    if (!shown.ended && job.state !== "running") this.renew();
    shown.ended = job.state !== "running";
    shown.foot.hidden = !shown.ended;
    shown.error = job.state === "failed" ? job.error ?? "" : "";
    this.showAway();
    if (job.id === this.started) this.blame();
  }

  /** Tells the form which files there are, after a verb that may have written some. */
  private renew(): void {
    const { shown } = this;
    if (shown) void this.session.attempt(async () => shown.form.renew(await this.services.state()));
  }

  /** Says beside its field why the verb that was started last has failed. */
  private blame(): void {
    const { error = "" } = this.cards.get(this.started) ?? {};
    if (error) this.shown?.form.blame(error);
  }

  private add({ id, verb, arguments: given, state }: Job): Shown {
    const card = new JobCard(id, verb, this.services.jobs, (act) => void this.session.attempt(act), {
      open: this.next,
      log: (file) => this.services.log(file),
    });
    const away = button("Put away", () => void this.session.attempt(() => this.services.jobs.putAway(id)), { title: "Take this card away; files stay" });
    const again = button("Change and repeat", () => void this.open(verb, given), { title: `Opens the form of ${verb} as it was filled in` });
    const foot = el("div", { class: "row away" }, again, away);
    card.element.append(foot);
    const shown = { element: card.element, card, foot, ended: false, error: "" };
    this.cards.set(id, shown);
    this.none.remove();
    this.allAway.after(card.element);
    if (state === "running") card.element.scrollIntoView({ block: "nearest" });
    return shown;
  }

  private forget(id: string): void {
    this.cards.get(id)?.element.remove();
    this.cards.delete(id);
    if (!this.cards.size) this.jobs.prepend(this.none);
    this.showAway();
  }

  private get ended(): readonly string[] {
    return [...this.cards].filter(([, { ended }]) => ended).map(([id]) => id);
  }

  private showAway(): void {
    this.allAway.hidden = this.ended.length < 2;
  }

  private async putAllAway(): Promise<void> {
    for (const id of this.ended) await this.services.jobs.putAway(id);
  }
}
