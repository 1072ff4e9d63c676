// The GWO-WOA that `greywhale tune` searches with (greywhale/optimise/shift_invariant.py, which explains it), bit for bit.

import type { SearchData } from "./data";
import type { Random } from "./random";

export type Elementary = { exp(x: number): number; log(x: number): number; cos(x: number): number };
export type Rows = readonly (readonly number[])[];
export type Bounds = readonly (readonly [number, number])[];

export function clip(value: number, low: number, high: number): number {
  return Math.min(Math.max(value, low), high);
}

/** Points of the unit cube, one in each of `count` equal slices of every coordinate. */
export function latinHypercube(random: Random, count: number, dimensions: number): number[][] {
  const keys = random.rows(count, dimensions);
  const within = random.rows(count, dimensions);
  const order = Array.from({ length: dimensions }, (_, d) =>
    Array.from({ length: count }, (_, i) => i).sort((a, b) => keys[a]![d]! - keys[b]![d]!));
  return within.map((row, i) => row.map((part, d) => (order[d]![i]! + part) / count));
}

export class WolfWhale {
  private pack: Rows = []; // in units of the box
  private costs: readonly number[] = [];
  private tried: Rows = [];
  private left: number;
  private whole = true; // whether all of the last batch is within the budget

  /** `start` are points of the first pack. */
  constructor(
    private readonly how: SearchData, private readonly bounds: Bounds, budget: number, private readonly random: Random,
    private readonly size: number, private readonly start: Rows, private readonly math: Elementary,
  ) {
    this.left = budget;
  }

  get done(): boolean {
    return this.left <= 0;
  }

  /** The candidates to evaluate next. */
  ask(): Rows {
    const all = this.pack.length ? this.move() : this.first();
    this.whole = all.length <= this.left;
    return all.slice(0, this.left);
  }

  tell(costs: readonly number[]): void {
    this.left -= costs.length;
    if (!this.whole) return;
    const values = costs.map((cost) => (Number.isFinite(cost) ? cost : Infinity));
    if (!this.pack.length) {
      [this.pack, this.costs] = [this.tried, values];
      return;
    }
    const better = values.map((cost, wolf) => cost < this.costs[wolf]!);
    this.pack = this.pack.map((place, wolf) => (better[wolf] ? this.tried[wolf]! : place));
    this.costs = this.costs.map((cost, wolf) => (better[wolf] ? values[wolf]! : cost));
  }

  private first(): Rows {
    const scattered = this.inBox(latinHypercube(this.random, this.size, this.bounds.length));
    const pack = scattered.map((place, wolf) => this.start[wolf] ?? place);
    this.tried = pack.map((place) => place.map((value, d) => {
      const [low, high] = this.bounds[d]!;
      return clip((value - low) / (high - low), 0, 1);
    }));
    return pack;
  }

  private inBox(unit: Rows): Rows {
    return unit.map((place) => place.map((value, d) => {
      const [low, high] = this.bounds[d]!;
      return clip(low + value * (high - low), low, high);
    }));
  }

  private move(): Rows {
    this.tried = this.broughtBack(this.someKept(this.hunt()));
    return this.inBox(this.tried);
  }

  private hunt(): Rows {
    const { random, pack, bounds, how: { a, weights } } = this;
    const order = pack.map((_, wolf) => wolf).sort((one, other) => compare(this.costs[one]!, this.costs[other]!));
    const leaders = weights.map((_, place) => pack[order[place]!]!);
    const [r1, r2] = [0, 1].map(() => weights.map(() => random.rows(pack.length, bounds.length))) as [number[][][], number[][][]];
    const alpha = this.alphaFactors();
    const origin = bounds.map((_, d) => pack.reduce((sum, place) => sum + place[d]!, 0) / pack.length);
    return pack.map((place, wolf) => place.map((value, d) => {
      let moved = 0;
      leaders.forEach((leader, k) => {
        const bigA = 2 * a * r1[k]![wolf]![d]! - a;
        let distance = Math.abs(2 * r2[k]![wolf]![d]! * (leader[d]! - origin[d]!) - (value - origin[d]!));
        if (k === 0) distance *= alpha[wolf]!;
        moved += weights[k]! * (leader[d]! - bigA * distance);
      });
      return moved;
    }));
  }

  /** Of each wolf: encircling, or the whale's spiral. */
  private alphaFactors(): number[] {
    const [p, l, gamma, rho] = [0, 1, 2, 3].map(() => this.random.some(this.pack.length)) as [number[], number[], number[], number[]];
    return p.map((coin, wolf) => {
      const curl = 2 * l[wolf]! - 1;
      return coin < 0.5 ? gamma[wolf]! : rho[wolf]! * this.math.exp(curl) * this.math.cos(2 * Math.PI * curl);
    });
  }

  private someKept(moved: Rows): Rows {
    const size = this.bounds.length;
    const kept = this.random.rows(moved.length, size);
    const changes = this.random.some(moved.length).map((number) => Math.floor(number * size));
    return moved.map((place, wolf) => place.map((value, d) =>
      (kept[wolf]![d]! < this.how.keep && changes[wolf] !== d ? this.pack[wolf]![d]! : value)));
  }

  private broughtBack(moved: Rows): Rows {
    const part = this.random.rows(moved.length, this.bounds.length);
    return moved.map((place, wolf) => place.map((value, d) => {
      const [before, share] = [this.pack[wolf]![d]!, part[wolf]![d]!];
      return value < 0 ? before * share : value > 1 ? 1 - (1 - before) * share : value;
    }));
  }
}

function compare(one: number, other: number): number {
  return one < other ? -1 : one > other ? 1 : 0; // their difference is no number where both are infinite
}
