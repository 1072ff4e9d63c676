// A tuning from its start to what a person sees of it: search, the last look, and both controllers behind the same hand.

import type { Tuned } from "../session/services";
import type { Controllers, Found, Row, TunerData } from "./data";
import { Judge } from "./judge";
import type { TunerModule } from "./module";
import { Search } from "./search";
import { rint, Space } from "./space";

const SHOWN_TICKS = 10; // between two points of a picture

/** A joint that was not steady enough as it was found: it has less voltage or integral, or what it had before. */
type Calmed = { readonly joint: number; readonly as_before: boolean };

export class Tuning {
  private readonly judge: Judge;
  private readonly search: Search;

  constructor(private readonly module: TunerModule, private readonly data: TunerData, private readonly before: Controllers) {
    this.judge = new Judge(module, data, before);
    this.search = new Search(data.search, before, module, (rows, refine) => this.judge.costs(rows, refine));
  }

  /** Searches, a batch at each step. */
  run(): Generator<Found, void> {
    return this.search.run();
  }

  /** The best so far; a joint that falls short of what held before becomes calmer, and at last what it was. */
  result(): Tuned {
    const { search: { best }, before, data: { search: { calmer } } } = this;
    const after = [...best];
    const steps = best.map(() => 0);
    for (;;) {
      const changed = after.flatMap((row, joint) => (row === before[joint] ? [] : [joint]));
      const short = changed.length ? this.judge.short(after) : [];
      if (!short.length) break;
      const own = changed.filter((joint) => short.includes(joint));
      for (const joint of own.length ? own : changed) { // else it is a neighbour's doing
        const shares = calmer[steps[joint]!];
        steps[joint]! += 1;
        after[joint] = shares ? this.calmed(joint, shares) : before[joint]!;
      }
    }
    return this.shown(after, steps.flatMap((step, joint) => (step ? [{ joint, as_before: step > calmer.length }] : [])));
  }

  private calmed(joint: number, [ku, ki]: readonly [number, number]): Row {
    const { data: { search }, before, module } = this;
    const row = [...this.search.best[joint]!];
    row[search.ku] = rint(ku * row[search.ku]!);
    row[search.ki] = rint(ki * row[search.ki]!);
    const space = new Space(search, search.spaces.whole, false, module);
    return space.row(space.point(row), before[joint]!);
  }

  /** With noise that the search has not heard. */
  private shown(after: Controllers, calmed: readonly Calmed[]): Tuned {
    const drill = this.data.drills[this.data.shown]!;
    const experiment = this.module.addDrill(drill, drill.judging);
    this.module.run(experiment, [this.before, after]);
    const [first, second] = [0, 1].map((row) => this.module.trace(experiment, row, SHOWN_TICKS));
    return {
      before: this.before, after, notes: inWords(calmed),
      time_s: first!.leader.map((_, place) => (place * SHOWN_TICKS) / 1000),
      leader: first!.leader, followers: [first!.follower, second!.follower],
      mse: this.module.mse(experiment, 2),
    };
  }
}

function inWords(calmed: readonly Calmed[]): string[] {
  const named = (as_before: boolean): string =>
    calmed.filter((one) => one.as_before === as_before).map(({ joint }) => `joint ${joint}`).join(", ");
  const [kept, calmer] = [named(true), named(false)];
  return [
    ...(calmer ? [`Steadier than the search had it, with less voltage or integral: ${calmer}.`] : []),
    ...(kept ? [`As before, since what was found came to rest less well: ${kept}.`] : []),
  ];
}
