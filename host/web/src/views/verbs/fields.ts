// The fields of a form: one for each argument of a verb, by its kind, with its label in words.

import { el, setText } from "../../parts/dom";
import { fileWords, freeName } from "../../parts/file_words";
import type { Argument, HostState, NamedFile } from "../../session/services";

/** A field as its form sees it; an undefined value was left as it is. */
export interface Field {
  readonly argument: Argument;
  readonly element: HTMLElement;
  value(): unknown;
  set(value: unknown): void;
  /** Takes in which files there are now; what a person chose stays. */
  renew(state: HostState): void;
  /** The reason why it cannot be taken as it is, in a sentence, "" if it can. */
  problem(): string;
  /** Shows a reason beside it; "" takes it away. */
  blame(sentence: string): void;
  focus(): void;
}

/** A field for every kind but the answers about an arm. */
export function makeField(argument: Argument, state: HostState): Field {
  const field = fieldOf(argument);
  field.renew(state);
  return field;
}

function fieldOf(argument: Argument): Field {
  if (argument.kind === "flag") return new Flag(argument);
  if (argument.kind === "choice" && !argument.many) return new Choice(argument, argument.choices.map((one) => ({ value: one, text: one })));
  if (argument.kind === "file" && argument.files.length) return argument.many ? new FileBoxes(argument) : new FileChoice(argument);
  return new Line(argument);
}

/** The name of a new file as usual, "" where that is free, or the next that is. */
function proposed({ kind, default: usual }: Argument, { files }: HostState): string {
  if (kind !== "file" || typeof usual !== "string") return "";
  const free = freeName(usual, files);
  return free === usual ? "" : free;
}

/** The folder's files that an argument takes, the newest first. */
function fitting({ files }: Argument, state: HostState): readonly NamedFile[] {
  return state.files.filter(({ kind }) => files.includes(kind)).sort((one, other) => other.changed_s - one.changed_s);
}

/** The words that every field has: label, what it is, its word on the command line, and what is wrong with it. */
abstract class Labelled implements Field {
  readonly element = el("div", { class: "argument" });
  protected readonly text: string;
  private readonly wrong = el("p", { class: "field-problem", hidden: true, attrs: { role: "alert" } });
  private readonly help: HTMLElement;

  constructor(readonly argument: Argument) {
    this.text = argument.unit ? `${argument.label}, ${argument.unit}` : argument.label;
    this.help = el("p", { class: "quiet", attrs: { id: `argument-${argument.name}-help` } },
      argument.help, ...(argument.option ? [" ", el("code", {}, argument.option)] : []));
    this.wrong.id = `argument-${argument.name}-problem`;
  }

  abstract value(): unknown;
  abstract set(value: unknown): void;
  protected abstract readonly target: HTMLElement;

  renew(_state: HostState): void {
    // most fields know no files
  }

  problem(): string {
    return this.argument.required && this.value() === undefined ? `${this.argument.label}: this is needed.` : "";
  }

  blame(sentence: string): void {
    setText(this.wrong, sentence);
    this.wrong.hidden = !sentence;
    this.target.setAttribute("aria-invalid", String(sentence !== ""));
  }

  focus(): void {
    this.target.focus();
  }

  /** Puts the field together. */
  protected lay(input: HTMLElement, ...more: HTMLElement[]): void {
    const { target } = this;
    target.id ||= `argument-${this.argument.name}`;
    target.setAttribute("aria-describedby", `${this.help.id} ${this.wrong.id}`);
    target.addEventListener("input", () => this.blame(""));
    const takesLabel = target instanceof HTMLInputElement || target instanceof HTMLSelectElement;
    this.element.append(takesLabel ? el("label", { attrs: { for: target.id } }, this.text) : el("span", {}, this.text),
      el("div", { class: "answer" }, input, ...more, this.wrong, this.help));
  }
}

class Flag extends Labelled {
  protected readonly target = el("input", { type: "checkbox" });

  constructor(argument: Argument) {
    super(argument);
    this.target.name = argument.name;
    this.lay(this.target);
    this.element.classList.add("flag");
  }

  value(): true | undefined {
    return this.target.checked || undefined;
  }

  set(value: unknown): void {
    this.target.checked = value === true;
  }
}

/** Text, a number, or several with commas between. */
class Line extends Labelled {
  protected readonly target = el("input", { type: "text" });
  private proposed = "";

  constructor(argument: Argument) {
    super(argument);
    this.target.name = argument.name;
    if (argument.kind === "number") this.target.inputMode = "decimal";
    this.target.placeholder = String(argument.default ?? argument.shape);
    this.target.required = argument.required;
    this.lay(this.target, ...(argument.many ? [el("p", { class: "quiet" }, "Several with commas between.")] : []));
  }

  value(): unknown {
    const text = this.target.value.trim();
    if (!text) return undefined;
    if (this.argument.many) return text.split(",").map((one) => one.trim()).filter((one) => one);
    return this.argument.kind === "number" ? Number(text) : text;
  }

  set(value: unknown): void {
    this.target.value = Array.isArray(value) ? value.join(", ") : String(value);
  }

