// One joint of one arm turned by hand to both ends, the positive one first: what its potentiometer shows, and mistakes:
// greywhale/board/calibrate/sweep.py. Counts are those of the converter: a column a potentiometer, a row a millisecond.

import { fixed } from "../../files/words";
import { potName, upperFirst } from "../../link/refusal";

export const FULL_SCALE = 1023;
const HALF_SMOOTH = 4; // rows to both sides: a reading that differs from its neighbours for less time is a jump
const LEAST_COUNTS = 40; // 12 degrees of a usual track: less is no sweep
const OTHERS_SHARE = 0.5; // of the sweep: another reading that moves as far is moved as well
const RAIL_COUNTS = 4; // from the end of the converter's range
const CROSSED_FROM_COUNTS = 0.88 * FULL_SCALE; // a pull-down of some ten times the track
const CROSSED_SPAN_COUNTS = 0.12 * FULL_SCALE;
const DEAD_ZONE_COUNTS = 300; // a jump so far, from near one end to near the other, crosses the gap of the track
const DEAD_ZONE_ROWS = 8;
const JUMP_COUNTS = 15;
const MOST_JUMPS = 2;

/** A potentiometer in a sweep: 1 where its reading grows towards the positive end, and its ends in counts. */
export type Sweep = { readonly direction: number; readonly low: number; readonly high: number };
type Column = { readonly values: Float64Array; readonly low: number; readonly high: number };

/** The outcome of a sweep of `pot`, and its mistake: a sentence with its remedy, empty where there is none. */
export function judgeSweep(counts: readonly Float64Array[], pot: number): Sweep & { readonly mistake: string } {
  const columns = counts.map(smoothed);
  const own = columns[pot]!;
  const { values, low, high } = own;
  return { direction: values.indexOf(high) < values.indexOf(low) ? 1 : -1, low, high, mistake: wiring(columns, pot) ?? contact(counts[pot]!, own, pot) };
}

/** The median of each value and its neighbours; the ends count as often as is needed. */
function smoothed(raw: Float64Array): Column {
  const near = new Float64Array(2 * HALF_SMOOTH + 1);
  const values = raw.map((_, at) => {
    for (let i = 0; i < near.length; i++) near[i] = raw[Math.max(0, Math.min(raw.length - 1, at + i - HALF_SMOOTH))]!;
    return near.sort()[HALF_SMOOTH]!;
  });
  return { values, low: values.reduce((a, b) => Math.min(a, b), Infinity), high: values.reduce((a, b) => Math.max(a, b), -Infinity) };
}

const span = ({ low, high }: Column): number => high - low;
const named = (pot: number): string => upperFirst(potName(pot));
const whole = (count: number): string => String(Number(fixed(count, 0)));
const reading = ({ low, high }: Column): string => `${whole(low)} to ${whole(high)} of ${FULL_SCALE}`;

/** A sentence for the mistake if another potentiometer moved, or this one did not; null if it moved alone. */
function wiring(columns: readonly Column[], pot: number): string | null {
  const own = columns[pot]!;
  const others = [...columns.keys()].filter((other) => other !== pot && span(columns[other]!) >= LEAST_COUNTS);
  if (span(own) >= LEAST_COUNTS) {
    const also = others.filter((other) => span(columns[other]!) > OTHERS_SHARE * span(own));
    const across = also.find((other) => jumpsAcross(columns[other]!)); // it stands at an end of its track, and noise alone makes it jump
    if (across !== undefined) return deadZone(across);
    return also.length ? `${named(pot)} moved, and so did ${potName(also[0]!)}: turn one joint at a time, or if only one was turned, `
      + "look for a wire that touches both." : null;
  }
  if (!others.length && isCrossed(own)) return crossed(own, pot);
  if (others.length) {
    const moved = others.reduce((most, other) => (span(columns[other]!) > span(columns[most]!) ? other : most));
    return `${named(pot)} reads ${reading(own)} and did not move, but ${potName(moved)} did: `
      + `${moved % 4 === pot % 4 ? "the two arms are swapped" : "their wires are swapped"}, or the other joint was turned; `
      + "exchange the wires at the board's pins, or do it again.";
  }
  if (own.high <= RAIL_COUNTS || own.low >= FULL_SCALE - RAIL_COUNTS) {
    return `${named(pot)} reads ${reading(own)}, at a rail: check its wiper and its 5V wire (an open wire or a short to ground `
      + "reads 0), or its ground wire (1023).";
  }
  return `${named(pot)} reads ${reading(own)} and did not move: check that its shaft turns with the joint (a slipping coupling, a `
    + "loose screw) and that its wiper's wire is connected.";
}

/** A sentence for the mistake if the track ends or breaks where the joint goes, or its contact is bad; else empty. */
function contact(raw: Float64Array, own: Column, pot: number): string {
  if (isCrossed(own)) return crossed(own, pot);
  if (jumpsAcross(own)) return deadZone(pot);
  if (own.low <= RAIL_COUNTS || own.high >= FULL_SCALE - RAIL_COUNTS) {
    return `${named(pot)} reaches an end of its track (${reading(own)}) within the joint's range: turn its shaft in its coupling `
      + "so that mid-range reads about 512, and begin anew.";
  }
  const away = (at: number): boolean => Math.abs(raw[at]! - own.values[at]!) > JUMP_COUNTS;
  const jumps = raw.reduce((sum, _, at) => sum + Number(at > 0 && away(at) && !away(at - 1)), 0);
  return jumps > MOST_JUMPS ? `${named(pot)} jumped ${jumps} times while the joint was turned: a loose wire, or a worn track; check its three `
    + "wires, else replace it." : "";
}

function jumpsAcross({ values }: Column): boolean {
  return values.some((value, at) => at >= DEAD_ZONE_ROWS && Math.abs(value - values[at - DEAD_ZONE_ROWS]!) > DEAD_ZONE_COUNTS);
}

function deadZone(pot: number): string {
  return `${named(pot)} jumps from one end of its track to the other within the joint's range: its dead zone lies there; `
    + "turn its shaft by half a turn in its coupling and begin anew.";
}

/** True if it stays near 5 V but is at no rail: a pull-down makes that of an end of the track on the pin. */
function isCrossed(own: Column): boolean {
  return own.low > CROSSED_FROM_COUNTS && own.high < FULL_SCALE - RAIL_COUNTS && RAIL_COUNTS < span(own) && span(own) < CROSSED_SPAN_COUNTS;
}

function crossed(own: Column, pot: number): string {
  return `${named(pot)} reads ${reading(own)} and hardly changes near 5 V: its wiper's wire and an end's are exchanged; the wiper `
    + "is mostly the middle one of the three. Change them: near an end of the track this shorts 5 V to ground.";
}
