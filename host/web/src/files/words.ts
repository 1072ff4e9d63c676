// Words of sentences about files, as Python words them: numbers, what is quoted, which key was meant.

import { checkSpelling, perhaps } from "./rules";
import type { Path, Toml } from "./toml_types";

const LONGEST = 60;
const LONGEST_PATH = 120;
const DIGITS = 6;
const ALIKE = 0.6;

/** A number with at most six digits, as "%g" writes it. */
export function short(value: number): string {
  if (!Number.isFinite(value)) return Number.isNaN(value) ? "nan" : value > 0 ? "inf" : "-inf";
  if (value === 0) return Object.is(value, -0) ? "-0" : "0";
  const exponent = Number(value.toExponential(DIGITS - 1).split("e")[1]);
  if (exponent >= -4 && exponent < DIGITS) return String(Number(value.toPrecision(DIGITS)));
  const [digits, power] = value.toExponential(DIGITS - 1).split("e") as [string, string];
  return `${String(Number(digits))}e${power.slice(0, 1)}${power.slice(1).padStart(2, "0")}`;
}

/** A number with so many digits after its point; of two that are as near, the even one. */
export function fixed(value: number, digits: number): string {
  const scaled = value * 10 ** digits;
  const halfway = Number.isInteger(value * 2 ** (digits + 1)) && Math.abs(scaled % 1) === 0.5;
  return (halfway ? (2 * Math.round(scaled / 2)) / 10 ** digits : value).toFixed(digits);
}

export function cut(text: string, most = LONGEST): string {
  if (text.length <= most) return text;
  const end = Math.floor(most / 3);
  return `${text.slice(0, most - end - 3)}...${text.slice(-end)}`;
}

/** A value as JSON, a float with its point. */
export function quoted(value: Toml): string {
  return cut(json(value));
}

function json(value: Toml): string {
  if (typeof value === "number") return float(value);
  if (typeof value === "bigint") return String(value);
  if (Array.isArray(value)) return `[${(value as readonly Toml[]).map(json).join(", ")}]`;
  if (typeof value === "object" && !(value instanceof Date)) {
    return `{${Object.entries(value).map(([key, one]) => `${json(key)}: ${json(one)}`).join(", ")}}`;
  }
  const text = JSON.stringify(value instanceof Date ? value.toISOString() : value);
  return text.replace(/[^ -~]/g, (one) => `\\u${one.charCodeAt(0).toString(16).padStart(4, "0")}`);
}

/** The shortest digits that give the number again, as Python writes them. */
function float(value: number): string {
  const size = Math.abs(value);
  if (value !== 0 && (size < 1e-4 || size >= 1e16)) return String(value.toExponential()).replace(/e([-+])(\d)$/, "e$10$2");
  return `${Object.is(value, -0) ? "-0" : value}${Number.isInteger(value) ? ".0" : ""}`;
}

/** A key as people write it: joint[2].sets.Ne_c. */
export function keyPath(path: Path): string {
  const words = path.map((part, place) => {
    if (typeof part === "number") return `[${part}]`;
    return (place ? "." : "") + cut(/^[A-Za-z0-9_-]+$/.test(part) ? part : quoted(part));
  });
  return cut(words.join(""), LONGEST_PATH) || "the file";
}

/** Advice about an unknown key: the one that was probably meant, if there is one. */
export function advice(key: string, known: readonly string[]): string {
  const [best] = known.map((name) => ({ name, score: likeness(name, key) })).filter(({ score }) => score >= ALIKE)
    .sort((a, b) => b.score - a.score || (a.name < b.name ? 1 : -1));
  return best ? perhaps({ key: best.name }) : checkSpelling();
}

function likeness(one: string, other: string): number {
  return (2 * matching(one, other)) / (one.length + other.length);
}

/** The number of letters that match: the longest common piece, and again to its left and to its right. */
function matching(one: string, other: string): number {
  for (let size = Math.min(one.length, other.length); size; size--) {
    for (let at = 0; at + size <= one.length; at++) {
      const there = other.indexOf(one.slice(at, at + size));
      if (there < 0) continue;
      return size + matching(one.slice(0, at), other.slice(0, there)) + matching(one.slice(at + size), other.slice(there + size));
    }
  }
  return 0;
}
