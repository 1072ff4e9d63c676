// What candidates cost, and who falls short of what held before: host/native/web/score.cpp works it out.

import type { Controllers, Rests, TunerData } from "./data";
import { inRows, JOINTS, type TunerModule } from "./module";

export class Judge {
  private readonly searching: number;
  private readonly refining: number;
  private readonly judging: number;

  /** Judges by what the controllers from before do, and is the module's only judge from now on. */
  constructor(private readonly module: TunerModule, private readonly data: TunerData, before: Controllers) {
    const { limits, drills, rests } = data;
    if (module.tell("limit", limits) !== limits.length) throw new Error("The tuner and its data are of two versions; load the page again.");
    for (const drill of drills) {
      const { importance, total_weight, first_block, floor } = drill;
      module.tell("drill", [importance, total_weight, first_block, ...floor], module.addDrill(drill, drill.searching));
    }
    [this.searching, this.refining, this.judging] = [rests.searching, rests.refining, rests.judging].map((one) => this.stops(one)) as
      [number, number, number];
    module.tell("begin", before.flat(), this.judging);
  }

  private stops(rests: Rests): number {
    const { module, data: { plant } } = this;
    const [prompt, late] = [module.addRests(rests, rests.variants), module.addRests(rests, [plant], true)] as const;
    return module.tell("stops", [rests.band, rests.turns, ...rests.ticks.flat()], prompt, late);
  }

  /** Of each candidate and joint; `refine`: in longer rests, since an integral swings slowly. */
  costs(candidates: readonly Controllers[], refine: boolean): number[][] {
    this.module.tell("costs", candidates.flat(2), refine ? this.refining : this.searching);
    return inRows(this.module.found(candidates.length * JOINTS));
  }

  /** The joints that fall short. */
  short(controllers: Controllers): number[] {
    this.module.tell("short", controllers.flat(), this.judging);
    return [...this.module.found(JOINTS)].flatMap((mark, joint) => (mark ? [joint] : []));
  }
}
