// The curve of a search: the best cost so far, live from what a verb tells of its progress, and each joint's at the end.

import { el, setText } from "../../parts/dom";
import { curvesPicture } from "../../parts/curves";
import type { Job, Json } from "../../session/services";

const COST = /^(cost|J) (\d+(?:\.\d+)?)$/; // what a verb that searches notes beside its progress
const LEAST_STEP = 0.002; // of a search; what is closer to the last point takes its place

type Found = { readonly evaluations: readonly number[]; readonly cost: readonly number[] };

export class SearchCurve {
  readonly element = el("figure", { class: "search", hidden: true });
  private readonly words = el("figcaption", { class: "quiet" });
  private readonly share: number[] = [];
  private readonly cost: number[] = [];

  constructor() {
    this.element.append(this.words);
  }

  /** Takes the cost that stands in a note; false where it holds none. */
  hear({ done, total, note }: NonNullable<Job["progress"]>): boolean {
    const found = COST.exec(note);
    if (!found) return false;
    const share = (100 * done) / (total || 1);
    const last = this.share.at(-1) ?? -1;
    if (share < last) this.share.length = this.cost.length = 0; // another search
    const near = this.share.length > 1 && share - last < 100 * LEAST_STEP;
    const place = this.share.length - (near ? 1 : 0);
    this.share[place] = near ? last : share;
    this.cost[place] = Number(found[2]);
    setText(this.words, `Best ${found[1]} so far: ${found[2]}`);
    this.draw("% of the search", [{ x: this.share, y: this.cost, shade: "accent" }]);
    return true;
  }

  /** Draws the curves that a result holds, in place of what was told before. */
  end(curves: Json): void {
    const found = (Array.isArray(curves) ? curves : []) as readonly Found[];
    const drawn = found.flatMap(({ evaluations, cost }, joint) =>
      cost.length ? [{ x: evaluations, y: cost, shade: `joint-${joint}` }] : []);
    if (!drawn.length) return;
    this.words.replaceChildren("Best cost of each joint: ", ...found.flatMap(({ cost }, joint) =>
      cost.length ? [el("span", { class: `key key-${joint}` }), ` ${joint}  `] : []));
    this.draw("evaluations", drawn);
  }

  private draw(unit: string, curves: Parameters<typeof curvesPicture>[2]): void {
    this.element.hidden = false;
    this.element.replaceChildren(this.words, curvesPicture("Curve of the search", unit, curves));
  }
}
