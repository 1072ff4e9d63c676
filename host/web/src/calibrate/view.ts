// From potentiometers mounted anyhow to angles, by hand: a sweep, two poses of known angles, and what they give is stored.

import { LinkError } from "../link/declared";
import { potName, upperFirst } from "../link/refusal";
import { State, TABLE } from "../link/schema";
import { button, el, setText } from "../parts/dom";
import type { View } from "../parts/view";
import { traceOf } from "../samples/samples";
import type { Session } from "../session";
import { countsOf, jointsInUse, JOINTS, solve, type Ends, type Pose } from "./solve";

const POTS = 2 * JOINTS;
const HELD_TICKS = 500; // that a pose is looked at
const MEAN_TICKS = 100;
const STILL_COUNTS = 3; // between its beginning and its end
const SECOND_RAD = 1;

export class CalibrateView implements View {
  readonly name = "Calibrate";
  readonly element: HTMLElement;
  private sweep: { low: number; high: number }[] = [];
  private looked: number | null = null; // the sample up to which the sweep was looked at; null while there is none
  private readonly poses: (Pose | null)[] = [null, null];
  private readonly sweeping = button("Begin the sweep", () => void this.session.attempt(() => this.sweepOrEnd()));
  private readonly keep = button("Store", () => void this.session.attempt(() => this.store()), { class: "primary", title: "Work out zeros, scales and limits, run and store them" });
  private readonly said = el("p", { attrs: { role: "status" } });
  private readonly cells: HTMLTableCellElement[][] = [];

  constructor(private readonly session: Session) {
    const head = ["potentiometer", "reads", "least", "most"].map((text) => el("th", { attrs: { scope: "col" } }, text));
    const rows = Array.from({ length: POTS }, (_, pot) => {
      const cells = ["", "", ""].map((text) => el("td", {}, text));
      this.cells.push(cells);
      return el("tr", {}, el("th", { attrs: { scope: "row" } }, upperFirst(potName(pot))), ...cells);
    });
    this.element = el("div", { class: "editor" },
      el("section", { class: "card connect" },
        el("h2", {}, "1 Sweep"), el("p", {}, "The motors stay off. Turn every joint of both arms from one end to the other."),
        el("div", { class: "row" }, this.sweeping),
        ...this.pose(0, "2 First pose", 0), ...this.pose(1, "3 Second pose", SECOND_RAD),
        el("h2", {}, "4 Store"), el("div", { class: "row" }, this.keep), this.said),
      el("section", { class: "card" }, el("h2", {}, "Counts of 1023"),
        el("table", {}, el("thead", {}, el("tr", {}, ...head)), el("tbody", {}, ...rows)),
        el("p", { class: "quiet" }, "greywhale calibrate does more: it names mistakes of the wiring, compares the arms without a protractor, and finds the motors' directions.")));
  }

  private pose(place: number, title: string, rad: number): HTMLElement[] {
    const inputs = Array.from({ length: JOINTS }, (_, joint) =>
      el("input", { type: "number", value: String(rad), attrs: { step: "any", "aria-label": `${title.slice(2)}, joint ${joint}, rad` } }));
    const take = button(`Take the ${title.slice(2).toLowerCase()}`, () => void this.session.attempt(async () => {
      this.poses[place] = { angles: inputs.map(({ value }) => Number(value)), counts: this.still(await this.running()) };
      this.tell(`${title.slice(2)} is taken.`);
    }));
    return [el("h2", {}, title), el("p", {}, "Hold both arms still with these angles of joint 0 to 3, in rad."),
      el("div", { class: "row" }, ...inputs, take)];
  }

  private tell(sentence: string): void {
    setText(this.said, sentence);
  }

  /** The set that runs, by which the counts are known; the motors must be off. */
  private async running(): Promise<readonly number[]> {
    if (this.session.motorsOn || this.session.state === State.is.boot) throw new LinkError("Calibrate with the motors off; press Stop first.");
    return this.session.readParameters();
  }

  private async sweepOrEnd(): Promise<void> {
    if (this.looked === null) {
      await this.running();
      this.sweep = Array.from({ length: POTS }, () => ({ low: Infinity, high: -Infinity }));
      this.looked = this.session.samples.end;
    } else {
      this.look();
      this.looked = null;
      this.tell("The sweep is taken.");
    }
    setText(this.sweeping, this.looked === null ? "Begin the sweep" : "End the sweep");
  }

  private counts(number: number, raw: readonly number[]): number[] {
    return Array.from({ length: POTS }, (_, pot) =>
      countsOf(this.session.samples.count(number, traceOf(pot < JOINTS ? "leader" : "follower", pot % JOINTS)), pot, raw));
  }

  private look(): void {
    const { samples, parameters } = this.session;
    if (this.looked === null || !parameters) return;
    for (let number = Math.max(this.looked, samples.first); number < samples.end; number++) {
      this.counts(number, parameters).forEach((count, pot) => {
        const ends = this.sweep[pot]!;
        ends.low = Math.min(ends.low, count);
        ends.high = Math.max(ends.high, count);
      });
    }
    this.looked = samples.end;
  }

  /** The counts of arms that were held still. */
  private still(raw: readonly number[]): number[] {
    const { samples } = this.session;
    if (samples.end - samples.first < HELD_TICKS) throw new LinkError("There are too few samples yet; hold the pose for half a second.");
    const mean = (from: number, count: number): number[] => {
      const rows = Array.from({ length: count }, (_, i) => this.counts(from + i, raw));
      return Array.from({ length: POTS }, (_, pot) => rows.reduce((sum, row) => sum + row[pot]!, 0) / count);
    };
    const begin = samples.end - HELD_TICKS;
    const [before, after] = [mean(begin, MEAN_TICKS), mean(samples.end - MEAN_TICKS, MEAN_TICKS)];
    const moved = jointsInUse(raw).flatMap((joint) => [joint, JOINTS + joint]).find((pot) => Math.abs(after[pot]! - before[pot]!) > STILL_COUNTS);
    if (moved !== undefined) throw new LinkError(`${upperFirst(potName(moved))} moved; hold both arms still for half a second, and take the pose again.`);
    return mean(begin, HELD_TICKS);
  }

  private async store(): Promise<void> {
    const [first, second] = this.poses;
    if (!this.sweep.length || this.looked !== null || !first || !second) throw new LinkError("Take the sweep and both poses first.");
    const before = await this.running();
    const found = solve(this.sweep as readonly Ends[], first, second, jointsInUse(before));
    await this.session.apply(TABLE.parameters.map(({ name, index }) => found.get(name) ?? before[index]!));
    await this.session.store();
    this.tell("Zeros, scales and limits run and are stored.");
  }

  frame(): void {
    const { samples, parameters } = this.session;
    if (!parameters || !samples.end) return;
    this.look();
    this.counts(samples.end - 1, parameters).forEach((count, pot) => {
      const { low, high } = this.sweep[pot] ?? { low: Infinity, high: -Infinity };
      [count, low, high].forEach((value, place) => setText(this.cells[pot]![place]!, Number.isFinite(value) ? value.toFixed(1) : "–"));
    });
  }
}
