// A form for a verb, made from its arguments as the host names them. What is wrong is said beside its field.

import { el } from "../../parts/dom";
import { grey, reasonFor, showReason } from "../../parts/grey";
import type { HostState, Verb } from "../../session/services";
import type { Field } from "./fields";

export type Given = Readonly<Record<string, unknown>>;

const OPTION = /--[a-z][a-z-]*/g;

export class VerbForm {
  readonly element = el("form", { class: "verb-form", attrs: { novalidate: "" } });
  private readonly more = el("details", {}, el("summary", {}, "More"));
  private readonly start = el("button", { type: "submit", class: "primary" });
  private readonly reason = el("p", { class: "reason", hidden: true, attrs: { role: "status" } });

  constructor(verb: Verb, { folder }: HostState, private readonly fields: readonly Field[], start: (given: Given) => void) {
    this.start.append(`Start ${verb.verb}`);
    reasonFor(this.reason, this.start);
    const first = fields.filter(({ argument }) => argument.first);
    const others = fields.filter(({ argument }) => !argument.first);
    this.more.append(...others.map(({ element }) => element));
    this.element.append(el("h2", {}, verb.title, " ", el("code", {}, verb.verb)), el("p", {}, verb.help),
      ...first.map(({ element }) => element), ...(others.length ? [this.more] : []), this.start, this.reason,
      ...(fields.some(({ argument }) => argument.kind === "file") ? [el("p", { class: "quiet" }, "Files are in ", el("code", {}, folder), ".")] : []));
    this.element.addEventListener("submit", (event) => {
      event.preventDefault();
      for (const field of fields) field.blame("");
      const wrong = fields.find((field) => field.problem());
      if (wrong) this.show(wrong, wrong.problem());
      else start(this.given());
    });
  }

  /** Takes a person to its start, for all that it needs is filled in. */
  focus(): void {
    this.start.focus();
  }

  /** Takes no start as long as there is a reason. */
  refuse(reason: string): void {
    grey(this.start, reason, "");
    showReason(this.reason, reason);
  }

  /** Takes in which files there are now. */
  renew(state: HostState): void {
    for (const field of this.fields) field.renew(state);
  }

  fill(given: Given): void {
    for (const field of this.fields) {
      const value = given[field.argument.name];
      if (value !== undefined) field.set(value);
      if (value !== undefined && !field.argument.first) this.more.open = true;
    }
  }

  /** Says a sentence beside the field that it is about; false where it names none. */
  blame(sentence: string): boolean {
    const found = this.about(sentence);
    if (!found) return false;
    const label = (option: string): string => {
      const field = this.fields.find(({ argument }) => argument.option === option);
      return field ? `"${field.argument.label}"` : option;
    };
    this.show(found, sentence.replace(OPTION, label));
    return true;
  }

  /** The field that a sentence names: by its label, its word on the command line, or a file that was given there. */
  private about(sentence: string): Field | undefined {
    const option = sentence.match(OPTION)?.find((one) => this.fields.some(({ argument }) => argument.option === one));
    const begins = (text: string): boolean => sentence.startsWith(`${text}:`) || sentence.startsWith(`${text},`) || sentence.startsWith(`${text} is `);
    return this.fields.find(({ argument }) => begins(argument.label))
      ?? this.fields.find((field) => [field.value()].flat().some((value) => typeof value === "string" && begins(value)))
      ?? this.fields.find(({ argument }) => option !== undefined && argument.option === option);
  }

  private show(field: Field, sentence: string): void {
    if (this.more.contains(field.element)) this.more.open = true;
    field.blame(sentence);
    const { activeElement } = document;
    if (activeElement === document.body || activeElement === this.start) field.focus();
  }

  /** The values that a person gave; what was left as it is, is left out. */
  private given(): Given {
    const values = this.fields.map((field) => [field.argument.name, field.value()] as const);
    return Object.fromEntries(values.filter(([, value]) => value !== undefined));
  }
}
