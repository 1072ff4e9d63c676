// From sweeps and held poses to zero, scale and limits as the board stores them: greywhale/board/calibrate/solve.py, with a
// second pose of known angles.

import { fixed, short } from "../../files/words";
import { LinkError, type Parameter } from "../../link/declared";
import { potName, upperFirst } from "../../link/refusal";
import { TABLE } from "../../link/schema";
import { JOINTS } from "../../session/samples";
import { FULL_SCALE, type Sweep } from "./sweep";

const COUNT14_PER_COUNT = 16; // in a count of the converter
const ANGLE_SHIFT = 13; // angle = ((count14 - zero) * scale) >> 13
const SHORTEST_TRACK_RAD = Math.PI;
const LONGEST_TRACK_RAD = 2.5 * Math.PI; // the board takes no longer one
const LEAST_TURN_RAD = 0.3; // rad between two poses: with less, a degree in a hand is much of the scale
const SLIPPED_COUNTS = 8; // the same pose twice: 40 mrad of a usual track
const MOST_APART_RAD = 0.15; // between the arms in the last pose: 9 degrees, more than a hand is wrong by
const MARGIN_RAD = 0.03; // kept from both ends of what the person showed

/** Both arms held still: angles of four joints in rad, the same for both, and the counts of eight potentiometers. */
export type Pose = { readonly angles: readonly number[]; readonly counts: readonly number[] };
/** By potentiometer zero in counts and scale in rad a count, by joint the limits in rad; only of joints in use. */
export type Calibration = { readonly zero: number[]; readonly scale: number[]; readonly limits: (readonly [number, number])[] };

/** A potentiometer's parameters by its number: leader 0..3, follower 4..7. */
function of(pot: number, key: string): Parameter {
  return TABLE.named(`${pot < JOINTS ? "leader" : "follower"}${pot % JOINTS}.${key}`);
}

/** The joints that a set has in use. */
export function jointsInUse(raw: readonly number[]): number[] {
  return [0, 1, 2, 3].filter((joint) => raw[of(JOINTS + joint, "scale").index] !== 0 && raw[of(joint, "scale").index] !== 0);
}

/** The potentiometers of these joints, arm by arm. */
export function potsOf(joints: readonly number[]): number[] {
  return [...joints, ...joints.map((joint) => JOINTS + joint)];
}

/** The converter's reading, from the angle of a sample in its counts and the set that runs; the middle where there is no potentiometer. */
export function countsOf(angle: number, pot: number, raw: readonly number[]): number {
  const scale = raw[of(pot, "scale").index]!;
  return scale ? ((angle * 2 ** ANGLE_SHIFT) / scale + raw[of(pot, "zero").index]!) / COUNT14_PER_COUNT : FULL_SCALE / 2;
}

/** The calibration from a sweep of each potentiometer and two known poses; fails where they contradict each other. */
export function solve(sweeps: readonly (Sweep | null)[], first: Pose, second: Pose, joints: readonly number[]): Calibration {
  const found: Calibration = { zero: [], scale: [], limits: [] };
  for (const pot of potsOf(joints)) {
    const scale = found.scale[pot] = scaleOf(first, second, pot, sweeps[pot]!.direction);
    found.zero[pot] = first.counts[pot]! - first.angles[pot % JOINTS]! / scale;
  }
  for (const joint of joints) found.limits[joint] = limitsOf(found, sweeps, joint);
  return found;
}

function scaleOf(first: Pose, second: Pose, pot: number, direction: number): number {
  const joint = pot % JOINTS;
  const turned = second.angles[joint]! - first.angles[joint]!;
  const moved = second.counts[pot]! - first.counts[pot]!;
  if (Math.abs(turned) < LEAST_TURN_RAD) {
    throw new LinkError(`The two poses differ by ${Number(turned.toPrecision(2))} rad at joint ${joint}; choose a second pose that differs by ${LEAST_TURN_RAD} rad or more at every joint.`);
  }
  const track = moved ? Math.abs(turned / moved) * FULL_SCALE : Infinity;
  if (!(track >= SHORTEST_TRACK_RAD && track <= LONGEST_TRACK_RAD)) {
    throw new LinkError(`${upperFirst(potName(pot))} read ${fixed(first.counts[pot]!, 0)} and ${fixed(second.counts[pot]!, 0)} in the two poses: `
      + `as if its track had ${Number.isFinite(track) ? fixed((track * 180) / Math.PI, 0) : "inf"} degrees; hold the poses again, and check that its shaft does not slip.`);
  }
  if (Math.sign(turned / moved) !== direction) {
    throw new LinkError(`${upperFirst(potName(pot))} turned the other way between the poses than in its sweep; in the sweep, turn towards the positive end first.`);
  }
  return turned / moved;
}

