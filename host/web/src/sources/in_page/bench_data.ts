// What the bench inside the page is made of, as tools/site writes it: the arm, its mistakes, a person's motion.

import type { ArmDescription, BenchControls, Range } from "../../host";

/** A call of the module: its export's name, and numbers. */
export type Call = readonly [name: string, ...given: number[]];

export type BenchData = {
  readonly arm: readonly number[]; // as the module takes it
  readonly description: ArmDescription;
  readonly leader: BenchControls["leader"];
  readonly supply: Range;
  readonly load: Range;
  readonly noise: Range; // times the arm's own
  readonly play: Range;
  readonly faults: readonly {
    readonly name: string;
    readonly description: string;
    readonly places: Readonly<Record<string, readonly Call[]>>; // "" for a fault without a place
  }[];
  /** Poses of the leader in rad, so many a second. */
  readonly reaches: { readonly hz: number; readonly rows: readonly (readonly number[])[] };
};
