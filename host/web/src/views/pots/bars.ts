// All eight potentiometers live, a bar each: what they read, where that is in an angle, and a mark at a rail.

import { el, setText } from "../../parts/dom";
import { FULL_SCALE, POTS, potReading } from "../../session/pots";
import { JOINT_NAMES, JOINTS } from "../../session/samples";
import type { Session } from "../../session/session";

type Bar = {
  readonly row: HTMLElement; readonly track: HTMLElement; readonly counts: HTMLElement; readonly degrees: HTMLElement;
  low: number; high: number; // since it was asked for
};

export class PotBars {
  readonly element: HTMLElement;
  private readonly bars: readonly Bar[] = POTS.map((pot) => bar(pot));
  private asked: readonly number[] = [];
  private seen = 0; // samples that the ways of those that are asked for have taken in

  constructor(private readonly session: Session) {
    const arm = (name: string, first: number): HTMLElement => el("div", { class: "pots-arm" }, el("h3", {}, name),
      ...this.bars.slice(first, first + JOINTS).map(({ row }) => row));
    this.element = el("div", { class: "pots", attrs: { role: "group", "aria-label": "Potentiometers" } }, arm("Leader", 0), arm("Follower", JOINTS));
  }

  /** Marks those that somebody is to move, and shows from now on how far each of them has gone. */
  ask(pots: readonly number[]): void {
    this.asked = pots;
    this.seen = this.session.samples.end;
    this.bars.forEach((one, pot) => {
      [one.low, one.high] = [Infinity, -Infinity];
      one.row.classList.toggle("asked", pots.includes(pot));
    });
  }

  frame(): void {
    const { samples, parameters } = this.session;
    if (!samples.end || !parameters) return;
    for (const pot of this.asked) this.widen(pot, parameters);
    this.seen = samples.end;
    this.bars.forEach((one, pot) => {
      const reading = potReading(samples, samples.end - 1, pot, parameters);
      one.row.hidden = reading === null;
      if (reading) show(one, reading.counts, reading.degrees, reading.atRail);
    });
  }

  private widen(pot: number, parameters: readonly number[]): void {
    const { samples } = this.session;
    const one = this.bars[pot]!;
    for (let number = Math.max(this.seen, samples.first); number < samples.end; number++) {
      const counts = potReading(samples, number, pot, parameters)?.counts ?? NaN;
      if (counts < one.low) one.low = counts;
      if (counts > one.high) one.high = counts;
    }
  }
}

function bar(pot: number): Bar {
  const track = el("div", { class: "pot-track", attrs: { "aria-hidden": "true" } }, el("i"), el("b"));
  const [counts, degrees] = [el("span", { class: "number" }), el("span", { class: "number quiet" })];
  const row = el("div", { class: "pot" }, el("span", {}, JOINT_NAMES[pot % JOINTS]!), track, counts, degrees);
  return { row, track, counts, degrees, low: Infinity, high: -Infinity };
}

function show({ row, track, counts, degrees, low, high }: Bar, value: number, angle: number | null, atRail: boolean): void {
  const text = value.toFixed(0);
  const words = atRail ? `${text} at a rail` : text;
  if (counts.textContent !== words || high > low) {
    const percent = (count: number): string => `${(100 * count / FULL_SCALE).toFixed(1)}%`;
    track.style.setProperty("--at", percent(value));
    track.style.setProperty("--low", percent(high > low ? low : value));
    track.style.setProperty("--high", percent(high > low ? high : value));
  }
  setText(counts, words);
  setText(degrees, angle === null ? "" : `${Math.round(angle) || 0}°`);
  row.classList.toggle("rail", atRail);
}
