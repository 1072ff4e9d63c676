// Checks the content of a TOML file against the host's schema; whatever is wrong is one sentence, that of the host.

import { LinkError } from "../link/declared";
import * as rules from "./rules";
import type { Schema } from "./schema_types";
import type { Path, Toml, TomlTable } from "./toml_types";
import { advice, keyPath, quoted, short } from "./words";

type Problem = { readonly path: Path; readonly kind: "unknown" | "count" | "other"; readonly text: string };

export function isTable(value: Toml | undefined): value is TomlTable {
  return typeof value === "object" && !Array.isArray(value) && !(value instanceof Date);
}

export function isNumber(value: Toml | undefined): value is number | bigint {
  return typeof value === "number" || typeof value === "bigint";
}

const IS: Readonly<Record<string, (value: Toml) => boolean>> = {
  number: isNumber,
  integer: (value) => typeof value === "bigint",
  string: (value) => typeof value === "string",
  boolean: (value) => typeof value === "boolean",
  array: Array.isArray,
  object: isTable,
};

function other(path: Path, text: string): Problem[] {
  return [{ path, kind: "other", text }];
}

function wrong(path: Path, value: Toml, rule: string): Problem[] {
  return other(path, rules.wrongValue({ key: keyPath(path), value: quoted(value), rule }));
}

function problemsOf(value: Toml, schema: Schema, path: Path): Problem[] {
  const { type, enum: known } = schema;
  if (known && !known.some((one) => String(one) === String(value))) {
    return wrong(path, value, `it should be ${known.map((one) => (typeof one === "string" ? `'${one}'` : one)).join(" or ")}`);
  }
  if (!IS[type]!(value)) {
    const rule = rules.TYPE_RULES[type as keyof typeof rules.TYPE_RULES];
    if (!Array.isArray(value) && !isTable(value)) return wrong(path, value, rule);
    return other(path, path.length ? rules.wrongTable({ key: keyPath(path), rule }) : rule);
  }
  if (isNumber(value)) return outside(value, schema) ? wrong(path, value, boundsOf(schema)) : [];
  if (Array.isArray(value)) return problemsOfList(value as readonly Toml[], schema, path);
  return isTable(value) ? problemsOfTable(value, schema, path) : [];
}

function outside(value: number | bigint, { minimum, exclusiveMinimum, maximum }: Schema): boolean {
  return value < (minimum ?? -Infinity) || value <= (exclusiveMinimum ?? -Infinity) || value > (maximum ?? Infinity);
}

/** All bounds of a number, whichever it misses. */
function boundsOf(schema: Schema): string {
  const told = Object.entries(rules.BOUND_WORDS).flatMap(([bound, words]) => {
    const at = schema[bound as "minimum" | "exclusiveMinimum" | "maximum"];
    return at === undefined ? [] : [`${words} ${short(at)}`];
  });
  return rules.within({ bounds: told.join(" and ") });
}

/** One after the other; those of a list with a type for each that are not there, and the number of all. */
function problemsOfList(items: readonly Toml[], schema: Schema, path: Path): Problem[] {
  const { prefixItems, minItems: exactly = 0 } = schema;
  const found = items.slice(0, exactly)
    .flatMap((one, place) => problemsOf(one, prefixItems?.[place] ?? schema.items!, [...path, place]));
  if (items.length === exactly) return found;
  const key = keyPath(path);
  if (prefixItems && items.length < exactly) {
    const left = prefixItems.map((_, place) => [...path, place]).slice(items.length);
    return [...found, ...left.flatMap((place) => other(place, rules.missingKey({ key: keyPath(place) })))];
  }
  const words = items.every(isTable) ? rules.countOfTables : rules.countOfValues;
  return [...found, { path, kind: "count", text: words({ count: items.length, key, exactly }) }];
}

function problemsOfTable(value: TomlTable, { properties: known, required = [] }: Schema, path: Path): Problem[] {
  if (!known) return [];
  const missing = (key: string): Problem[] =>
    required.includes(key) ? other([...path, key], rules.missingKey({ key: keyPath([...path, key]) })) : [];
  const problems = Object.entries(known).flatMap(([key, inside]) =>
    value[key] === undefined ? missing(key) : problemsOf(value[key], inside, [...path, key]));
  const unknown = Object.keys(value).filter((key) => !Object.hasOwn(known, key)).map((key): Problem => {
    const place = [...path, key];
    const text = rules.unknownKey({ key: keyPath(place), advice: advice(key, Object.keys(known)) });
    return { path: place, kind: "unknown", text };
  });
  return [...problems, ...unknown];
}

/** Fails with the first problem, a misspelt key before all others: it is often missing as well. */
export function require(content: TomlTable, schema: Schema, name: string): void {
  const problems = problemsOf(content, schema, []);
  problems.sort((a, b) => Number(b.kind === "unknown") - Number(a.kind === "unknown"));
  const within = ({ path }: Problem): boolean =>
    problems.some((one) => one.path.length > path.length && path.every((part, i) => one.path[i] === part));
  const own = problems.filter((one) => one.kind !== "count" || !within(one));
  if (!own.length) return;
  throw new LinkError(`${name}: ${own[0]!.text}${own.length > 1 ? rules.more({ count: own.length - 1 }) : ""}.`);
}
