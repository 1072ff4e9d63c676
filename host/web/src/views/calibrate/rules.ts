// The rules of a calibration, which the terminal asks too, as WebAssembly: host/native/calibrate. Numbers go in, numbers and
// words come out; rules.h says which.

import { LinkError, type Parameter } from "../../link/declared";
import { upperFirst } from "../../link/refusal";
import { TABLE } from "../../link/schema";
import { startCode, type Exports } from "../../parts/web_assembly";
import { COUNT14_PER_COUNT, POTS, potParameter, potsOf } from "../../session/pots";

const STEPS_PER_RAD = 1024; // of a led point on the link

/** A potentiometer in a sweep: 1 where its reading grows towards the positive end, and its ends in counts. */
export type Sweep = { readonly direction: number; readonly low: number; readonly high: number };
/** Both arms held still: angles of four joints in rad, the same for both, and the counts of eight potentiometers. */
export type Pose = { readonly angles: readonly number[]; readonly counts: readonly number[] };
/** By potentiometer zero in counts and scale in rad a count, by joint the limits in rad; only of joints in use. */
export type Calibration = { readonly zero: readonly number[]; readonly scale: readonly number[]; readonly limits: readonly (readonly number[])[] };
/** A motor that turned: `sign` 1 as its parameter says, -1 the other way; `way` (rad) is half of what lies between pulses both ways. */
export type Motor = { readonly joint: number; readonly sign: number; readonly volts: number; readonly way: number };
/** The set with which a pulse runs and its limits: times, the step in the board's units, and what counts as rest in rad. */
export type PulseLimits = {
  readonly set: number[]; readonly leaseMs: number; readonly settleMs: number; readonly stillMs: number; readonly patienceMs: number;
  readonly step: number; readonly still: number;
};
/** Gives the motor one pulse, `way` 1 or -1; how far each joint went, in rad. */
export type Pulse = (volts: number, way: number) => Promise<readonly number[]>;

export class Rules {
  constructor(private readonly exports: Exports) {
    exports["_initialize"]!();
  }

  static async load(code: BufferSource): Promise<Rules> {
    return new Rules(await startCode(code, "the calibration"));
  }

  /** The answer of a rule; words are a mistake, or what a person is told. */
  ask(rule: string, ...given: readonly (number | readonly number[])[]): { readonly numbers: readonly number[]; readonly words: string } {
    const { memory } = this.exports;
    const call = (name: string, ...values: number[]): number => this.exports[name]!(...values);
    const flat = given.flat();
    const at = call("give", flat.length);
    new Float64Array(memory.buffer, at, flat.length).set(flat); // its memory may have grown
    call(rule);
    return {
      numbers: [...new Float64Array(memory.buffer, call("numbers"), call("numbers_count"))],
      words: new TextDecoder().decode(new Uint8Array(memory.buffer, call("words"), call("words_length"))),
    };
  }

  /** The numbers of a rule; its words are a mistake. */
  private checked(rule: string, ...given: readonly (number | readonly number[])[]): readonly number[] {
    const { numbers, words } = this.ask(rule, ...given);
    if (words) throw new LinkError(upperFirst(words).replaceAll("\n", " "));
    return numbers;
  }

  /** The converter's readings, rows of eight, from rows of a sample's angles and the set that runs. */
  counts(angles: readonly number[], raw: readonly number[]): readonly number[] {
    const all = (key: "zero" | "scale"): number[] => POTS.map((pot) => raw[potParameter(pot, key).index]!);
    return this.checked("counts", all("scale"), all("zero"), angles);
  }

  /** The outcome of a sweep of `pot`, and its mistake: a sentence with its remedy, empty where there is none. */
  sweep(counts: readonly number[], pot: number): Sweep & { readonly mistake: string } {
    const { numbers: [direction, low, high], words: mistake } = this.ask("sweep", pot, counts);
    return { direction: direction!, low: low!, high: high!, mistake };
  }

  /** The means of counts of arms that were held still; fails where they were not. */
  held(counts: readonly number[]): readonly number[] {
    return this.checked("held", counts);
  }

  /** The calibration from a sweep of each potentiometer and two known poses; fails where they contradict each other. */
  solve(sweeps: readonly (Sweep | null)[], first: Pose, second: Pose, joints: readonly number[]): Calibration {
    return calibration(this.checked("solve", ...shown(sweeps, joints), first.angles, first.counts, second.angles, second.counts));
  }

