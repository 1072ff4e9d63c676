// Reads a TOML file; one of another kind than wanted is told by name, as greywhale/base/formats does.

import { parse, TomlError } from "smol-toml";
import { LinkError } from "../link/declared";
import { isTable, type Path, type Toml, type TomlTable } from "./check";
import { cut, keyPath } from "./words";

const DEEPEST = 24;

/** The content of a file: integers as bigint. */
export function readToml(text: string, name: string): TomlTable {
  let data: TomlTable;
  try {
    data = parse(text, { integersAsBigInt: true, maxDepth: DEEPEST }) as TomlTable;
  } catch (error) {
    if (!(error instanceof TomlError)) throw error;
    const first = text.split("\n").find((line) => line.trim() && !line.startsWith("#")) ?? "";
    const why = first.startsWith("time_s,") ? "this is a log or a motion (CSV)"
      : `${cut(error.message.split("\n")[0]!.replace("Invalid TOML document: ", ""), 200)} (at line ${error.line}, column ${error.column})`;
    throw new LinkError(`${name}: not valid TOML: ${why}.`);
  }
  if (!Object.keys(data).length) {
    throw new LinkError(`${name}: it is empty${text.trim() ? ", but for comments" : ""}; choose another file.`);
  }
  refuseOddNumbers(data, [], name);
  return data;
}

function refuseOddNumbers(value: Toml, path: Path, name: string): void {
  if (typeof value === "number" && !Number.isFinite(value)) {
    const words = Number.isNaN(value) ? "nan" : value > 0 ? "inf" : "-inf";
    throw new LinkError(`${name}: ${keyPath(path)} is ${words}; it must be a finite number.`);
  }
  if (Array.isArray(value)) (value as readonly Toml[]).forEach((one, place) => refuseOddNumbers(one, [...path, place], name));
  else if (isTable(value)) for (const [key, one] of Object.entries(value)) refuseOddNumbers(one, [...path, key], name);
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
