// Where the running arm is on its control surface: x and y of the newest samples, by the settings that run.

import { TICKS_A_SECOND, type Samples } from "../samples/samples";
import { inputs, type Settings } from "./law";
import type { Point } from "./surface";

const SHOWN_TICKS = TICKS_A_SECOND;
const EVERY = 5;

/** The points of the last second of one joint, oldest first. */
export function operatingPoints(samples: Samples, joint: number, settings: Settings, periodMs: number): Point[] {
  const back = settings.ce_ticks * periodMs;
  const first = Math.max(samples.first + back, samples.end - SHOWN_TICKS);
  const points: Point[] = [];
  for (let number = samples.end - 1; number >= first; number -= EVERY) {
    const error = samples.value(number, "error", joint);
    const change = error - samples.value(number - back, "error", joint);
    const [x, y] = inputs(error, change, settings, periodMs);
    points.push({ x, y });
  }
  return points.reverse();
}