  /** The same from one known pose and one in which both arms agree, for tracks of this length in rad. */
  match(sweeps: readonly (Sweep | null)[], first: Pose, same: Pose, track: number, joints: readonly number[]): Calibration {
    const known = shown(sweeps, joints);
    const { zero, scale } = calibration(this.checked("solve", ...known, first.angles, first.counts, track));
    return calibration(this.checked("match", ...known, zero, scale, first.angles, first.counts, same.counts));
  }

  /** Fails where a potentiometer reads otherwise in the same pose. */
  requireNoSlip(before: Pose, after: Pose): void {
    this.checked("slipped", before.counts, after.counts);
  }

  /** The distance of the arms at each joint, in rad, in a pose from which nothing was worked out; fails where that is too far. */
  apartIn({ zero, scale }: Calibration, { counts }: Pose, joints: readonly number[]): readonly number[] {
    return this.checked("apart", inUse(joints), zero, scale, counts);
  }

  /** Raw values by parameter name. */
  changesOf({ zero, scale, limits }: Calibration, joints: readonly number[]): Map<string, number> {
    const values = new Map<string, number>();
    const set = ({ name, minimum, maximum, lsb }: Parameter, value: number, keptWithin: boolean): void => {
      const { numbers: [raw], words } = this.ask("raw", value, minimum, maximum, lsb, Number(keptWithin));
      if (words) throw new LinkError(`${name} ${words}`);
      values.set(name, raw!);
    };
    for (const pot of potsOf(joints)) {
      set(potParameter(pot, "zero"), COUNT14_PER_COUNT * zero[pot]!, false);
      set(potParameter(pot, "scale"), scale[pot]! / COUNT14_PER_COUNT, false);
    }
    for (const joint of joints) {
      ["limit_min", "limit_max"].forEach((key, end) => set(TABLE.named(`joint${joint}.${key}`), limits[joint]![end]!, true));
    }
    return values;
  }

  /** Tries a motor with ever more voltage; fails where no joint moves, or another one. */
  async motor(pulse: Pulse, supply: number, joint: number): Promise<Motor> {
    const moved: number[] = [];
    for (;;) {
      const [one, other, way] = this.checked("motor", joint, supply, moved);
      if (way !== undefined) return { joint, sign: one!, volts: other!, way };
      moved.push(...await pulse(one!, other!));
    }
  }

  /** A pulse of so many volts, its set made from that of a calibrated board. */
  pulse(calibrated: readonly number[], joint: number, volts: number): PulseLimits {
    const { numbers: [leaseMs, settleMs, stillMs, patienceMs, step, still], words } = this.ask("pulse", joint, volts);
    const set = [...calibrated];
    for (const [name, value] of words.split("\n").map((line) => line.split(" "))) {
      const { index, lsb } = TABLE.named(name!);
      set[index] = Math.floor(Number(value) / lsb + 0.5);
    }
    return { set, leaseMs: leaseMs!, settleMs: settleMs!, stillMs: stillMs!, patienceMs: patienceMs!, step: Math.round(step! * STEPS_PER_RAD), still: still! };
  }

  /** Sentences about motors that moved their joints, but with more voltage than one expects. */
  remarks(motors: readonly Motor[], supply: number): string {
    return this.ask("remarks", supply, motors.flatMap(({ joint, volts, way }) => [joint, volts, way])).words.replaceAll("\n", " ");
  }

  /** Asks a person to turn a joint to both ends. */
  turnAsked(joint: number): string {
    return this.ask("turn_asked", joint).words;
  }

  /** Asks a person to make ready for pulses of the motors. */
  readyAsked(): string {
    return this.ask("ready_asked").words;
  }
}

/** What people have shown of the joints that are in use. */
function shown(sweeps: readonly (Sweep | null)[], joints: readonly number[]): number[][] {
  const each = (key: keyof Sweep): number[] => sweeps.map((sweep) => sweep?.[key] ?? 0);
  return [inUse(joints), each("direction"), each("low"), each("high")];
}

function calibration(found: readonly number[]): Calibration {
  const pots = POTS.length;
  const limits = [0, 1, 2, 3].map((joint) => found.slice(2 * (pots + joint), 2 * (pots + joint + 1)));
  return { zero: found.slice(0, pots), scale: found.slice(pots, 2 * pots), limits };
}

function inUse(joints: readonly number[]): number[] {
  return [0, 1, 2, 3].map((joint) => Number(joints.includes(joint)));
}
