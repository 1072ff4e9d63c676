// Settings as people read them: the paper's names, units without thousandths, and as many digits as an eye takes in.

import { upperFirst } from "../../link/refusal";
import { TABLE } from "../../link/schema";
import type { FactorName, SetName } from "../../session/law";

type Name = SetName | FactorName;
type Told = { readonly label: string; readonly unit: string; readonly times: number };

const DIGITS = 4; // significant: finer steps of a controller change nothing that an arm shows
const MOST_DIGITS = 8; // tell any two raw values apart

const FACTORS: Readonly<Record<FactorName, Told>> = {
  kp: { label: "Kp", unit: "1/rad", times: 1 },
  kd: { label: "Kd", unit: "1/rad", times: 1 },
  ki: { label: "Ki", unit: "V/(rad s)", times: 1 },
  ku_mv: { label: "Ku", unit: "V", times: 1e-3 },
  ce_ticks: { label: "Change over", unit: "periods", times: 1 },
};

/** A setting's name, its unit, and the size of one raw step in it. */
export function told(name: Name): Told & { readonly step: number } {
  const known = name in FACTORS ? FACTORS[name as FactorName] : { label: upperFirst(name), unit: "", times: 1 };
  return { ...known, step: TABLE.named(`joint0.${name}`).lsb * known.times };
}

export function textOf(name: Name, raw: number, digits = DIGITS): string {
  return String(Number((raw * told(name).step).toPrecision(digits)));
}

/** A change, with the digits that show it; one value where there is none. */
export function changeOf(name: Name, from: number, to: number): string {
  if (from === to) return textOf(name, to);
  for (let digits = DIGITS - 1; ; digits++) {
    const [was, is] = [textOf(name, from, digits), textOf(name, to, digits)];
    if (was !== is || digits === MOST_DIGITS) return `${was} → ${is}`;
  }
}

/** Two numbers of a prediction, or one where both look the same; null is a measure that there is not. */
export function pairOf(from: number | null, to: number | null, digits: number, none: string): string {
  const [was, is] = [from, to].map((value) => (value === null ? none : value.toFixed(digits))) as [string, string];
  return was === is ? is : `${was} → ${is}`;
}
