// The state of the page with a bench inside as its address carries it, behind # where no browser sends it anywhere:
// view, joint, the bench's conditions, and every parameter that differs from the firmware's default.

import { SIZES, type BenchControls, type BenchWish } from "../session/services";
import type { Parameter } from "../link/declared";
import { TABLE } from "../link/schema";
import { JOINTS } from "../session/samples";

export type PageState = {
  readonly view: string;
  readonly joint: number; // whose controller is shown
  readonly sizes: readonly BenchWish[]; // of the bench
  readonly acts: readonly BenchWish[]; // where the leader was led, and what was broken
  readonly raw: readonly number[]; // the whole parameter set
};

/** The fragment that names a state. */
export function fragmentOf({ view, joint, sizes, acts, raw }: PageState): string {
  const changed = TABLE.parameters.filter(({ index, initial }) => raw[index] !== initial);
  const pairs: [string, string][] = [
    ["view", view.toLowerCase()],
    ["joint", String(joint)],
    ...[...sizes, ...acts].flatMap((wish) => Object.entries(wish).map(([key, value]): [string, string] => [key, String(value)])),
    ...changed.map((one): [string, string] => [one.name, shortest(one, raw[one.index]!)]),
  ];
  return pairs.map(([key, value]) => `${key}=${value}`).join("&"); // names and numbers: nothing to escape
}

/** The state that a fragment names, null for an empty one; fails with a sentence where something in it is wrong. */
export function stateOf(fragment: string, views: readonly string[], controls: BenchControls): PageState | null {
  if (!fragment) return null;
  const readers = readersFor(views, controls);
  let state: PageState = { view: views[0]!, joint: 0, sizes: [], acts: [], raw: TABLE.parameters.map(({ initial }) => initial) };
  for (const [key, value] of new URLSearchParams(fragment)) {
    try {
      const read = readers.get(key);
      if (!read) throw new Error("the page knows no such word");
      state = read(value, state);
    } catch (remedy) {
      throw new Error(`The state in the address is set aside, for ${key} is "${value}": ${(remedy as Error).message}.`);
    }
  }
  return state;
}

type Reader = (text: string, state: PageState) => PageState;

function readersFor(views: readonly string[], controls: BenchControls): ReadonlyMap<string, Reader> {
  const act = (read: (text: string) => BenchWish): Reader => (text, state) => ({ ...state, acts: [...state.acts, read(text)] });
  const { minimum, maximum } = controls.leader;
  const readers = new Map<string, Reader>([
    ["view", (text, state) => ({ ...state, view: chosen(text, views) })],
    ["joint", (text, state) => ({ ...state, joint: Number(chosen(text, ["0", "1", "2", "3"])) })],
    ["leader", act((text) => ({ leader: fourNumbers(text).map((one, joint) => number(one, minimum[joint]!, maximum[joint]!)) }))],
    ["motion", act((text) => ({ motion: chosen(text, controls.motions.map(({ name }) => name)) }))],
    ["fault", act((text) => ({ fault: knownFault(text, controls) }))],
  ]);
  for (const size of SIZES) {
    const range = controls[size];
    if (!range) continue;
    readers.set(size, (text, state) => ({ ...state, sizes: [...state.sizes, { [size]: number(text, range.minimum, range.maximum) }] }));
  }
  for (const one of TABLE.parameters) {
    readers.set(one.name, (text, state) => ({ ...state, raw: replaced(state.raw, one.index, counted(text, one)) }));
  }
  return readers;
}

function replaced(values: readonly number[], at: number, value: number): number[] {
  return values.map((one, place) => (place === at ? value : one));
}

/** A value in the parameter's unit with no more digits than lead back to it. */
function shortest({ lsb }: Parameter, raw: number): string {
  for (let digits = 0; ; digits++) {
    const value = Number((raw * lsb).toFixed(digits));
    if (Math.round(value / lsb) === raw) return String(value);
  }
}

function counted(text: string, { lsb, minimum, maximum }: Parameter): number {
  const raw = text.trim() ? Math.round(Number(text) / lsb) : NaN;
  if (raw >= minimum && raw <= maximum) return raw;
  throw new Error(`choose a number from ${minimum * lsb} to ${maximum * lsb}`);
}

function number(text: string, minimum: number, maximum: number): number {
  const value = text.trim() ? Number(text) : NaN;
  if (value >= minimum && value <= maximum) return value;
  throw new Error(`choose a number from ${minimum} to ${maximum}`);
}

function chosen(text: string, words: readonly string[]): string {
  const found = words.find((word) => word.toLowerCase() === text);
  if (found !== undefined) return found;
  throw new Error(`choose ${words.join(", ").toLowerCase()}`);
}

function fourNumbers(text: string): string[] {
  const numbers = text.split(",");
  if (numbers.length === JOINTS) return numbers;
  throw new Error("give four angles in rad");
}

function knownFault(text: string, { faults }: BenchControls): string {
  const [name, place] = text.split(":");
  const found = faults.find((fault) => fault.name === name);
  if (found && (place === undefined ? !found.places.length : found.places.includes(place))) return text;
  throw new Error("choose one of those in the view Bench");
}
