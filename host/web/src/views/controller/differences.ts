// The settings in which the edited controllers differ from others: a row each, a column for each joint.

import { el, tableHead } from "../../parts/dom";
import { SETTING_NAMES } from "../../session/law";
import { JOINTS } from "../../session/samples";
import type { Four } from "./draft";
import { changeOf, told } from "./numbers";

export class Differences {
  readonly element: HTMLElement;
  private readonly found = el("div", { class: "differences" });

  /** `others` are the controllers that each change begins with, in a word. */
  constructor(private readonly title: string, private readonly others: string) {
    this.element = el("div", {}, el("h2", {}, title), this.found);
  }

  /** `none` is said where both are the same. */
  show(mine: Four, other: Four, none: string): void {
    const rows = SETTING_NAMES.filter((name) => mine.some((settings, joint) => settings[name] !== other[joint]![name]));
    if (!rows.length) {
      this.say(none);
      return;
    }
    const body = rows.map((name) => el("tr", {}, el("th", { attrs: { scope: "row" } }, told(name).label), ...mine.map((settings, joint) => {
      const from = other[joint]![name];
      return el("td", {}, from === settings[name] ? "" : changeOf(name, from, settings[name]));
    })));
    const joints = Array.from({ length: JOINTS }, (_, joint) => `Joint ${joint}`);
    this.found.replaceChildren(el("div", { class: "scroll", attrs: { tabindex: "0", role: "region", "aria-label": this.title } },
      el("table", {}, tableHead(`${this.others} → edited`, ...joints), el("tbody", {}, ...body))));
  }

  say(words: string): void {
    this.found.replaceChildren(...(words ? [el("p", { class: "quiet" }, words)] : []));
  }
}