  override renew(state: HostState): void {
    const isOurs = this.target.value === this.proposed;
    this.proposed = proposed(this.argument, state);
    if (isOurs) this.target.value = this.proposed;
  }

  override problem(): string {
    const { label, kind, least, most, unit } = this.argument;
    const value = this.value();
    if (kind !== "number" || typeof value !== "number") return super.problem();
    if (!Number.isFinite(value)) return `${label} is "${this.target.value.trim()}", but it must be a number.`;
    if (least !== null && value < least) return `${label} is ${value}, but it must be at least ${least} ${unit}`.trim() + ".";
    if (most !== null && value > most) return `${label} is ${value}, but it must be at most ${most} ${unit}`.trim() + ".";
    return "";
  }
}

type Offer = { readonly value: string; readonly text: string; readonly group?: string };

/** One of some values, or the usual one. */
class Choice extends Labelled {
  protected readonly target = el("select");

  constructor(argument: Argument, offers: readonly Offer[], ...more: HTMLElement[]) {
    super(argument);
    this.target.name = argument.name;
    this.offer(offers);
    this.lay(this.target, ...more);
  }

  /** Offers these; what is chosen stays. */
  protected offer(offers: readonly Offer[]): void {
    const { required, default: usual } = this.argument;
    const { value: chosen } = this.target;
    this.target.replaceChildren(el("option", { value: "" }, required ? "choose ..." : `as usual${usual === null ? "" : `: ${String(usual)}`}`));
    for (const { value, text, group } of offers) {
      if (group && this.target.lastElementChild?.getAttribute("label") !== group) {
        this.target.append(el("optgroup", { attrs: { label: group } }));
      }
      (group ? this.target.lastElementChild! : this.target).append(el("option", { value }, text));
    }
    if (chosen) this.set(chosen);
  }

  value(): string | undefined {
    return this.target.value || undefined;
  }

  set(value: unknown): void {
    const known = [...this.target.options].some((one) => one.value === value);
    if (!known) this.target.append(el("option", { value: String(value) }, String(value)));
    this.target.value = String(value);
  }
}

const ELSEWHERE = "\n"; // no file is called so

/** A file of the folder, or what comes with greywhale. */
class FileChoice extends Choice {
  private readonly other: HTMLInputElement;

  constructor(argument: Argument) {
    const other = el("input", { type: "text", hidden: true, attrs: { "aria-label": `${argument.label}: another name` } });
    super(argument, [], other);
    this.other = other;
    this.target.addEventListener("change", () => {
      other.hidden = this.target.value !== ELSEWHERE;
      if (!other.hidden) other.focus();
    });
  }

  override renew(state: HostState): void {
    const { files } = this.argument;
    const builtIn = [...(files.includes("arm") ? state.arms : []), ...(files.includes("controller") ? state.controllers : [])];
    this.offer([
      ...fitting(this.argument, state).map((file) => ({ value: file.name, text: `${file.name} (${fileWords(file)})`, group: state.folder })),
      ...builtIn.map((name) => ({ value: name, text: name, group: "Comes with greywhale" })),
      { value: ELSEWHERE, text: "another name ...", group: "Elsewhere in the folder" },
    ]);
  }

  override value(): string | undefined {
    return this.target.value === ELSEWHERE ? this.other.value.trim() || undefined : super.value();
  }
}

/** Several files of the folder. */
class FileBoxes extends Labelled {
  protected readonly target = el("div", { class: "boxes", attrs: { role: "group", tabindex: "-1" } });
  private readonly others: HTMLInputElement;

  constructor(argument: Argument) {
    super(argument);
    this.target.setAttribute("aria-label", this.text);
    this.others = el("input", { type: "text", attrs: { "aria-label": `${this.text}: other names`, placeholder: "other names, with commas between" } });
    this.lay(this.target, this.others);
  }

  override renew(state: HostState): void {
    const { name, files } = this.argument;
    const chosen = this.value();
    const boxes = fitting(this.argument, state).map((file) => el("label", {},
      el("input", { type: "checkbox", value: file.name, attrs: { name } }), ` ${file.name} `, el("span", { class: "quiet" }, fileWords(file))));
    this.target.replaceChildren(...(boxes.length ? boxes : [el("p", { class: "quiet" }, `The folder holds no ${files.join(" or ")} yet.`)]));
    if (chosen) this.set(chosen);
  }

  override focus(): void {
    (this.boxes[0] ?? this.others).focus();
  }

  private get boxes(): HTMLInputElement[] {
    return [...this.target.querySelectorAll("input")];
  }

  value(): readonly string[] | undefined {
    const chosen = this.boxes.filter(({ checked }) => checked).map(({ value }) => value);
    const others = this.others.value.split(",").map((one) => one.trim()).filter((one) => one);
    const all = [...chosen, ...others];
    return all.length ? all : undefined;
  }

  set(value: unknown): void {
    const names = (Array.isArray(value) ? value : [value]).map(String);
    const known = new Set(this.boxes.map((box) => box.value));
    for (const box of this.boxes) box.checked = names.includes(box.value);
    this.others.value = names.filter((one) => !known.has(one)).join(", ");
  }
}
