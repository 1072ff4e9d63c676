// The search of `greywhale tune` (greywhale/tune/default.py and search/lockstep.py): four optimisers in lockstep, in stages.

import type { Controllers, Found, Row, SearchData, Stage } from "./data";
import { ALL } from "./module";
import { Random } from "./random";
import { rint, Space } from "./space";
import { clip, latinHypercube, WolfWhale, type Elementary } from "./wolf_whale";

export class Search implements Found {
  best: Row[];
  cost: number[] = ALL.map(() => Infinity);
  evaluations = 0;
  readonly curve: [number, number[]][] = [];
  private refines = false; // after the first stage

  constructor(
    private readonly how: SearchData, private readonly before: Controllers, private readonly math: Elementary,
    private readonly costs: (candidates: readonly Controllers[], refine: boolean) => number[][],
  ) {
    this.best = [...before];
  }

  /** Spends the budget, a batch at each step. */
  *run(): Generator<Found, void> {
    yield this.tryAgain();
    const { stages, budget } = this.how;
    for (const [number, stage] of stages.entries()) {
      const left = budget - this.evaluations;
      this.refines = number > 0;
      let share = number === stages.length - 1 ? left : Math.min(left, rint(stage.share * budget));
      if (number && share > stage.groups.length) {
        yield this.tryAgain();
        share--;
      }
      if (share >= stage.groups.length) yield* this.runStage(stage, Math.floor(share / stage.groups.length));
    }
  }

  /** Judges the best of all joints together anew: what neighbours do counts, and by now they do better. */
  private tryAgain(): Found {
    this.cost = ALL.map(() => Infinity);
    return this.take([[...this.best]], ALL.map(() => 1));
  }

  private *runStage(stage: Stage, budget: number): Generator<Found, void> {
    const { how } = this;
    const space = new Space(how, how.spaces[stage.space], stage.space === "reduced", this.math);
    const packs = ALL.map((joint) => {
      const random = new Random(stage.random[joint]!);
      const start = space.point(this.best[joint]!);
      const pack = stage.sigma === null ? [start] : surrounded(space, start, stage.sigma, random, how.pack);
      return new WolfWhale(how, space.bounds, budget, random, how.pack, pack, this.math);
    });
    while (!packs.every(({ done }) => done)) {
      for (const group of stage.groups) {
        if (group.every((joint) => packs[joint]!.done)) continue;
        const asked = packs.map((pack, joint) => (group.includes(joint) && !pack.done ? pack.ask() : []));
        const counts = asked.map(({ length }) => length);
        const rows = Array.from({ length: Math.max(...counts) }, (_, n) => this.best.map((best, joint) => {
          const point = asked[joint]![n];
          return point ? space.row(point, this.before[joint]!) : best;
        }));
        yield this.take(rows, counts, packs);
      }
    }
  }

  /** Takes in candidates; of joint j the first counts[j] are new. */
  private take(rows: readonly Controllers[], counts: readonly number[], packs: readonly WolfWhale[] = []): Found {
    const costs = this.costs(rows, this.refines);
    this.evaluations += rows.length;
    for (const joint of ALL) {
      const own = costs.slice(0, counts[joint]).map((row) => row[joint]!);
      own.forEach((cost, n) => {
        if (!(cost < this.cost[joint]!)) return;
        this.cost[joint] = cost;
        this.best[joint] = rows[n]![joint]!;
      });
      if (own.length) packs[joint]?.tell(own);
    }
    this.curve.push([this.evaluations, [...this.cost]]);
    return this;
  }
}

/** A first pack: the start, and others around it within the box. */
function surrounded(space: Space, start: number[], sigma: number, random: Random, pack: number): number[][] {
  const others = latinHypercube(random, pack - 1, space.bounds.length).map((place) => place.map((value, d) => {
    const [low, high] = space.bounds[d]!;
    return clip(start[d]! + sigma * Math.sqrt(3) * (2 * value - 1) * (high - low), low, high);
  }));
  return [start, ...others];
}
