// The measures of a prediction, as greywhale.measure defines them: overshoot, settling time and error of each joint.

import type { Predicted, Prediction } from "./services";

const SETTLED_SHARE = 0.05; // of a step: the band around the new place in which a follower has settled
const LEAST_BAND_RAD = 0.02; // a leader rests in it, too
const SMOOTH_S = 0.02;

/** Of one joint. A joint that does not step has neither overshoot nor settling time; null there: it does not settle. */
export type Follows = {
  readonly overshoot: number | null; // % of the step
  readonly settling: number | null; // s
  readonly step: number; // rad rms
  readonly reach: number;
};

export function follows({ step, reach }: Prediction): Follows[] {
  return step.mse.map((mse, joint) => ({
    ...answer(step, joint), step: Math.sqrt(mse), reach: Math.sqrt(reach.mse[joint]!),
  }));
}

function answer({ time_s, leader, follower }: Predicted, joint: number): Pick<Follows, "overshoot" | "settling"> {
  const period = time_s[1]! - time_s[0]!;
  const [led, followed] = [leader, follower].map((rows) => smooth(rows.map((row) => row[joint]!), SMOOTH_S / period)) as
    [number[], number[]];
  const place = led.at(-1)!;
  const size = place - led[0]!;
  if (!size) return { overshoot: null, settling: null };
  const band = Math.max(SETTLED_SHARE * Math.abs(size), LEAST_BAND_RAD);
  const lastOutside = (angles: readonly number[]): number => angles.reduce((last, angle, row) => (Math.abs(angle - place) > band ? row : last), -1);
  const [arrived, settled] = [lastOutside(led), lastOutside(followed)];
  const beyond = Math.max(...followed.map((angle) => (angle - place) / size));
  return {
    overshoot: 100 * Math.max(0, beyond),
    settling: settled === followed.length - 1 ? null : Math.max(0, settled - arrived) * period,
  };
}

/** Each value's mean with those around it, so many in all; beyond its ends a row goes on as there. */
function smooth(values: readonly number[], count: number): number[] {
  const around = Array.from({ length: Math.round(count) }, (_, place) => place - Math.floor(Math.round(count) / 2));
  return values.map((_, row) =>
    around.reduce((sum, by) => sum + values[Math.max(0, Math.min(values.length - 1, row + by))]!, 0) / around.length);
}
