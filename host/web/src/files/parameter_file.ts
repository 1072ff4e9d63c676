// The whole parameter table as TOML, as greywhale/files/parameter_file.py writes and reads it.

import { TABLE } from "../link/schema";
import { physicalText } from "../samples/log";

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
