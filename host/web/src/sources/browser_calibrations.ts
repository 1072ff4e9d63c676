// The calibrations of a page's own board, where no host keeps them: in this browser, a list that only grows.

import { CALIBRATION } from "../files/rules";
import { TABLE } from "../link/schema";
import type { Store } from "../parts/storage";
import type { Calibrations, KeptCalibration } from "../session/services";

type Entry = Pick<KeptCalibration, "when" | "why" | "values">;

const DIGITS = 5; // of a value

export class BrowserCalibrations implements Calibrations {
  /** `key` tells one kind of board from another: a browser does not say which board is at a port. */
  constructor(private readonly store: Store, private readonly key: string) {}

  async list(): Promise<readonly KeptCalibration[]> {
    const entries = this.entries();
    return entries.map((entry, at) => ({ ...entry, number: at + 1, changed: at ? changesOf(entries[at - 1]!, entry) : [] }));
  }

  async keep(raw: readonly number[], _board: number, why: Entry["why"]): Promise<void> {
    const entries = this.entries();
    const values = Object.fromEntries(CALIBRATION.map((name) => [name, raw[TABLE.named(name).index]!]));
    const entry = { when: new Date().toISOString(), why, values };
    const newest = entries.at(-1);
    if (newest && !changesOf(newest, entry).length) return;
    this.store.write(this.key, JSON.stringify([...entries, entry])); // a browser that keeps nothing must not hold a person back
  }

  private entries(): readonly Entry[] {
    const text = this.store.read(this.key);
    if (text === null) return [];
    const found = entriesIn(text);
    if (found) return found;
    this.store.move(this.key, `${this.key}-damaged`);
    return [];
  }
}

/** The list in a text that the browser kept; null where somebody has damaged it. */
function entriesIn(text: string): readonly Entry[] | null {
  try {
    const found = JSON.parse(text) as readonly Entry[];
    const whole = found.every(({ when, why, values }) => !Number.isNaN(Date.parse(when)) && typeof why === "string"
      && CALIBRATION.every((name) => Number.isInteger(values[name])));
    return whole ? found : null;
  } catch {
    return null;
  }
}

function changesOf(before: Entry, after: Entry): readonly string[] {
  return CALIBRATION.filter((name) => before.values[name] !== after.values[name]).map((name) => {
    const { lsb, unit } = TABLE.named(name);
    const [was, is] = [before, after].map(({ values }) => Number((values[name]! * lsb).toPrecision(DIGITS)));
    return `${name} ${was} to ${is}${unit && ` ${unit}`}`;
  });
}
