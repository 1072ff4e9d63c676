// controller.toml: four joints' sets and gains as a person writes them, checked as greywhale/files/controller.py does, in
// raw values as a board stores them.

import { cornerRange, FACTOR_NAMES, SET_NAMES, SET_UNIT, type SetName } from "../session/law";
import { LinkError, type Parameter } from "../link/declared";
import { upperFirst } from "../link/refusal";
import { TABLE } from "../link/schema";
import type { NamedText } from "../parts/named_text";
import { JOINTS } from "../session/samples";
import { anyTable, list, number, require, table, text, whole, type Shape } from "./check";
import type { Toml, TomlTable } from "./toml_types";
import { inFile, rawOf } from "./raw_value";
import { readToml, refuseOtherKind } from "./toml";
import { short } from "./words";

const MV = 1000; // in a volt: a file has ku in V
const OF_A_JOINT = ["speed_per_volt", "time_constant", "breakaway_volts"] as const;
const OF_THE_ARM = ["gravity_1", "gravity_12", "gravity_2"] as const;

const paperName = upperFirst; // of a corner: Ne_c
const keyOf = (name: string): string => (name === "ku_mv" ? "ku" : name);

/** One number of a joint: its key in the file, its parameter, and its value in the parameter's unit and in the file's. */
type Entry = { readonly key: string; readonly parameter: Parameter; readonly value: number; readonly scale: number };

function entries(found: TomlTable, joint: number): Entry[] {
  const sets = found["sets"] as TomlTable;
  const entry = (name: string, key: string, given: Toml | undefined): Entry => {
    const scale = key === "ku" ? MV : 1;
    return { key, parameter: TABLE.named(`joint${joint}.${name}`), value: scale * Number(given ?? 1), scale };
  };
  return [
    ...FACTOR_NAMES.map((name) => entry(name, keyOf(name), found[keyOf(name)])),
    ...SET_NAMES.map((name) => entry(name, paperName(name), sets[paperName(name)])),
  ];
}

/** The fault of a joint's numbers for the firmware. */
function unfit(found: TomlTable): string {
  for (const { key, parameter: { minimum, maximum, lsb }, value, scale } of entries(found, 0)) {
    const [low, high] = [minimum * lsb, maximum * lsb];
    if (!(value >= low && value <= high)) {
      return `${key} is ${short(key === "ku" ? Number(found[key]) : value)}, but it must lie within ${short(low / scale)}..${short(high / scale)}`;
    }
  }
  return "";
}

function corner(name: SetName): Shape {
  // The narrowest flank is 0.01, which the board stores rounded up.
  const [low, high] = cornerRange(name).map((raw) => Math.trunc((100 * raw) / SET_UNIT) / 100) as [number, number];
  return number(low, high);
}

const SETS = table(Object.fromEntries(SET_NAMES.map((name) => [paperName(name), corner(name)])));
const JOINT = table({ kp: number(), kd: number(), ki: number(), ku: number(), ce_ticks: whole, sets: SETS }, ["ce_ticks"], unfit);
const FOUR = list(JOINTS, number(), false);
const TRAVEL = table(Object.fromEntries([...OF_A_JOINT.map((key) => [key, FOUR]), ...OF_THE_ARM.map((key) => [key, number()])]));

function stallVolts(): Shape {
  const { minimum, maximum, lsb } = TABLE.named("stall_volts");
  const [low, high] = [minimum * lsb, maximum * lsb];
  return number(low, high, `it must lie within ${short(low)}..${short(high)} V`);
}

const FILE = table(
  { source: text, stall_volts: stallVolts(), travel: TRAVEL, joint: list(JOINTS, JOINT, true), tuning: anyTable },
  ["source", "stall_volts", "travel", "tuning"],
);

/** Raw values by parameter name, for everything that a controller file says; an error is the host's sentence. */
export function controllerIn(file: NamedText): ReadonlyMap<string, number> {
  const { name } = file;
  const data = readToml(file);
  try {
    require(data, FILE, name);
  } catch (error) {
    refuseOtherKind(data, name, "controller");
    throw error;
  }
  const raw = new Map<string, number>();
  for (const [parameter, value] of others(data)) raw.set(parameter.name, inFile(name, () => rawOf(parameter, value)));
  (data["joint"] as readonly TomlTable[]).forEach((found, joint) => entries(found, joint).forEach(({ key, parameter, value, scale }) => {
    const stored = inFile(name, () => rawOf(parameter, value));
    if (!stored && value) {
      throw new LinkError(`${name}: joint[${joint}].${key} is ${short(value / scale)}, which the board would store as 0; `
        + `give 0, or at least ${short(parameter.lsb / scale)}.`);
    }
    raw.set(parameter.name, stored);
  }));
  return raw;
}

/** The values that are not in a controller: the travel of each joint for a voltage. */
function others(data: TomlTable): [Parameter, number][] {
  const travel = data["travel"] as TomlTable | undefined;
  const found: [Parameter, Toml][] = data["stall_volts"] === undefined ? [] : [[TABLE.named("stall_volts"), data["stall_volts"]]];
  if (travel) {
    for (const key of OF_A_JOINT) {
      (travel[key] as readonly Toml[]).forEach((value, joint) => found.push([TABLE.named(`joint${joint}.${key}`), value]));
    }
    for (const key of OF_THE_ARM) found.push([TABLE.named(key), travel[key]!]);
  }
  return found.map(([parameter, value]) => [parameter, Number(value)]);
}
