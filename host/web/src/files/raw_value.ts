// Numbers that a person gave, as a board stores them; whatever is wrong is the host's sentence.

import { LinkError, type Parameter } from "../link/declared";
import { choose, chooseBut0, notWhole, outOfRange, parameterNotFinite, tooSmall } from "./rules";
import { short } from "./words";

/** The nearest raw value in range. */
export function rawOf(parameter: Parameter, value: number): number {
  const { name, lsb, minimum, maximum, nonzero } = parameter;
  const range = { least: short(minimum * lsb), most: shown(parameter, maximum * lsb) };
  const advice = nonzero ? chooseBut0(range) : choose(range);
  if (!Number.isFinite(value)) throw new LinkError(parameterNotFinite({ name, value: short(value), advice }));
  const raw = Math.floor(value / lsb + 0.5);
  if (raw >= minimum && raw <= maximum && (raw || !nonzero)) return raw;
  throw new LinkError(outOfRange({ name, value: shown(parameter, value), advice }));
}

/** A raw value, refused where rounding would change it noticeably. */
export function rawAsGiven(parameter: Parameter, value: number): number {
  const raw = rawOf(parameter, value);
  const { name, lsb } = parameter;
  if (lsb === 1 && raw !== value) throw new LinkError(notWhole({ name, value: shown(parameter, value) }));
  const least = shown(parameter, lsb);
  if (!raw && value) throw new LinkError(tooSmall({ name, value: shown(parameter, value), least }));
  return raw;
}

/** A value in words, with its unit. */
export function shown({ unit }: Parameter, value: number): string {
  return unit ? `${short(value)} ${unit}` : short(value);
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
