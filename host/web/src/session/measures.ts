// The running measures of each joint, as greywhale.measure defines them: error rms, ripple of the voltage, delay.

import { JOINTS, TICKS_A_SECOND, type Quantity, type Samples } from "./samples";

const WINDOW_TICKS = 10 * TICKS_A_SECOND;
const RIPPLE_TICKS = 25;
const SMALLEST_MOTION_RAD = 0.05;
const LOWEST_CORRELATION = 0.5;
const LONGEST_DELAY_TICKS = 500;
const BEFORE_ZERO_TICKS = 100;
const DELAY_STEP = 4; // samples; the parabola refines between

export type JointMeasures = {
  readonly errorRms: number; // rad
  readonly rippleRms: number; // V
  readonly delay: number | null; // s; null where nothing moves, or nothing follows
};

/** The measures of the newest samples, at most ten seconds of them; null before there is a second. */
export function measure(samples: Samples): JointMeasures[] | null {
  const from = samples.at(samples.lastTime - WINDOW_TICKS + 1);
  if (samples.end - from < TICKS_A_SECOND) return null;
  return Array.from({ length: JOINTS }, (_, joint) => {
    const trace = (quantity: Quantity): Float64Array =>
      Float64Array.from({ length: samples.end - from }, (_, i) => samples.value(from + i, quantity, joint));
    return {
      errorRms: rms(trace("error")), rippleRms: ripple(trace("voltage")), delay: delay(trace("leader"), trace("follower")),
    };
  });
}

function rms(values: Float64Array): number {
  return Math.sqrt(values.reduce((sum, value) => sum + value * value, 0) / values.length);
}

/** The rms of a voltage less its mean over 25 ms: what a motor does not follow. */
export function ripple(values: Float64Array): number {
  const half = RIPPLE_TICKS >> 1;
  let sum = 0;
  for (let i = 0; i < RIPPLE_TICKS; i++) sum += values[i]!;
  let squares = 0;
  let counted = 0;
  for (let centre = half; centre < values.length - half; centre++) {
    const less = values[centre]! - sum / RIPPLE_TICKS;
    squares += less * less;
    counted++;
    sum += (values[centre + half + 1] ?? 0) - values[centre - half]!;
  }
  return Math.sqrt(squares / counted);
}

/** The lag in s at which the follower resembles the leader most, null where nothing moves or nothing follows. */
export function delay(leader: Float64Array, follower: Float64Array): number | null {
  if (range(leader) < SMALLEST_MOTION_RAD || range(follower) < SMALLEST_MOTION_RAD) return null;
  const a = thin(leader);
  const b = thin(follower);
  const first = -BEFORE_ZERO_TICKS / DELAY_STEP;
  const likeness: number[] = [];
  for (let lag = first; lag <= LONGEST_DELAY_TICKS / DELAY_STEP; lag++) likeness.push(correlation(a, b, lag));
  const best = likeness.indexOf(Math.max(...likeness));
  if (likeness[best]! < LOWEST_CORRELATION || best === 0 || best === likeness.length - 1) return null;
  const [left, peak, right] = [likeness[best - 1]!, likeness[best]!, likeness[best + 1]!];
  const bend = left - 2 * peak + right;
  const between = bend < 0 ? (0.5 * (left - right)) / bend : 0;
  return ((first + best + between) * DELAY_STEP) / TICKS_A_SECOND;
}

function range(values: Float64Array): number {
  let low = Infinity;
  let high = -Infinity;
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return high - low;
}

function thin(values: Float64Array): Float64Array {
  return Float64Array.from({ length: Math.floor(values.length / DELAY_STEP) }, (_, i) => values[i * DELAY_STEP]!);
}

/** Pearson's correlation of a[k] and b[k + lag] over what both have. */
function correlation(a: Float64Array, b: Float64Array, lag: number): number {
  const from = Math.max(0, -lag);
  const to = Math.min(a.length, b.length - lag);
  let sumA = 0, sumB = 0, sumAA = 0, sumBB = 0, sumAB = 0;
  for (let k = from; k < to; k++) {
    const x = a[k]!;
    const y = b[k + lag]!;
    sumA += x; sumB += y; sumAA += x * x; sumBB += y * y; sumAB += x * y;
  }
  const count = to - from;
  const spread = Math.sqrt((sumAA - (sumA * sumA) / count) * (sumBB - (sumB * sumB) / count));
  return spread > 1e-9 ? (sumAB - (sumA * sumB) / count) / spread : 0;
}
