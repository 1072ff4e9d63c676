// Reads a TOML file; one of another kind than wanted is told by name, as greywhale/base/formats does.

import { parse, TomlError } from "smol-toml";
import { LinkError } from "../link/declared";
import type { NamedText } from "../parts/named_text";
import { isTable } from "./check";
import type { Path, Toml, TomlTable } from "./toml_types";
import { findMark } from "./toml_marks";
import { cut, keyPath } from "./words";

const LONGEST = 1 << 22;
const LARGEST = 1n << 63n;
// The beginnings of the first line of a log or a motion, and of one of a TOML file: a key, or a table's name.
const BEGINS_CSV = /^"?time_s"?[,;\t]/;
const BEGINS_TOML = /^[ \t]*(("[^"]*"|'[^']*'|[A-Za-z0-9_-]+)[ \t]*[.=]|\[\[?[ \t]*["'A-Za-z0-9_-])/;

/** The content of a file: integers as bigint. */
export function readToml({ name, text: whole, spoiltAt }: NamedText): TomlTable {
  if (spoiltAt !== undefined) throw new LinkError(`${name}: byte ${spoiltAt} is not UTF-8; TOML files must be UTF-8 text.`);
  const text = whole.replace(/^\ufeff/, "");
  if (text.length > LONGEST && [...text].length > LONGEST) {
    throw new LinkError(`${name}: ${[...text].length} characters; a TOML file of greywhale has at most ${LONGEST}.`);
  }
  const mark = findMark(text);
  if (mark?.deep) throw new LinkError(`${name}, line ${mark.line}: ${mark.words}.`);
  let data: TomlTable;
  try {
    data = parse(whole, { integersAsBigInt: true }) as TomlTable; // it passes over one such mark itself
  } catch (error) {
    if (!(error instanceof TomlError)) throw error;
    const lines = text.split("\n");
    const place = lines.findIndex((line) => line.trim() && !line.startsWith("#"));
    const first = lines[place] ?? "";
    const why = BEGINS_CSV.test(first) ? "this is a log or a motion (CSV)"
      : first && !BEGINS_TOML.test(first) ? `line ${place + 1} is neither KEY = VALUE nor a [TABLE]; is this a file of greywhale?`
      : `${cut(error.message.split("\n")[0]!.replace("Invalid TOML document: ", ""), 200)} (at line ${error.line}, column ${error.column})`;
    throw new LinkError(`${name}: not valid TOML: ${why}${why.endsWith("?") ? "" : "."}`);
  }
  if (mark) throw new LinkError(`${name}: not valid TOML: ${mark.words} (at line ${mark.line}).`);
  if (!Object.keys(data).length) {
    throw new LinkError(`${name}: it is empty${text.trim() ? ", but for comments" : ""}; choose another file.`);
  }
  refuseOdd(data, [], name);
  return data;
}

/** Refuses numbers beyond any range, and dates, of which each parser has another opinion. */
function refuseOdd(value: Toml, path: Path, name: string): void {
  if (typeof value === "number" && !Number.isFinite(value)) {
    const words = Number.isNaN(value) ? "nan" : value > 0 ? "inf" : "-inf";
    throw new LinkError(`${name}: ${keyPath(path)} is ${words}; it must be a finite number.`);
  }
  if (typeof value === "bigint" && (value > LARGEST || value < -LARGEST)) {
    const bits = (value < 0 ? -value : value).toString(2).length;
    const shown = bits < 1000 ? cut(String(value), 30) : `a number of ${bits} bits`;
    throw new LinkError(`${name}: ${keyPath(path)} is ${shown}, which is out of any range.`);
  }
  if (value instanceof Date) throw new LinkError(`${name}: ${keyPath(path)} is a date or a time, but no file of greywhale holds one.`);
  if (Array.isArray(value)) (value as readonly Toml[]).forEach((one, place) => refuseOdd(one, [...path, place], name));
  else if (isTable(value)) for (const [key, one] of Object.entries(value)) refuseOdd(one, [...path, key], name);
}

const KINDS = {
  arm: ["an arm file", "greywhale identify --arm"],
  model: ["a model", "greywhale tune"],
  controller: ["a controller file", "greywhale upload"],
  parameters: ["a parameter file", "greywhale params restore"],
  answers: ["a file of answers", "greywhale arm new --answers"],
} as const;
type Kind = keyof typeof KINDS;

// Keys that only one kind has, in one of its [[joint]] and [[link]] tables.
const OF_CONTROLLER = ["kp", "kd", "ki", "ku", "sets"];
const OF_ARM = ["motor", "friction", "gear", "stops", "inertia", "centre"];
const OF_ANSWERS = /(_mm|_g|_deg|_rpm|_ma|_a|_ncm|_nm|_ohm|_gcm2|_v)$/;

/** The kind of a file by its keys; null where nothing tells it. */
function kindOf(data: TomlTable): Kind | null {
  const tables = [data["joint"], data["link"]].flatMap((one) => Array.isArray(one) ? (one as readonly Toml[]).filter(isTable) : []);
  const inside = tables.flatMap((one) => Object.keys(one));
  if (inside.some((key) => OF_CONTROLLER.includes(key))) return "controller";
  if (inside.some((key) => OF_ARM.includes(key)) || ["drive", "leader_pots", "follower_pots"].some((key) => key in data)) {
    return "identification" in data ? "model" : "arm";
  }
  const groups = Object.keys(data).filter((key) => /^(joint|leader|follower)[0-3]$/.test(key));
  if (groups.some((key) => isTable(data[key]))) return "parameters";
  return inside.some((key) => OF_ANSWERS.test(key)) || "supply_v" in data ? "answers" : null;
}

/** Refuses a file that is clearly of another kind than wanted. */
export function refuseOtherKind(data: TomlTable, name: string, wanted: Kind): void {
  const kind = kindOf(data);
  if (kind === null || kind === wanted) return;
  const [words, taker] = KINDS[kind];
  throw new LinkError(`${name}: this is ${words}, but ${KINDS[wanted][0]} is needed here (${taker} takes ${words}).`);
}
