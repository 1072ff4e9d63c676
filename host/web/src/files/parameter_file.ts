// The whole parameter table as TOML: what `greywhale params` backs up and restores.

import { LinkError } from "../link/declared";
import { TABLE } from "../link/schema";
import type { NamedText } from "../parts/named_text";
import { isNumber, isTable } from "./check";
import { physicalText } from "./log";
import type { Toml, TomlTable } from "./toml_types";
import { inFile, rawAsGiven, shown } from "./raw_value";
import { missingParameter, noNumber, notBelow, unknownKey } from "./rules";
import { readToml, refuseOtherKind } from "./toml";
import { advice, keyPath, quoted, short } from "./words";

/** Every parameter; those of no group come first, as TOML asks. */
export function parameterFile(raw: readonly number[]): string {
  const groups = new Map<string, string[]>([["", []]]);
  for (const parameter of TABLE.parameters) {
    const [name, group = ""] = parameter.name.split(".").reverse() as [string, string?];
    const lines = groups.get(group) ?? [`\n[${group}]`];
    groups.set(group, lines);
    lines.push(`${name} = ${physicalText(parameter, raw[parameter.index]!)}${parameter.unit && `  # ${parameter.unit}`}`);
  }
  const crc = TABLE.crc(raw).toString(16).padStart(4, "0");
  return `# greywhale parameters, CRC 0x${crc}\n\n${[...groups.values()].flat().join("\n")}\n`;
}

const NAMES = TABLE.parameters.map(({ name }) => name);

/** The raw values that a file states, by index: all of its own layout, which may be older. An error is the host's sentence. */
export function statedIn(given: NamedText): Map<number, number> {
  const { name: file } = given;
  const data = readToml(given);
  refuseOtherKind(data, file, "parameters");
  const found = flat(data);
  return inFile(file, () => {
    const unknown = [...found.keys()].find((name) => !NAMES.includes(name));
    if (unknown !== undefined) throw new LinkError(`${unknownKey({ key: keyPath([unknown]), advice: advice(unknown, NAMES) })}.`);
    const layout = TABLE.parameters.reduce((newest, { name, since }) => found.has(name) ? Math.max(newest, since) : newest, 1);
    const stated = new Map(TABLE.parameters.filter(({ since }) => since <= layout).map((parameter): [number, number] => {
      const { name } = parameter;
      const value = found.get(name);
      if (value === undefined) throw new LinkError(missingParameter({ name }));
      if (!isNumber(value)) throw new LinkError(noNumber({ name, value: quoted(value) }));
      return [parameter.index, rawAsGiven(parameter, Number(value))];
    }));
    requireOrder(TABLE.parameters.map(({ index, initial }) => stated.get(index) ?? initial));
    return stated;
  });
}

/** Values by parameter name: those of no group, and those of the groups' tables. */
function flat(data: TomlTable): ReadonlyMap<string, Toml> {
  return new Map(Object.entries(data).flatMap(([key, value]): [string, Toml][] =>
    isTable(value) ? Object.entries(value).map(([name, inside]) => [`${key}.${name}`, inside]) : [[key, value]]));
}

function requireOrder(raw: readonly number[]): void {
  for (const { name, index, lsb, below } of TABLE.parameters) {
    if (!below) continue;
    const other = TABLE.named(below);
    if (raw[index]! < raw[other.index]!) continue;
    const most = shown(other, raw[other.index]! * other.lsb);
    throw new LinkError(notBelow({ name, value: short(raw[index]! * lsb), other: below, most }));
  }
}
