// The running measures of the last ten seconds, a row a joint.

import { el, setText, tableHead } from "../../parts/dom";
import { measure } from "../../session/measures";
import { JOINTS, type Samples } from "../../session/samples";

const EVERY_MS = 1000;

export class MeasuresTable {
  readonly element: HTMLElement;
  private readonly cells: HTMLTableCellElement[][] = [];
  private measured = 0;

  constructor(private readonly samples: Samples) {
    const rows = Array.from({ length: JOINTS }, (_, joint) => {
      const cells = [0, 1, 2].map(() => el("td", {}, "–"));
      this.cells.push(cells);
      return el("tr", {}, el("th", { attrs: { scope: "row" } }, el("span", { class: `key key-${joint}` }), ` ${joint}`), ...cells);
    });
    const head = tableHead("joint", "error rms mrad", "ripple V rms", "delay ms");
    this.element = el("section", { class: "card" },
      el("h2", {}, "Last ten seconds"), el("table", {}, head, el("tbody", {}, ...rows)));
  }

  /** Measures anew, once a second at most. */
  refresh(): void {
    const now = performance.now();
    if (now < this.measured + EVERY_MS) return;
    this.measured = now;
    measure(this.samples)?.forEach(({ errorRms, rippleRms, delay }, joint) => {
      const texts = [(1000 * errorRms).toFixed(1), rippleRms.toFixed(2), delay === null ? "–" : (1000 * delay).toFixed(0)];
      texts.forEach((text, place) => setText(this.cells[joint]![place]!, text));
    });
  }
}
