// Checks the content of a TOML file against what it should hold; whatever is wrong is one sentence, that of the host.

import { LinkError } from "../link/declared";
import type { Path, Toml, TomlTable } from "./toml_types";
import { advice, keyPath, quoted, short } from "./words";

type Problem = { readonly path: Path; readonly kind: "unknown" | "count" | "other"; readonly text: string };

/** A check of a value: it names the fault of one that is not as it should be. */
export type Shape = (value: Toml, path: Path) => Problem[];

export function isTable(value: Toml | undefined): value is TomlTable {
  return typeof value === "object" && !Array.isArray(value) && !(value instanceof Date);
}

function other(path: Path, value: Toml, words: string): Problem[] {
  const whole = Array.isArray(value) || isTable(value);
  const text = !whole ? `${keyPath(path)} is ${quoted(value)}, but ${words}` : path.length ? `${keyPath(path)}: ${words}` : words;
  return [{ path, kind: "other", text }];
}

/** A number, perhaps within bounds that are told as "at least", or within a range that `words` tell. */
export function number(least = -Infinity, most = Infinity, words = ""): Shape {
  return (value, path) => {
    if (typeof value !== "number" && typeof value !== "bigint") return other(path, value, "it should be a valid number");
    if (value >= least && value <= most) return [];
    return other(path, value, words || `it must be at least ${short(least)} and at most ${short(most)}`);
  };
}

export const whole: Shape = (value, path) => typeof value === "bigint" ? [] : other(path, value, "it should be a valid integer");
export const text: Shape = (value, path) => typeof value === "string" ? [] : other(path, value, "it should be a valid string");
export const anyTable: Shape = (value, path) => isTable(value) ? [] : other(path, value, "it should be an object");

/** A list of exactly so many values, or of tables, which are counted otherwise. */
export function list(count: number, item: Shape, ofTables: boolean): Shape {
  return (value, path) => {
    if (!Array.isArray(value)) return other(path, value, "it should be a valid array");
    const items = value as readonly Toml[];
    const found = items.slice(0, count).flatMap((one, place) => item(one, [...path, place]));
    if (items.length < count && !ofTables) {
      const missing = Array.from({ length: count - items.length }, (_, left): Problem => {
        const place = [...path, items.length + left];
        return { path: place, kind: "other", text: `${keyPath(place)} is missing` };
      });
      return [...found, ...missing];
    }
    if (items.length === count) return found;
    const what = items.every(isTable) ? `[[${keyPath(path)}]]` : `values of ${keyPath(path)}`;
    return [...found, { path, kind: "count", text: `${items.length} ${what} where there must be exactly ${count}` }];
  };
}

/** A table of these keys, some of them optional, and no others; `rule` looks at a sound one as a whole, and says what is wrong, if anything. */
export function table(
  known: Readonly<Record<string, Shape>>, optional: readonly string[] = [], rule: (found: TomlTable) => string = () => "",
): Shape {
  return (value, path) => {
    if (!isTable(value)) return other(path, value, "it should be an object");
    const problems = Object.entries(known).flatMap(([key, shape]): Problem[] => {
      const inside = value[key];
      if (inside !== undefined) return shape(inside, [...path, key]);
      return !optional.includes(key) ? [{ path: [...path, key], kind: "other", text: `${keyPath([...path, key])} is missing` }] : [];
    });
    for (const key of Object.keys(value)) {
      if (Object.hasOwn(known, key)) continue;
      const place = [...path, key];
      problems.push({ path: place, kind: "unknown", text: `unknown key ${keyPath(place)}; ${advice(key, Object.keys(known))}` });
    }
    const broken = problems.length ? "" : rule(value);
    return broken ? other(path, value, broken) : problems;
  };
}

/** Fails with the first problem, a misspelt key before all others: it is often missing as well. */
export function require(content: TomlTable, shape: Shape, name: string): void {
  const problems = shape(content, []);
  problems.sort((a, b) => Number(b.kind === "unknown") - Number(a.kind === "unknown"));
  const within = ({ path }: Problem): boolean => problems.some((one) => one.path.length > path.length && path.every((part, i) => one.path[i] === part));
  const own = problems.filter((one) => one.kind !== "count" || !within(one));
  if (!own.length) return;
  const more = own.length > 1 ? ` (and ${own.length - 1} more in this file)` : "";
  throw new LinkError(`${name}: ${own[0]!.text}${more}.`);
}
