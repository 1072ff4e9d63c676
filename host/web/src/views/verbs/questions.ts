// The questions about an arm as a field of a form: the host says which follow from the answers so far.

import { el, setText } from "../../parts/dom";
import type { Argument, ArmAnswers, Heading, Question } from "../../session/services";
import type { Field } from "./fields";

type Input = HTMLInputElement | HTMLSelectElement;

/** One question; its words change with the answers to others. */
class Row {
  readonly element: HTMLElement;
  private readonly input: Input;
  private readonly label = el("label");
  private readonly help: HTMLElement;
  private readonly wrong: HTMLElement;
  private asked: Question;

  constructor(question: Question, answered: () => void) {
    this.asked = question;
    const id = `question-${question.where.replace(/\W/g, "-")}`;
    this.label.htmlFor = id;
    this.help = el("p", { class: "quiet", attrs: { id: `${id}-help` } });
    this.wrong = el("p", { class: "field-problem", hidden: true, attrs: { id: `${id}-problem`, role: "alert" } });
    const names = question.choices.map((one) => el("option", { value: one }, one));
    const list = el("datalist", { attrs: { id: `${id}-list` } });
    if (names.length && !question.number) {
      this.input = el("select", {}, el("option", { value: "" }), ...names);
    } else {
      this.input = el("input", { type: "text", attrs: names.length ? { list: list.id } : {} });
      list.append(...names);
    }
    this.input.id = id;
    this.input.name = question.where;
    this.input.setAttribute("aria-describedby", `${this.help.id} ${this.wrong.id}`);
    this.input.addEventListener("change", answered);
    this.input.value = question.given;
    this.element = el("div", { class: "argument" }, this.label, el("div", { class: "answer" }, this.input, list, this.wrong, this.help));
    this.show(question);
  }

  get where(): string {
    return this.asked.where;
  }

  get problem(): string {
    return this.asked.problem && `${this.asked.text}: ${this.asked.problem}`;
  }

  get value(): string {
    return this.input.value.trim();
  }

  show(question: Question): void {
    this.asked = question;
    setText(this.label, question.unit ? `${question.text}, ${question.unit}` : question.text);
    setText(this.help, question.help);
    if (this.input instanceof HTMLInputElement) this.input.placeholder = question.usual;
    else setText(this.input.options[0]!, `as usual: ${question.usual}`);
    setText(this.wrong, question.problem && `${question.text}: ${question.problem}`);
    this.wrong.hidden = !question.problem;
    this.input.setAttribute("aria-invalid", String(question.problem !== ""));
  }

  focus(): void {
    this.element.closest("details")!.open = true;
    this.input.focus();
  }
}

export class Questions implements Field {
  readonly element = el("div", { class: "questions" });
  private readonly wrong = el("p", { class: "field-problem", hidden: true, attrs: { role: "alert" } });
  private readonly sections = new Map<string, { readonly element: HTMLDetailsElement; readonly rows: HTMLElement }>();
  private rows = new Map<string, Row>();
  private turn = 0;

  constructor(
    readonly argument: Argument, private readonly questions: (answers: ArmAnswers) => Promise<readonly Heading[]>,
    private readonly attempt: (act: () => Promise<void>) => void,
  ) {
    this.element.append(el("p", { class: "quiet" },
      "What you leave empty is taken as it stands there in grey. A number may have another unit: 14 cm, 5 kg cm."), this.wrong);
    this.ask({});
  }

  value(): Readonly<Record<string, string>> {
    return Object.fromEntries([...this.rows.values()].filter(({ value }) => value).map(({ where, value }) => [where, value]));
  }

  set(value: unknown): void {
    if (typeof value !== "string") return;
    this.rows.clear();
    this.ask(value);
  }

  renew(): void {
    // it names no files
  }

  problem(): string {
    return this.wrongRow?.problem ?? "";
  }

  blame(sentence: string): void {
    const own = this.wrongRow === undefined ? sentence : ""; // a question has its own words beside it
    setText(this.wrong, own);
    this.wrong.hidden = !own;
  }

  focus(): void {
    (this.wrongRow ?? [...this.rows.values()][0])?.focus();
  }

  private get wrongRow(): Row | undefined {
    return [...this.rows.values()].find(({ problem }) => problem);
  }

  private ask(answers: ArmAnswers): void {
    const turn = ++this.turn;
    this.attempt(async () => {
      const headings = await this.questions(answers);
      if (turn === this.turn) this.show(headings);
    });
  }

  /** Keeps each row that is still asked, and with it what somebody is writing there. */
  private show(headings: readonly Heading[]): void {
    const focused = document.activeElement;
    const before = this.rows;
    this.rows = new Map();
    for (const { heading, questions } of headings) {
      const rows = questions.map((question) => {
        const row = before.get(question.where) ?? new Row(question, () => this.ask(this.value()));
        row.show(question);
        this.rows.set(question.where, row);
        return row.element;
      });
      const section = this.section(heading);
      if (rows.length !== section.rows.childElementCount || rows.some((one, place) => one !== section.rows.children[place])) {
        section.rows.replaceChildren(...rows);
      }
    }
    for (const [heading, { element }] of this.sections) element.hidden = !headings.some((one) => one.heading === heading);
    if (focused instanceof HTMLElement && this.element.contains(focused)) focused.focus();
  }

  private section(heading: string): { readonly element: HTMLDetailsElement; readonly rows: HTMLElement } {
    let section = this.sections.get(heading);
    if (!section) {
      const rows = el("div", { class: "rows" });
      const element = el("details", { attrs: this.sections.size ? {} : { open: "" } }, el("summary", {}, heading), rows);
      section = { element, rows };
      this.sections.set(heading, section);
      this.element.append(element);
    }
    return section;
  }
}
