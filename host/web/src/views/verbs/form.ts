// A form for a verb, made from its arguments as the host names them.

import { el } from "../../parts/dom";
import { grey, reasonFor, showReason } from "../../parts/grey";
import type { Argument, NamedFile, Verb } from "../../session/services";

type Field = { readonly argument: Argument; readonly input: HTMLInputElement | HTMLSelectElement };

export class VerbForm {
  readonly element = el("form", { class: "verb-form" });
  private readonly fields: readonly Field[];
  private readonly start: HTMLButtonElement;
  private readonly reason = el("p", { class: "reason", hidden: true, attrs: { role: "status" } });

  constructor(verb: Verb, files: readonly NamedFile[], start: (given: Record<string, unknown>) => void) {
    this.start = el("button", { type: "submit", class: "primary" }, `Start ${verb.verb}`);
    reasonFor(this.reason, this.start);
    const names = el("datalist", { attrs: { id: "host-files" } }, ...files.map(({ name }) => el("option", { value: name })));
    this.fields = verb.arguments.map((argument) => ({ argument, input: field(argument) }));
    const rows = this.fields.map(({ argument, input }) => ({ argument, row: row(argument, input) }));
    const needed = rows.filter(({ argument }) => argument.required);
    const others = rows.filter(({ argument }) => !argument.required);
    this.element.append(el("p", {}, verb.help), names, ...needed.map(({ row }) => row),
      this.start, this.reason);
    if (others.length) {
      const more = el("details", { attrs: needed.length ? {} : { open: "" } }, el("summary", {}, needed.length ? "More" : "Options"), ...others.map(({ row }) => row));
      this.element.append(more);
    }
    this.element.addEventListener("submit", (event) => {
      event.preventDefault();
      start(this.given());
    });
  }

  /** Takes no start as long as there is a reason. */
  show(reason: string): void {
    grey(this.start, reason, "");
    showReason(this.reason, reason);
  }

  /** Fills in values of arguments by their names, as `given` has them. */
  fill(given: Readonly<Record<string, unknown>>): void {
    for (const { argument, input } of this.fields) {
      const value = given[argument.name];
      if (value === undefined) continue;
      if (argument.kind === "flag") (input as HTMLInputElement).checked = value === true;
      else input.value = Array.isArray(value) ? value.join(", ") : String(value);
      input.closest("details")?.setAttribute("open", "");
    }
  }

  /** The values that a person gave; what was left as it is, is left out. */
  private given(): Record<string, unknown> {
    const given: Record<string, unknown> = {};
    for (const { argument, input } of this.fields) {
      if (argument.kind === "flag") {
        if ((input as HTMLInputElement).checked) given[argument.name] = true;
      } else if (input.value.trim()) {
        const texts = argument.many ? input.value.split(",").map((text) => text.trim()) : [input.value.trim()];
        const values = argument.kind === "number" ? texts.map(Number) : texts;
        given[argument.name] = argument.many ? values : values[0];
      }
    }
    return given;
  }
}

function field(argument: Argument): HTMLInputElement | HTMLSelectElement {
  if (argument.kind === "choice" && !argument.many) {
    return el("select", {}, el("option", { value: "" }, "as usual"), ...argument.choices.map((one) => el("option", { value: one }, one)));
  }
  if (argument.kind === "flag") return el("input", { type: "checkbox" });
  const input = el("input", {
    type: argument.kind === "number" && !argument.many ? "number" : "text",
    attrs: {
      ...(argument.kind === "file" ? { list: "host-files" } : {}),
      ...(argument.kind === "number" ? { step: "any" } : {}),
      ...(argument.default === null || argument.default === undefined ? {} : { placeholder: String(argument.default) }),
    },
  });
  input.required = argument.required;
  return input;
}

function row(argument: Argument, input: HTMLElement): HTMLElement {
  const more = argument.many ? " (several: with commas between)" : "";
  input.id = `argument-${argument.name}`;
  const help = el("span", { class: "quiet", attrs: { id: `${input.id}-help` } }, argument.help + more);
  input.setAttribute("aria-describedby", help.id);
  return el("div", { class: "argument" },
    el("label", { attrs: { for: input.id } }, argument.name.replace(/_/g, " ")), input, help);
}
