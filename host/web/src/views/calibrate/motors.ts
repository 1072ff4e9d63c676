// Judges a motor by short weak pulses: which joint it moves, and which way: greywhale/board/calibrate/motors.py.

import { fixed } from "../../files/words";
import { LinkError } from "../../link/declared";

const PULSE_SHARES = [0.1, 0.17, 0.25, 0.35]; // of the supply, tried one after the other
const LEAST_WAY_RAD = 0.02; // half of what lies between a pulse one way and one the other: less is no motion
const WEAK_SHARE = 0.5; // of the others' way a volt: healthy unlike joints are above 0.6, weak ones below 0.45
const MUCH_SUPPLY_SHARE = 0.2; // if every motor needs so much of the supply, the supply is low
const OTHER_JOINT_RATIO = 2; // another joint that moves so many times farther has this motor

/** A motor that turned: `sign` 1 as its parameter says, -1 the other way; `way` (rad) is half of what lies between pulses both ways. */
export type Motor = { readonly joint: number; readonly sign: number; readonly volts: number; readonly way: number };
/** Gives the motor one pulse, `way` 1 or -1; how far each joint went, in rad. */
export type Pulse = (volts: number, way: number) => Promise<readonly number[]>;

/** Tries a motor with ever more voltage; fails where no joint moves, or another one. */
export async function examineMotor(pulse: Pulse, supply: number, joint: number): Promise<Motor> {
  for (const share of PULSE_SHARES) {
    const volts = share * supply;
    const ways = await answer(pulse, volts);
    const sizes = ways.map(Math.abs);
    const most = Math.max(...sizes);
    const own = sizes[joint]!;
    if (most < LEAST_WAY_RAD) continue;
    if (most > OTHER_JOINT_RATIO * own) {
      throw new LinkError(`The motor of joint ${joint} moved joint ${sizes.indexOf(most)}: their motors, or their followers' potentiometers, `
        + "are swapped; exchange the wires at the board, and begin anew.");
    }
    if (own >= LEAST_WAY_RAD) return { joint, sign: Math.sign(ways[joint]!), volts, way: own };
  }
  throw new LinkError(`The motor of joint ${joint} did not move it with ${fixed(PULSE_SHARES.at(-1)! * supply, 1)} V: check that the motors' supply is on, `
    + "the driver's enable, PWM and direction wires, the motor's own wires, and that the joint moves freely.");
}

/** Half of what lies between pulses one way and the other; 0 where two tries, in both orders, do not agree: an arm that falls does so once. */
async function answer(pulse: Pulse, volts: number): Promise<number[]> {
  const between = async (way: number): Promise<number[]> => {
    const [one, other] = [await pulse(volts, way), await pulse(volts, -way)];
    return one.map((size, at) => (size - other[at]!) / 2);
  };
  const once = await between(1);
  if (Math.max(...once.map(Math.abs)) < LEAST_WAY_RAD) return once;
  const again = (await between(-1)).map((size) => -size);
  return once.map((size, at) => (size * again[at]! > 0 ? Math.sign(size) * Math.min(Math.abs(size), Math.abs(again[at]!)) : 0));
}

/** Sentences about motors that moved their joints, but with more voltage than one expects. */
export function remarks(motors: readonly Motor[], supply: number): string[] {
  const least = Math.min(...motors.map(({ volts }) => volts));
  if (motors.length && least >= MUCH_SUPPLY_SHARE * supply) {
    return [`Every motor needed ${fixed(least, 1)} V or more to move its joint: check the motors' supply; the board counts on ${supply} V (supply_mv).`];
  }
  const answers = motors.map(({ way, volts }) => way / volts);
  return motors.flatMap(({ joint }, at) => {
    const usual = median(answers.filter((_, other) => other !== at));
    return answers[at]! < WEAK_SHARE * usual ? `The motor of joint ${joint} moved it by ${fixed(1000 * answers[at]!, 0)} mrad a volt, the others theirs `
      + `by ${fixed(1000 * usual, 0)}: it is weak, or its joint turns hard; check its wires, its driver's current `
      + "limit, and that the joint turns freely by hand." : [];
  });
}

function median(values: readonly number[]): number {
  const sorted = [...values].sort((a, b) => a - b);
  const middle = sorted.length >> 1;
  return !sorted.length ? 0 : sorted.length % 2 ? sorted[middle]! : (sorted[middle - 1]! + sorted[middle]!) / 2;
}
