// Prices candidates as `greywhale tune` does: greywhale/tune/search/objective.py and judge/margins.py say why.

import type { Controllers, Drill, TunerData } from "./data";
import { ALL, TICK_S, type Following, type TunerModule } from "./module";
import { TEETH, Unrests, type Unrest } from "./unrest";

/** An error in rad, and what is measured beside it. */
type Errors = { readonly error: number; readonly volts: number; readonly rattle: number; readonly chatter: number };

export class Costs {
  private readonly drills: readonly number[];
  private readonly searching: Unrests;
  private readonly refining: Unrests;
  private readonly before: readonly Errors[][]; // drills x joints

  /** Judges by what the controllers from before do; `quietV` is the ripple that each joint may have at rest. */
  constructor(
    private readonly module: TunerModule, private readonly data: TunerData, before: Controllers,
    private readonly quietV: readonly number[],
  ) {
    this.drills = data.drills.map((drill) => module.addDrill(drill, drill.searching));
    this.searching = new Unrests(module, data, data.rests.searching);
    this.refining = new Unrests(module, data, data.rests.refining);
    this.before = this.follow([before]).map((drill) => drill[0]!);
  }

  /** Of each candidate and joint; `refine`: in longer rests, since an integral swings slowly. */
  of(candidates: readonly Controllers[], refine = false): number[][] {
    const following = this.follow(candidates);
    const unrest = (refine ? this.refining : this.searching).of(candidates);
    const importances = this.data.drills.reduce((sum, { importance }) => sum + importance, 0);
    return candidates.map((_, n) => ALL.map((joint) => {
      const total = this.data.drills.reduce((sum, drill, place) =>
        sum + drill.importance * this.relative(drill, this.before[place]![joint]!, following[place]![n]![joint]!, joint), 0);
      return total / importances + this.penalty(unrest.map(([name, found]) => [name, found[n]![joint]!]), this.quietV[joint]!);
    }));
  }

  /** Of each drill, candidate and joint. */
  private follow(candidates: readonly Controllers[]): Errors[][][] {
    return this.data.drills.map((drill, place) => {
      this.module.run(this.drills[place]!, candidates);
      return this.module.following(this.drills[place]!, candidates.length).map((row) =>
        row.map((one) => this.errors(drill, one, this.module.ticks(this.drills[place]!))));
    });
  }

  private errors({ total_weight }: Drill, { mse, itae, itau, rattle, swings, lost }: Following, ticks: number): Errors {
    const { rms, lost: far } = this.data.prices;
    return {
      error: lost ? far : itae / total_weight + rms * Math.sqrt(mse),
      volts: itau / total_weight,
      rattle: lost ? far : rattle,
      chatter: swings / (ticks * TICK_S),
    };
  }

  private relative({ floor, least_room }: Drill, before: Errors, found: Errors, joint: number): number {
    const { prices, supply_v } = this.data;
    const room = Math.max(before.error - floor[joint]!, least_room[joint]!);
    const louder = Math.max(found.rattle - Math.max(before.rattle, prices.quiet_rad), 0);
    const avoidable = Math.max(found.error - floor[joint]!, 0);
    const length = avoidable + prices.rattle * (found.rattle + prices.louder * louder);
    const unbearable = Math.max(found.chatter / prices.chatter_moving_hz - prices.bearable, 0);
    const shaking = Math.max(found.rattle / prices.rattle_moving_rad - prices.bearable, 0);
    const unrest = prices.chatter_moving * unbearable;
    return Math.sqrt(length / room + unrest + prices.shaking * shaking + (prices.effort * found.volts) / supply_v);
  }

  private penalty(scenarios: readonly (readonly [string, Unrest])[], quietV: number): number {
    const { prices } = this.data;
    const share = scenarios[0]![1].ripple / quietV;
    let total = prices.ripple * share + prices.loud * Math.max(share - prices.search_ripple, 0);
    for (const [name, { fails, travel, chatter, lost }] of scenarios) {
      const failing = (name === TEETH ? prices.teeth : prices.fail) * Number(fails);
      const excess = Math.max(chatter / prices.chatter_at_rest_hz - prices.search_chatter, 0);
      total += prices.travel * travel + prices.chatter_at_rest * excess + failing + prices.lost_at_rest * Number(lost);
    }
    return total;
  }
}
