// The closed loop of many candidates as WebAssembly (host/native/web/exports.cpp), on the arm of the data.

import { startCode, type Exports } from "../parts/web_assembly";
import type { Controllers, Drill, Noise, Rests, Steps, TunerData } from "./data";
import type { Elementary } from "./wolf_whale";

const JOINTS = 4;
export const ALL = [0, 1, 2, 3]; // of them
export const TICK_S = 1e-3;
const SLICES = 4; // of a tick

/** Of a candidate on a plant, of each joint. */
export type Following = {
  readonly mse: number; readonly itae: number; readonly itau: number; readonly rattle: number; readonly swings: number;
  readonly lost: boolean;
};
export type Resting = {
  readonly turns: number; readonly travel: number; readonly swings: number; readonly ripple: number; readonly lost: boolean;
};

/** Every joint's angles (rad) at every so many ticks. */
export type Trace = { readonly leader: readonly number[][]; readonly follower: readonly number[][] };

export class TunerModule implements Elementary {
  private readonly lengths: number[] = [];

  constructor(private readonly exports: Exports, private readonly data: TunerData) {
    this.call("_initialize");
  }

  static async load(code: BufferSource, data: TunerData): Promise<TunerModule> {
    return new TunerModule(await startCode(code, "the search"), data);
  }

  private call(name: string, ...given: number[]): number {
    return this.exports[name]!(...given);
  }

  readonly exp = (x: number): number => this.call("exponential", x);
  readonly log = (x: number): number => this.call("logarithm", x);
  readonly cos = (x: number): number => this.call("cosine", x);

  private give(numbers: readonly number[]): void {
    const at = this.call("give", numbers.length);
    new Float64Array(this.exports.memory.buffer, at, numbers.length).set(numbers); // its memory may have grown
  }

  private found(count: number): Float64Array {
    return new Float64Array(this.exports.memory.buffer, this.call("found"), count);
  }

  /** An experiment with the arm, on the motion of a drill. */
  addDrill(drill: Drill, noise: Noise): number {
    return this.add(drill.steps, noise, false, [this.data.plant], (ticks) => this.weights(drill, ticks));
  }

  /** One with variants of the arm, on moves and rests; `late`: every duty acts a period later. */
  addRests({ steps, noise }: Rests, plants: readonly (readonly number[])[], late = false): number {
    return this.add(steps, noise, late, plants, (ticks) => new Array<number>(ticks).fill(0));
  }

  private add(
    steps: Steps, { seeds, gaps }: Noise, late: boolean, plants: readonly (readonly number[])[], weigh: (ticks: number) => number[],
  ): number {
    const { settings, timing, leader_pots, follower_pots, motion: { scale, apart, wait_s } } = this.data;
    const joints = steps.map((one) => unpacked(one, scale));
    const wait = Math.round(wait_s / TICK_S);
    const ticks = wait + Math.ceil(((joints[0]!.length - 1) * apart) / SLICES);
    this.give([
      ...settings, ...timing[late ? 1 : 0]!, ...leader_pots, seeds[0], ...follower_pots, seeds[1], ...gaps,
      wait * SLICES, apart, plants.length, ...plants.flat(), ticks, ...weigh(ticks),
      ...joints[0]!.flatMap((_, row) => joints.map((angles) => angles[row]!)),
    ]);
    this.lengths.push(ticks);
    return this.call("add");
  }

  ticks(experiment: number): number {
    return this.lengths[experiment]!;
  }

  /** 0 while the leader waits; then the time since it moved last, and a little. */
  private weights({ moving }: Drill, ticks: number): number[] {
    const { motion: { wait_s }, prices: { soon_s } } = this.data;
    let last = 0;
    let stretch = 0;
    return Array.from({ length: ticks }, (_, tick) => {
      const time = tick * TICK_S - wait_s;
      if (!moving) return tick * TICK_S < wait_s ? 0 : 1;
      if (tick >= (moving[stretch]?.[1] ?? Infinity)) stretch++;
      if (tick >= (moving[stretch]?.[0] ?? Infinity)) last = Math.max(last, time);
      return time < 0 ? 0 : soon_s + time - last;
    });
  }

  /** Simulates candidates; what they did is asked for afterwards. */
  run(experiment: number, candidates: readonly Controllers[], exact = false): void {
    this.give(candidates.flat(2));
    this.call("run", experiment, Number(exact));
  }

  /** Of each row of the last run, of each joint. */
  following(experiment: number, rows: number): Following[][] {
    const { sections, blocks, swing } = this.data.rattle;
    this.give([...sections, ...blocks, swing]);
    this.call("following", experiment);
    return grouped(this.found(rows * JOINTS * 6), 6, ([mse, itae, itau, rattle, swings, lost]) =>
      ({ mse: mse!, itae: itae!, itau: itau!, rattle: rattle!, swings: swings!, lost: lost !== 0 }));
  }

  /** The unrest of each candidate between two ticks. */
  resting(experiment: number, rows: number, [first, last]: readonly [number, number], band: number): Resting[][] {
    const { swing, window } = this.data.rattle;
    this.call("resting", experiment, first, last, band, swing, window);
    return grouped(this.found(rows * JOINTS * 5), 5, ([turns, travel, swings, ripple, lost]) =>
      ({ turns: turns!, travel: travel!, swings: swings!, ripple: ripple!, lost: lost !== 0 }));
  }

  trace(experiment: number, row: number, every: number): Trace {
    const count = this.call("trace", experiment, row, every);
    const all = grouped(this.found(2 * count), 1, ([angle]) => angle!);
    return { leader: all.slice(0, count / JOINTS), follower: all.slice(count / JOINTS) };
  }
}

function unpacked(steps: readonly number[], scale: number): number[] {
  const angles: number[] = [];
  let place = 0;
  for (let at = 0; at < steps.length; at++) {
    place += steps[at]!;
    for (let count = steps[at] === 0 ? steps[++at]! : 1; count; count--) angles.push(place / scale);
  }
  return angles;
}

/** Numbers in groups of `size`, four groups to a row. */
function grouped<T>(numbers: Float64Array, size: number, made: (numbers: Float64Array) => T): T[][] {
  return Array.from({ length: numbers.length / size / JOINTS }, (_, row) => Array.from({ length: JOINTS }, (_, joint) =>
    made(numbers.subarray((row * JOINTS + joint) * size, (row * JOINTS + joint + 1) * size))));
}
