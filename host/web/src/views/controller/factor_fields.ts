// The fields of one joint's factors, in the units of the paper's names.

import { TABLE } from "../../link/schema";
import { el } from "../../parts/dom";
import { FACTOR_NAMES, type FactorName, type Settings } from "../../session/law";
import { parameterName } from "./draft";
import { textOf, told } from "./numbers";

export class FactorFields {
  readonly element: HTMLElement;
  private readonly inputs = new Map<FactorName, HTMLInputElement>();

  /** `typed` gets each raw value that a person gives, `refused` a sentence about one that no board takes. */
  constructor(private readonly typed: (name: FactorName, raw: number) => void, private readonly refused: (sentence: string) => void) {
    this.element = el("div", { class: "factors" }, ...FACTOR_NAMES.map((name) => {
      const { label, unit, step } = told(name);
      const { description, minimum, maximum } = TABLE.named(parameterName(0, name));
      const input = el("input", { type: "number", title: description, attrs: {
        step: "any", min: String(minimum * step), max: String(maximum * step),
      }, on: { change: () => this.take(name) } });
      this.inputs.set(name, input);
      return el("label", { class: "factor" }, el("span", {}, `${label} ${unit}`), input);
    }));
  }

  private take(name: FactorName): void {
    const { minimum, maximum } = TABLE.named(parameterName(0, name));
    const { label, unit, step } = told(name);
    const { value } = this.inputs.get(name)!;
    const raw = Math.round(Number(value) / step);
    if (value !== "" && raw >= minimum && raw <= maximum) this.typed(name, raw);
    else this.refused(`${label} is ${value || "empty"}; choose a value from ${textOf(name, minimum)} to ${textOf(name, maximum)} ${unit}.`);
  }

  show(settings: Settings): void {
    for (const [name, input] of this.inputs) {
      if (document.activeElement !== input) input.value = textOf(name, settings[name]);
    }
  }
}
