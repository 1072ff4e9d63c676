// What a person breaks on the bench, and where: faults in groups, as people say them.

import type { Bench, BenchControls, PossibleFault } from "../../session/services";
import { upperFirst } from "../../link/refusal";
import { button, el, select, setText } from "../../parts/dom";
import { JOINT_NAMES } from "../../session/samples";
import type { Session } from "../../session/session";

export class Faults {
  readonly element: HTMLElement;
  private readonly words = el("p", { class: "quiet" });
  private readonly place = select<string>("Where", [], () => undefined);
  private readonly fault: HTMLSelectElement;
  private readonly broken = el("ul", { class: "differences" });

  constructor(private readonly session: Session, private readonly bench: Bench, private readonly faults: readonly PossibleFault[]) {
    this.fault = select("Fault", [], () => this.choose());
    const groups = [...new Set(faults.map(({ group }) => group))];
    this.fault.append(...groups.map((group) => el("optgroup", { attrs: { label: group } },
      ...faults.filter((one) => one.group === group).map(({ name, title }) => el("option", { value: name }, title)))));
    this.choose();
    this.element = el("section", { class: "card" }, el("h2", {}, "Break something"),
      el("div", { class: "row choices" }, this.fault, this.place),
      el("div", { class: "row" }, button("Break", () => void this.break()), button("Mend all", () => void this.mend())),
      this.words, this.broken);
  }

  /** Shows what is broken now, where the bench tells. */
  show({ broken }: BenchControls): void {
    if (broken) this.broken.replaceChildren(...broken.map((name) => el("li", {}, this.wordsFor(name))));
  }

  private chosen(): PossibleFault {
    return this.faults.find(({ name }) => name === this.fault.value)!;
  }

  private choose(): void {
    const { description, places } = this.chosen();
    setText(this.words, `${upperFirst(description)}.`);
    const before = this.place.value;
    this.place.replaceChildren(...places.map((one) => el("option", { value: one }, placeName(one))));
    if (places.includes(before)) this.place.value = before;
    this.place.hidden = !places.length;
  }

  private async break(): Promise<void> {
    const name = this.place.hidden ? this.fault.value : `${this.fault.value}:${this.place.value}`;
    if (await this.session.attempt(() => this.bench.change({ fault: name }))) this.broken.append(el("li", {}, this.wordsFor(name)));
  }

  private async mend(): Promise<void> {
    if (await this.session.attempt(() => this.bench.change({ fault: null }))) this.broken.replaceChildren();
  }

  private wordsFor(wish: string): string {
    const [name, place] = wish.split(":");
    const title = this.faults.find((one) => one.name === name)?.title ?? wish;
    return place === undefined ? title : `${title}: ${placeName(place)}`;
  }
}

/** The words for follower1, which is a potentiometer, or 1, which is a motor. */
function placeName(place: string): string {
  const joint = Number(place.slice(-1));
  const side = place.slice(0, -1);
  return side ? `${side} potentiometer ${joint}, ${JOINT_NAMES[joint]}` : `motor ${joint}, ${JOINT_NAMES[joint]}`;
}
