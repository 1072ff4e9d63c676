// Reads a TOML file; one of another kind than wanted is told by name.

import { parse, TomlError } from "smol-toml";
import { LinkError } from "../link/declared";
import type { NamedText } from "../parts/named_text";
import { isTable } from "./check";
import * as rules from "./rules";
import type { FileKind } from "./schema_types";
import type { Path, Toml, TomlTable } from "./toml_types";
import { findMark } from "./toml_marks";
import { cut, keyPath } from "./words";

/** The content of a file: integers as bigint. */
export function readToml({ name, text: whole, spoiltAt }: NamedText): TomlTable {
  if (spoiltAt !== undefined) throw new LinkError(`${name}: ${rules.notUtf8({ at: spoiltAt })}`);
  const text = whole.replace(/^\ufeff/, "");
  const most = rules.LONGEST_TEXT;
  const count = text.length > most ? [...text].length : 0;
  if (count > most) throw new LinkError(`${name}: ${rules.tooLong({ count, most })}`);
  const mark = findMark(text);
  if (mark?.deep) throw new LinkError(`${name}, line ${mark.line}: ${mark.words}`);
  let data: TomlTable;
  try {
    data = parse(whole, { integersAsBigInt: true }) as TomlTable; // it passes over one such mark itself
  } catch (error) {
    if (!(error instanceof TomlError)) throw error;
    const lines = text.split("\n");
    const place = lines.findIndex((line) => line.trim() && !line.startsWith("#"));
    const first = lines[place] ?? "";
    const why = cut(error.message.split("\n")[0]!.replace("Invalid TOML document: ", ""), 200);
    const sentence = rules.CSV_LINE.test(first) ? rules.csvInItsPlace()
      : first && !rules.TOML_LINE.test(first) ? rules.noTomlLine({ line: place + 1 })
      : rules.noToml({ why: `${why} (at line ${error.line}, column ${error.column})` });
    throw new LinkError(`${name}: ${sentence}`);
  }
  if (mark) throw new LinkError(`${name}: ${rules.noToml({ why: `${mark.words} (at line ${mark.line})` })}`);
  if (!Object.keys(data).length) throw new LinkError(`${name}: ${text.trim() ? rules.commentsAlone() : rules.empty()}`);
  refuseOdd(data, [], name);
  return data;
}

/** Refuses numbers beyond any range, and dates, of which each parser has another opinion. */
function refuseOdd(value: Toml, path: Path, name: string): void {
  const key = keyPath(path);
  if (typeof value === "number" && !Number.isFinite(value)) {
    const words = Number.isNaN(value) ? "nan" : value > 0 ? "inf" : "-inf";
    throw new LinkError(`${name}: ${rules.notFinite({ key, value: words })}`);
  }
  if (typeof value === "bigint" && (value > rules.LARGEST_INTEGER || value < -rules.LARGEST_INTEGER)) {
    const bits = (value < 0 ? -value : value).toString(2).length;
    const shown = bits < 1000 ? cut(String(value), 30) : `a number of ${bits} bits`;
    throw new LinkError(`${name}: ${rules.beyondAnyRange({ key, value: shown })}`);
  }
  if (value instanceof Date) throw new LinkError(`${name}: ${rules.date({ key })}`);
  if (Array.isArray(value)) (value as readonly Toml[]).forEach((one, place) => refuseOdd(one, [...path, place], name));
  else if (isTable(value)) for (const [key, one] of Object.entries(value)) refuseOdd(one, [...path, key], name);
}

export type Kind = keyof typeof rules.KINDS;

/** The kind of a file by its keys, the first with a mark there; undefined where nothing tells it. */
function kindOf(data: TomlTable): Kind | undefined {
  const tables = [data["joint"], data["link"]].flatMap((one) => Array.isArray(one) ? (one as readonly Toml[]).filter(isTable) : []);
  const inside = tables.flatMap((one) => Object.keys(one));
  return (Object.keys(rules.KINDS) as Kind[]).find((kind) => isMarked(data, inside, rules.KINDS[kind]));
}

function isMarked(data: TomlTable, inside: readonly string[], marks: FileKind): boolean {
  const found = inside.some((key) => marks.inside?.includes(key) || marks.inside_ends?.some((end) => key.endsWith(end)))
    || marks.top?.some((key) => key in data) || marks.tables?.some((key) => isTable(data[key]));
  return Boolean(found) && (!marks.and_key || marks.and_key in data);
}

/** Refuses a file that is clearly of another kind than wanted. */
export function refuseOtherKind(data: TomlTable, name: string, wanted: Kind): void {
  const kind = kindOf(data);
  if (kind === undefined || kind === wanted) return;
  const { words, taker } = rules.KINDS[kind];
  throw new LinkError(`${name}: ${rules.otherKind({ kind: words, needed: rules.KINDS[wanted].words, taker })}`);
}
