// controller.toml: four joints' sets and gains as a person writes them, in raw values as a board stores them.

import { LinkError, type Parameter } from "../link/declared";
import { TABLE } from "../link/schema";
import type { NamedText } from "../parts/named_text";
import { isTable, require } from "./check";
import { inFile, rawOf } from "./raw_value";
import { CONTROLLER, tooSmallInFile } from "./rules";
import type { Schema } from "./schema_types";
import { readToml, refuseOtherKind } from "./toml";
import type { Path, Toml } from "./toml_types";
import { keyPath, short } from "./words";

/** A number of a file that a board stores, in the file's unit, of which the parameter's is so much less. */
type Stored = { readonly path: Path; readonly parameter: Parameter; readonly value: number; readonly scale: number };

/** Raw values by parameter name, for everything that a controller file says; an error is the host's sentence. */
export function controllerIn(file: NamedText): ReadonlyMap<string, number> {
  const { name } = file;
  const data = readToml(file);
  try {
    require(data, CONTROLLER, name);
  } catch (error) {
    refuseOtherKind(data, name, "controller");
    throw error;
  }
  const raw = new Map<string, number>();
  const found = [...storedIn(data, CONTROLLER, [])];
  for (const { parameter, value, scale } of found) {
    raw.set(parameter.name, inFile(name, () => rawOf(parameter, scale * value)));
  }
  for (const { path, parameter, value, scale } of found) {
    if (path[0] !== "joint" || !value || raw.get(parameter.name)) continue;
    const key = `${keyPath(path.slice(0, 2))}.${path.at(-1)!}`;
    throw new LinkError(`${name}: ${tooSmallInFile({ key, value: short(value), least: short(parameter.lsb / scale) })}`);
  }
  return raw;
}

/** Every number of a sound file for which there is a parameter, also one that the file leaves to its default. */
function* storedIn(value: Toml | undefined, schema: Schema, path: Path): Generator<Stored> {
  const { parameter, scale = 1, properties, prefixItems, items } = schema;
  if (parameter) {
    const [given, joint] = [value ?? schema.default, path.find((part) => typeof part === "number")];
    if (given === undefined) return;
    yield { path, parameter: TABLE.named(parameter.replace("{}", String(joint))), value: Number(given), scale };
  } else if (Array.isArray(value)) {
    for (const [place, one] of (value as readonly Toml[]).entries()) {
      yield* storedIn(one, prefixItems?.[place] ?? items!, [...path, place]);
    }
  } else if (isTable(value)) {
    for (const [key, inside] of Object.entries(properties ?? {})) yield* storedIn(value[key], inside, [...path, key]);
  }
}