/** The range that both arms can reach, without a margin. */
function limitsOf({ zero, scale }: Calibration, sweeps: readonly (Sweep | null)[], joint: number): readonly [number, number] {
  const [leader, follower] = [joint, JOINTS + joint].map((pot) => {
    const { low, high } = sweeps[pot]!;
    return [low, high].map((count) => (count - zero[pot]!) * scale[pot]!).sort((a, b) => a - b) as [number, number];
  }) as [[number, number], [number, number]];
  const low = Math.max(leader[0], follower[0]) + MARGIN_RAD;
  const high = Math.min(leader[1], follower[1]) - MARGIN_RAD;
  if (low < high) return [low, high];
  throw new LinkError(`Joint ${joint} has no range that both arms can reach: the leader goes from ${fixed(leader[0], 2)} to `
    + `${fixed(leader[1], 2)} rad, the follower from ${fixed(follower[0], 2)} to ${fixed(follower[1], 2)}; `
    + "hold both arms in the same pose, and sweep to both ends.");
}

/** Fails where a potentiometer reads otherwise in the same pose. */
export function requireNoSlip(before: Pose, after: Pose): void {
  const sentences = before.counts.flatMap((count, pot) => {
    const apart = Math.abs(after.counts[pot]! - count);
    return apart > SLIPPED_COUNTS ? `${upperFirst(potName(pot))} reads ${fixed(apart, 0)} counts elsewhere in the same pose: it slips on its shaft; tighten it, and begin anew.` : [];
  });
  if (sentences.length) throw new LinkError(sentences.join(" "));
}

/** The distance of the arms at each joint in use, in rad, in a pose from which nothing was worked out; fails where that is too far. */
export function apartIn({ zero, scale }: Calibration, { counts }: Pose, joints: readonly number[]): number[] {
  const [leader, follower] = [0, JOINTS].map((arm) => joints.map((joint) => (counts[arm + joint]! - zero[arm + joint]!) * scale[arm + joint]!));
  const apart = leader!.map((angle, place) => Math.abs(follower![place]! - angle));
  const most = Math.max(...apart);
  if (most <= MOST_APART_RAD) return apart;
  throw new LinkError(`Held in the same pose, leader and follower differ by ${fixed(most, 2)} rad at joint ${joints[apart.indexOf(most)]}; `
    + "hold the poses more exactly, check that no shaft slips, and begin anew.");
}

/** Raw values by parameter name. */
export function changesOf({ zero, scale, limits }: Calibration): Map<string, number> {
  const values = new Map<string, number>();
  const set = (parameter: Parameter, value: number): unknown => values.set(parameter.name, rawOf(parameter, value));
  scale.forEach((size, pot) => {
    set(of(pot, "zero"), COUNT14_PER_COUNT * zero[pot]!);
    set(of(pot, "scale"), size / COUNT14_PER_COUNT);
  });
  limits.forEach((ends, joint) => ["limit_min", "limit_max"].forEach((key, end) => {
    const parameter = TABLE.named(`joint${joint}.${key}`);
    const [low, high] = [parameter.minimum, parameter.maximum].map((raw) => raw * parameter.lsb);
    set(parameter, Math.max(low!, Math.min(high!, ends[end]!)));
  }));
  return values;
}

function rawOf({ name, lsb, minimum, maximum }: Parameter, value: number): number {
  const raw = Math.floor(value / lsb + 0.5);
  if (value >= minimum * lsb && value <= maximum * lsb) return raw;
  throw new LinkError(`${name} would be ${short(value)}, but it must lie within ${short(minimum * lsb)}..${short(maximum * lsb)}; begin anew.`);
}
