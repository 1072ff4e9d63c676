// The closed loop of many candidates as WebAssembly (host/native/web/exports.cpp), on the arm of the data.

import { startCode, type Exports } from "../parts/web_assembly";
import type { Controllers, Drill, Noise, PredictionData, Rests, Steps, TunerData } from "./data";
import type { Elementary } from "./wolf_whale";

export const JOINTS = 4;
export const ALL = [0, 1, 2, 3]; // of them
const TICK_S = 1e-3;
const SLICES = 4; // of a tick

/** Every joint's angles (rad) at every so many ticks. */
export type Trace = { readonly leader: readonly number[][]; readonly follower: readonly number[][] };

/** A board and the potentiometers around it, as the module takes them. */
type Bench = Pick<TunerData, "settings" | "leader_pots" | "follower_pots"> & { readonly timing: readonly number[]; readonly wait_s: number };

/** An arm whose potentiometers have no noise. */
export type Quiet = Pick<PredictionData, "plant" | "leader_pots" | "follower_pots">;

export class TunerModule implements Elementary {
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

  /** Gives numbers, and calls what takes them. */
  tell(name: string, numbers: readonly number[], ...given: number[]): number {
    const at = this.call("give", numbers.length);
    new Float64Array(this.exports.memory.buffer, at, numbers.length).set(numbers); // its memory may have grown
    return this.call(name, ...given);
  }

  /** As many of the numbers that the last call has found. */
  found(count: number): Float64Array {
    return new Float64Array(this.exports.memory.buffer, this.call("found"), count);
  }

  /** An experiment with the arm, on the motion of a drill. */
  addDrill(drill: Drill, noise: Noise): number {
    return this.add(this.bench(false), drill.steps, noise, [this.data.plant], (ticks) => this.weights(drill, ticks));
  }

  /** One with variants of the arm, on moves and rests; `late`: every duty acts a period later. */
  addRests({ steps, noise }: Rests, plants: readonly (readonly number[])[], late = false): number {
    return this.add(this.bench(late), steps, noise, plants, unweighted);
  }

  /** The row by which an arm is simulated, of the numbers that describe it. */
  plantOf(arm: readonly number[]): number[] {
    this.tell("plant", arm);
    return [...this.found(this.data.plant.length)];
  }

  /** An experiment with an arm without noise, on a board with settings of its own. */
  addMotion(steps: Steps, settings: readonly number[], { plant, leader_pots, follower_pots }: Quiet): number {
    const { wait_s, noise } = this.data.predicted;
    return this.add({ settings, timing: this.data.timing[0], leader_pots, follower_pots, wait_s }, steps, noise, [plant], unweighted);
  }

  private bench(late: boolean): Bench {
    const { settings, timing, leader_pots, follower_pots, motion: { wait_s } } = this.data;
    return { settings, timing: timing[late ? 1 : 0]!, leader_pots, follower_pots, wait_s };
  }

  private add(
    { settings, timing, leader_pots, follower_pots, wait_s }: Bench, steps: Steps, { seeds, gaps }: Noise,
    plants: readonly (readonly number[])[], weigh: (ticks: number) => number[],
  ): number {
    const { scale, apart } = this.data.motion;
    const joints = steps.map((one) => unpacked(one, scale));
    const wait = Math.round(wait_s / TICK_S);
    const ticks = wait + Math.ceil(((joints[0]!.length - 1) * apart) / SLICES);
    return this.tell("add", [
      ...settings, ...timing, ...leader_pots, seeds[0], ...follower_pots, seeds[1], ...gaps,
      wait * SLICES, apart, plants.length, ...plants.flat(), ticks, ...weigh(ticks),
      ...joints[0]!.flatMap((_, row) => joints.map((angles) => angles[row]!)),
    ]);
  }

  /** 0 while the leader waits; then the time since it moved last, and a little. */
  private weights({ moving }: Drill, ticks: number): number[] {
    const { wait_s, soon_s } = this.data.motion;
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
    this.tell("run", candidates.flat(2), experiment, Number(exact));
  }

  /** The mean square error (rad²) of each row of the last run, of each joint. */
  mse(experiment: number, rows: number): number[][] {
    this.call("mse", experiment);
    return inRows(this.found(rows * JOINTS));
  }

  trace(experiment: number, row: number, every: number): Trace {
    const count = this.call("trace", experiment, row, every);
    const all = inRows(this.found(2 * count));
    return { leader: all.slice(0, count / JOINTS), follower: all.slice(count / JOINTS) };
  }
}

function unweighted(ticks: number): number[] {
  return new Array<number>(ticks).fill(0);
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

/** Four numbers to a row. */
export function inRows(numbers: Float64Array): number[][] {
  return Array.from({ length: numbers.length / JOINTS }, (_, row) => [...numbers.subarray(row * JOINTS, (row + 1) * JOINTS)]);
}
