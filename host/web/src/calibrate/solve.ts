// From a sweep and two known poses to zero, scale and limits as the board stores them: greywhale/board/calibrate/solve.py,
// without what a pulse of the motors and a sweep joint by joint tell there.

import { LinkError, type Parameter } from "../link/declared";
import { potName, upperFirst } from "../link/refusal";
import { TABLE } from "../link/schema";

export const JOINTS = 4;
export const FULL_SCALE = 1023;
const COUNT14 = 16; // in a count of the converter
const ANGLE_SHIFT = 13; // angle = ((count14 - zero) * scale) >> 13
const SHORTEST_TRACK = Math.PI;
const LONGEST_TRACK = 2.5 * Math.PI; // the board takes no longer one
const LEAST_TURN = 0.3; // rad between two poses: with less, a degree in a hand is much of the scale
const LEAST_COUNTS = 40; // of a sweep
const RAIL_COUNTS = 4;
const MARGIN_RAD = 0.03; // kept from both ends of what the person showed

/** Both arms held still: angles of four joints in rad, the same for both, and the counts of eight potentiometers. */
export type Pose = { readonly angles: readonly number[]; readonly counts: readonly number[] };
/** What a potentiometer read in the sweep, in counts. */
export type Ends = { readonly low: number; readonly high: number };

/** A potentiometer's parameters by its number: leader 0..3, follower 4..7. */
function of(pot: number, key: string): Parameter {
  return TABLE.named(`${pot < JOINTS ? "leader" : "follower"}${pot % JOINTS}.${key}`);
}

/** The joints that a set has in use. */
export function jointsInUse(raw: readonly number[]): number[] {
  return [0, 1, 2, 3].filter((joint) => raw[of(JOINTS + joint, "scale").index] !== 0 && raw[of(joint, "scale").index] !== 0);
}

/** What the converter reads, from the angle of a sample in its counts and the set that runs. */
export function countsOf(angle: number, pot: number, raw: readonly number[]): number {
  return ((angle * 2 ** ANGLE_SHIFT) / raw[of(pot, "scale").index]! + raw[of(pot, "zero").index]!) / COUNT14;
}

/** Raw values by parameter name; fails where sweep and poses contradict each other. */
export function solve(sweep: readonly Ends[], first: Pose, second: Pose, joints: readonly number[]): Map<string, number> {
  const pots = [...joints, ...joints.map((joint) => JOINTS + joint)];
  const values = new Map<string, number>();
  const ends: Ends[] = [];
  for (const pot of pots) {
    requireSweep(sweep[pot]!, pot);
    const scale = scaleOf(first, second, pot);
    const zero = first.counts[pot]! - first.angles[pot % JOINTS]! / scale;
    const [one, other] = [sweep[pot]!.low, sweep[pot]!.high].map((count) => (count - zero) * scale) as [number, number];
    ends[pot] = { low: Math.min(one, other), high: Math.max(one, other) };
    for (const [key, value] of [["zero", COUNT14 * zero], ["scale", scale / COUNT14]] as const) {
      const parameter = of(pot, key);
      values.set(parameter.name, rawOf(parameter, value));
    }
  }
  for (const joint of joints) setLimits(values, joint, ends[joint]!, ends[JOINTS + joint]!);
  return values;
}

function requireSweep({ low, high }: Ends, pot: number): void {
  const name = upperFirst(potName(pot));
  if (!(high - low >= LEAST_COUNTS)) throw new LinkError(`${name} was hardly turned in the sweep; turn every joint of both arms from end to end.`);
  if (low <= RAIL_COUNTS || high >= FULL_SCALE - RAIL_COUNTS) {
    throw new LinkError(`${name} reads ${low.toFixed(0)}..${high.toFixed(0)} of ${FULL_SCALE}, at a rail: check its three wires, and that its track does not end within the joint's way.`);
  }
}

function scaleOf(first: Pose, second: Pose, pot: number): number {
  const joint = pot % JOINTS;
  const turned = second.angles[joint]! - first.angles[joint]!;
  const moved = second.counts[pot]! - first.counts[pot]!;
  if (Math.abs(turned) < LEAST_TURN) {
    throw new LinkError(`The two poses differ by ${Number(turned.toPrecision(2))} rad at joint ${joint}; choose a second pose that differs by ${LEAST_TURN} rad or more at every joint.`);
  }
  const track = moved ? Math.abs(turned / moved) * FULL_SCALE : Infinity;
  if (!(track >= SHORTEST_TRACK && track <= LONGEST_TRACK)) {
    throw new LinkError(`${upperFirst(potName(pot))} read ${first.counts[pot]!.toFixed(0)} and ${second.counts[pot]!.toFixed(0)} in the two poses: `
      + `as if its track had ${((track * 180) / Math.PI).toFixed(0)} degrees; hold the poses again, and check that its shaft does not slip.`);
  }
  return turned / moved;
}

/** What both arms can reach, without a margin. */
function setLimits(values: Map<string, number>, joint: number, leader: Ends, follower: Ends): void {
  const low = Math.max(leader.low, follower.low) + MARGIN_RAD;
  const high = Math.min(leader.high, follower.high) - MARGIN_RAD;
  if (low >= high) {
    throw new LinkError(`Joint ${joint} has no range that both arms can reach: the leader goes from ${leader.low.toFixed(2)} to `
      + `${leader.high.toFixed(2)} rad, the follower from ${follower.low.toFixed(2)} to ${follower.high.toFixed(2)}; `
      + "hold both arms in the same pose, and sweep to both ends.");
  }
  for (const [key, value] of [["limit_min", low], ["limit_max", high]] as const) {
    const parameter = TABLE.named(`joint${joint}.${key}`);
    values.set(parameter.name, Math.max(parameter.minimum, Math.min(parameter.maximum, Math.floor(value / parameter.lsb + 0.5))));
  }
}

function rawOf({ name, lsb, minimum, maximum }: Parameter, value: number): number {
  const raw = Math.floor(value / lsb + 0.5);
  if (raw >= minimum && raw <= maximum) return raw;
  throw new LinkError(`${name} would be ${Number(value.toPrecision(6))}, but it must lie within ${minimum * lsb}..${Number((maximum * lsb).toPrecision(6))}; begin anew.`);
}
