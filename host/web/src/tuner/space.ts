// The box that is searched, and the settings of the board at each of its points (greywhale/tune/search/space.py).

import type { Row, SearchData, Variable } from "./data";
import { clip, type Bounds, type Elementary } from "./wolf_whale";

export class Space {
  readonly bounds: Bounds;

  constructor(
    private readonly search: SearchData, private readonly variables: readonly Variable[], readonly reduced: boolean,
    private readonly math: Elementary,
  ) {
    this.bounds = variables.map(({ bounds }) => bounds);
  }

  /** The settings of a point; `base` has those that are not searched. */
  row(point: readonly number[], base: Row): Row {
    const row = [...base];
    if (this.reduced) for (const { column, raw } of this.search.stretch) row[column] = raw;
    this.variables.forEach((variable, place) => {
      const raw = this.raw(variable, point[place]!);
      row[variable.column] = raw;
      if (variable.mirror !== null) row[variable.mirror] = -raw;
    });
    return row;
  }

  private raw({ sign, unit, is_set, logarithmic, offset }: Variable, x: number): number {
    const { least_width, set_unit } = this.search;
    const raw = Math.max(rint((logarithmic ? this.math.exp(x) - offset : sign * x) * unit), 0);
    return sign * (is_set ? clip(raw, least_width, set_unit) : raw);
  }

  /** The point of settings, moved into the box where they lie outside. */
  point(row: Row): number[] {
    const stretched = this.reduced ? this.restretched(row) : row;
    return this.variables.map(({ column, unit, logarithmic, offset, bounds: [low, high] }) => {
      const value = stretched[column]! / unit;
      return clip(logarithmic ? this.math.log(Math.max(Math.abs(value) + offset, 1e-9)) : value, low, high);
    });
  }

  /** An equal law with the gains that are held fast: the sets are stretched instead. */
  private restretched(row: Row): Row {
    const { stretch, least_width, set_unit } = this.search;
    const stretched = [...row];
    for (const { column, raw, sets } of stretch) {
      const factor = raw / Math.max(row[column]!, 1);
      for (const set of sets) stretched[set] = Math.sign(row[set]!) * clip(Math.abs(row[set]!) * factor, least_width, set_unit);
      stretched[column] = raw;
    }
    return stretched.map(rint);
  }
}

/** The nearest whole number, of two as near the even one. */
export function rint(value: number): number {
  const low = Math.floor(value);
  const part = value - low;
  return part < 0.5 || (part === 0.5 && low % 2 === 0) ? low : low + 1;
}
