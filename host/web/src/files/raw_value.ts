// Numbers that a person gave, as a board stores them; whatever is wrong is the host's sentence.

import { LinkError, type Parameter } from "../link/declared";
import { short } from "./words";

/** The nearest raw value in range. */
export function rawOf({ name, lsb, unit, minimum, maximum, nonzero }: Parameter, value: number): number {
  const of = unit && ` ${unit}`;
  const advice = `choose a value from ${short(minimum * lsb)} to ${short(maximum * lsb)}${of}${nonzero ? ", other than 0" : ""}.`;
  if (!Number.isFinite(value)) throw new LinkError(`${name} is ${short(value)}, but it must be a finite number; ${advice}`);
  const raw = Math.floor(value / lsb + 0.5);
  if (raw >= minimum && raw <= maximum && (raw || !nonzero)) return raw;
  throw new LinkError(`${name} is ${short(value)}${of}, which is out of range; ${advice}`);
}

/** A raw value, refused where rounding would change it noticeably. */
export function rawAsGiven(parameter: Parameter, value: number): number {
  const raw = rawOf(parameter, value);
  const { name, lsb, unit } = parameter;
  const of = unit && ` ${unit}`;
  if (lsb === 1 && raw !== value) throw new LinkError(`${name} is ${short(value)}${of}, but it must be a whole number.`);
  if (!raw && value) {
    throw new LinkError(`${name} is ${short(value)}${of}, which the board would store as 0; choose 0, or a size from ${short(lsb)}${of}.`);
  }
  return raw;
}

/** The result of `act`; its sentence begins with the file's name. */
export function inFile<Value>(file: string, act: () => Value): Value {
  try {
    return act();
  } catch (error) {
    if (error instanceof LinkError) throw new LinkError(`${file}: ${error.message}`);
    throw error;
  }
}
