// A recording of a leader's motion: a log or a leader's file of greywhale, of which the times and the four angles are read.

import type { NamedText } from "../parts/named_text";
import { JOINTS } from "../session/samples";

const COLUMNS = ["time_s", ...Array.from({ length: JOINTS }, (_, joint) => `leader_${joint}`)];
const AT_ONCE = 4000; // lines, which take some milliseconds

export type Recording = { readonly name: string; readonly times: readonly number[]; readonly rows: readonly (readonly number[])[] };

/** Reads a recording, piece by piece: `pause` lets the page do all else. Fails with a sentence where something in it is wrong. */
export async function readRecording({ name, text }: NamedText, pause: () => Promise<void>): Promise<Recording> {
  const lines = text.split("\n");
  let places: readonly number[] | null = null;
  const times: number[] = [];
  const rows: number[][] = [];
  for (const [number, line] of lines.entries()) {
    if (number % AT_ONCE === AT_ONCE - 1) await pause();
    if (!line.trim() || line.startsWith("#")) continue;
    const cells = line.split(",").map((cell) => cell.trim());
    if (!places) {
      places = COLUMNS.map((column) => cells.indexOf(column));
      const missing = places.indexOf(-1);
      if (missing >= 0) throw new Error(`${name} has no column ${COLUMNS[missing]}; choose a log or a leader's motion of greywhale.`);
      continue;
    }
    const wrong = places.findIndex((place) => !cells[place] || !Number.isFinite(Number(cells[place])));
    if (wrong >= 0) throw new Error(`${name}, line ${number + 1}: "${cells[places[wrong]!] ?? ""}" is no number for ${COLUMNS[wrong]}; correct it.`);
    const [time, ...angles] = places.map((place) => Number(cells[place]));
    if (times.length && time! <= times.at(-1)!) throw new Error(`${name}, line ${number + 1}: time_s does not grow; put the rows in order.`);
    times.push(time!);
    rows.push(angles);
  }
  if (times.length < 2) throw new Error(`${name} holds no motion; choose a file with two or more rows.`);
  return { name, times, rows };
}

/** The angles so many seconds after the first row; null behind the last one. */
export function poseIn({ times, rows }: Recording, seconds: number): readonly number[] | null {
  const time = times[0]! + seconds;
  if (time > times.at(-1)!) return null;
  let [low, high] = [0, times.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle]! <= time) low = middle;
    else high = middle;
  }
  const share = (time - times[low]!) / (times[high]! - times[low]!);
  return rows[low]!.map((angle, joint) => angle + share * (rows[high]![joint]! - angle));
}
