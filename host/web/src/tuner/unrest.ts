// Judges if a joint comes to rest, and still would on a slightly different arm (greywhale/tune/judge/margins.py).

import type { Controllers, Rests, TunerData } from "./data";
import { TICK_S, type TunerModule } from "./module";

export const TEETH = "softer gear teeth";
const DELAY = "one period more delay";

export type Unrest = {
  readonly fails: boolean; readonly travel: number; readonly chatter: number; readonly ripple: number; readonly lost: boolean;
};

/** Of each scenario, the first being at rest, of each candidate and joint: the worst of the rests. */
export type Scenarios = readonly (readonly [scenario: string, found: readonly (readonly Unrest[])[]])[];

export class Unrests {
  private readonly prompt: number;
  private readonly late: number;
  private readonly variants: readonly string[];

  constructor(private readonly module: TunerModule, private readonly data: TunerData, private readonly rests: Rests) {
    this.variants = Object.keys(rests.variants);
    this.prompt = module.addRests(rests, Object.values(rests.variants));
    this.late = module.addRests(rests, [data.plant], true);
  }

  of(candidates: readonly Controllers[], exact = false): Scenarios {
    const { variants, module, prompt, late } = this;
    module.run(prompt, candidates, exact);
    const all = this.worst(prompt, candidates.length * variants.length);
    module.run(late, candidates, exact);
    return [
      ...variants.map((name, place) => [name, candidates.map((_, n) => all[n * variants.length + place]!)] as const),
      [DELAY, this.worst(late, candidates.length)] as const,
    ];
  }

  private worst(experiment: number, rows: number): Unrest[][] {
    const { data: { prices, supply_v, pwm_top }, rests } = this;
    const { ticks } = rests;
    const found = ticks.map((one) => this.module.resting(experiment, rows, one, rests.band));
    return found[0]!.map((row, n) => row.map(({ lost }, joint) => {
      const each = ticks.map(([from, to], rest) => {
        const { turns, travel, swings, ripple } = found[rest]![n]![joint]!;
        const seconds = (to - from) * TICK_S;
        return {
          turns, chatter: swings / seconds, travel: turns >= rests.turns ? travel / seconds : 0,
          ripple: supply_v * (Math.sqrt(ripple) / pwm_top[joint]!),
        };
      });
      const most = (name: "turns" | "chatter" | "travel" | "ripple"): number => Math.max(...each.map((one) => one[name]));
      const chatter = most("chatter");
      const fails = most("turns") >= rests.turns || chatter > prices.chatter_at_rest_hz || lost;
      return { fails, travel: most("travel"), chatter, ripple: most("ripple"), lost };
    }));
  }
}

/** The scenarios that must hold as before: every one but the softer teeth, and quiet at rest (tune/judge/standard.py). */
export class Standard {
  private readonly judge: Unrests;
  private readonly held: Scenarios;
  /** The ripple that each joint may have at rest, V. */
  readonly quietV: readonly number[];

  constructor(module: TunerModule, private readonly data: TunerData, private readonly before: Controllers) {
    this.judge = new Unrests(module, data, data.rests.judging);
    this.held = this.judge.of([before], true);
    this.quietV = this.held[0]![1][0]!.map(({ ripple }) => Math.max(ripple, data.prices.quiet_share * data.supply_v));
  }

  /** The joints that fall short of it. */
  short(controllers: Controllers): number[] {
    const now = this.judge.of([controllers], true);
    const { before, data: { prices } } = this;
    return this.quietV.flatMap((quiet, joint) => {
      const kept = controllers[joint]!.every((value, column) => value === before[joint]![column]);
      const loud = now[0]![1][0]![joint]!.ripple > (kept ? prices.shaken : prices.same) * quiet;
      const fails = now.some(([name, found], place) =>
        name !== TEETH && found[0]![joint]!.fails && !this.held[place]![1][0]![joint]!.fails);
      return loud || fails ? [joint] : [];
    });
  }
}
