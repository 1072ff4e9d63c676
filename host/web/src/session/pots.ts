// The eight potentiometers, leader 0..3 and follower 4..7, as the running set and a sample tell of them.

import type { Parameter } from "../link/declared";
import { TABLE } from "../link/schema";
import { COUNT, JOINTS, traceOf, type Samples } from "./samples";

export const POTS: readonly number[] = Array.from({ length: 2 * JOINTS }, (_, pot) => pot);
export const COUNT14_PER_COUNT = 16; // in a count of the converter

/** A potentiometer's parameter. */
export function potParameter(pot: number, key: "zero" | "scale"): Parameter {
  return TABLE.named(`${pot < JOINTS ? "leader" : "follower"}${pot % JOINTS}.${key}`);
}

const ZERO = POTS.map((pot) => potParameter(pot, "zero"));
const SCALE = POTS.map((pot) => potParameter(pot, "scale"));
const RAILS = TABLE.named("rail_counts").index;
/** The most that the converter reads. */
export const FULL_SCALE = ZERO[0]!.maximum / COUNT14_PER_COUNT;

/** The joints that a set has in use. */
export function jointsInUse(raw: readonly number[]): number[] {
  return [0, 1, 2, 3].filter((joint) => raw[SCALE[joint]!.index] !== 0 && raw[SCALE[JOINTS + joint]!.index] !== 0);
}

/** The potentiometers of these joints, arm by arm. */
export function potsOf(joints: readonly number[]): number[] {
  return [...joints, ...joints.map((joint) => JOINTS + joint)];
}

/** True where a set says more of a potentiometer than every board does when it is new. */
function isCalibrated(pot: number, raw: readonly number[]): boolean {
  return [ZERO[pot]!, SCALE[pot]!].some(({ index, initial }) => raw[index] !== initial);
}

/** What a potentiometer reads: counts of the converter, degrees where it is calibrated, and if that is at a rail. */
export type PotReading = { readonly counts: number; readonly degrees: number | null; readonly atRail: boolean };

/** The reading in a sample; null where the set says that there is none. A sample has angles, by the set that runs. */
export function potReading(samples: Samples, number: number, pot: number, raw: readonly number[]): PotReading | null {
  const [zero, scale] = [raw[ZERO[pot]!.index]!, raw[SCALE[pot]!.index]! * SCALE[pot]!.lsb];
  if (scale === 0) return null;
  const side = pot < JOINTS ? "leader" : "follower";
  const angle = samples.count(number, traceOf(side, pot % JOINTS)) * COUNT[side];
  const counts = Math.max(0, Math.min(FULL_SCALE, (angle / scale + zero) / COUNT14_PER_COUNT));
  const rail = raw[RAILS]!;
  return {
    counts, degrees: isCalibrated(pot, raw) ? (180 / Math.PI) * angle : null,
    atRail: rail > 0 && (counts <= rail || counts >= FULL_SCALE - rail),
  };
}
