// The law of one joint in plain numbers, as greywhale/fuzzy/exact.py defines it, and why a board would refuse settings.

import { Refusal } from "../link/schema";

export const SET_NAMES = ["ne_c", "ze_a", "ze_c", "pe_b", "nce_c", "zce_a", "zce_c", "pce_b"] as const;
export const FACTOR_NAMES = ["kp", "kd", "ki", "ku_mv", "ce_ticks"] as const;
export type SetName = (typeof SET_NAMES)[number];
export type FactorName = (typeof FACTOR_NAMES)[number];
export const SETTING_NAMES = [...SET_NAMES, ...FACTOR_NAMES] as const;

/** One joint's settings as the board stores them: sets in q14, gains in q16, Ku in mV, control periods. */
export type Settings = Readonly<Record<SetName | FactorName, number>>;

export const SET_UNIT = 1 << 14;
const GAIN_UNIT = 1 << 16;
const LEAST_WIDTH = 164; // 0.01, rounded up
const LARGEST_K = 64 * GAIN_UNIT;
const LARGEST_KI = 1000 * GAIN_UNIT;
const LARGEST_KI_PERIOD = 1 << 28;
const LARGEST_KU_MV = 30_000;
const LONGEST_PERIOD_MS = 50;
const MOST_CE_TICKS = 20;
const KD_SPAN_MS = 20;
const LARGEST_DIFFERENCE_RAD = 32767 / 4096;

/** The raw values between which a corner may lie. */
export function cornerRange(name: SetName): [least: number, most: number] {
  return isLeft(name) ? [-SET_UNIT, -LEAST_WIDTH] : [LEAST_WIDTH, SET_UNIT];
}

function isLeft(name: SetName): boolean {
  return name === "ne_c" || name === "ze_a" || name === "nce_c" || name === "zce_a";
}

export type Memberships = { readonly negative: number; readonly zero: number; readonly positive: number };
const INPUTS = ["negative", "zero", "positive"] as const;

/** Table 6: the output of each pair of an error's and a change's set, -1, 0 or 1. */
export const RULES: readonly (readonly number[])[] = [[-1, -1, 0], [-1, 0, 1], [0, 1, 1]];

/** N, Z and P at x in -1..1 for corners in q14: the end of N's plateau, Z's feet, the start of P's plateau. */
export function fuzzify(x: number, n: number, left: number, right: number, p: number): Memberships {
  const at = x * SET_UNIT;
  return {
    negative: at <= n ? 1 : Math.max(0, at / n),
    zero: at <= 0 ? Math.max(0, 1 - at / left) : Math.max(0, 1 - at / right),
    positive: at >= p ? 1 : Math.max(0, at / p),
  };
}

export type Inference = {
  readonly error: Memberships;
  readonly change: Memberships;
  /** The strength of each rule, rows by the error's set, columns by the change's. */
  readonly rules: readonly (readonly number[])[];
  readonly u: number; // -1..1; 0 when no rule fires
};

/** The law's output for x and y in -1..1. */
export function infer(x: number, y: number, s: Settings): Inference {
  const error = fuzzify(x, s.ne_c, s.ze_a, s.ze_c, s.pe_b);
  const change = fuzzify(y, s.nce_c, s.zce_a, s.zce_c, s.pce_b);
  const rules = INPUTS.map((row) => INPUTS.map((column) => Math.min(error[row], change[column])));
  const heights = [0, 0, 0];
  rules.forEach((row, i) => row.forEach((strength, j) => {
    const output = RULES[i]![j]! + 1;
    heights[output] = Math.max(heights[output]!, strength);
  }));
  const total = heights[0]! + heights[1]! + heights[2]!;
  return { error, change, rules, u: total > 0 ? (heights[2]! - heights[0]!) / total : 0 };
}

/** x and y: an error and its change over `ce_ticks` control periods (rad) as the sets get them. */
export function inputs(error: number, change: number, s: Settings, periodMs: number): [x: number, y: number] {
  const kd = ((s.kd / GAIN_UNIT) * KD_SPAN_MS) / (s.ce_ticks * periodMs);
  return [
    clamp((s.kp / GAIN_UNIT) * clamp(error, LARGEST_DIFFERENCE_RAD), 1),
    clamp(kd * clamp(change, LARGEST_DIFFERENCE_RAD), 1),
  ];
}

function clamp(value: number, limit: number): number {
  return Math.max(-limit, Math.min(limit, value));
}

/** The reason why a board would refuse these settings, as a value of Refusal: the firmware's checks in their order. */
export function refusal(s: Settings, periodMs: number): number {
  if (periodMs < 1 || periodMs > LONGEST_PERIOD_MS) return Refusal.is.period;
  if (s.ce_ticks < 1 || s.ce_ticks > MOST_CE_TICKS) return Refusal.is.range;
  const order: readonly SetName[] = ["ne_c", "pe_b", "ze_a", "ze_c", "nce_c", "pce_b", "zce_a", "zce_c"];
  for (const name of order) {
    const outward = isLeft(name) ? -s[name] : s[name];
    if (Math.abs(outward) > SET_UNIT) return Refusal.is.range;
    if (outward < 0) return Refusal.is.order;
    if (outward < LEAST_WIDTH) return Refusal.is.width;
  }
  const tooLarge = s.kp > LARGEST_K || s.kd > LARGEST_K || s.ki > LARGEST_KI || s.ku_mv > LARGEST_KU_MV;
  return tooLarge || s.ki * periodMs >= LARGEST_KI_PERIOD ? Refusal.is.gain : Refusal.is.none;
}
