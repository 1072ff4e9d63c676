// Writes samples as a log that every greywhale verb reads: CSV under a commented header with a check over all rows.

import { Board, type HelloReply, State, TABLE } from "../link/schema";
import type { Parameter } from "../link/declared";
import { crc32 } from "../link/crc32";
import { JOINTS, TICKS_A_SECOND, type Samples } from "../session/samples";
import { EPISODE, LOG } from "./rules";

/** The header's facts on the origin of the samples; `raw` is the board's parameter table, null when it is not read. */
export type Origin = { readonly hello: HelloReply | null; readonly raw: readonly number[] | null };

/** What a log is an episode of, and why it ended early, "" where it did not. */
export type Episode = { readonly task: string; readonly cause: string };

/** The name of the episode after those among these names. */
export function nextEpisode(names: readonly string[]): string {
  const { prefix, digits, suffix } = LOG.episode;
  const numbers = names.map((name) => Number(EPISODE.exec(name)?.[1] ?? -1));
  return `${prefix}${String(Math.max(-1, ...numbers) + 1).padStart(digits, "0")}${suffix}`;
}

/** The log of the samples from `from` to before `to`. */
export function logText(samples: Samples, from: number, to: number, origin: Origin, episode: Episode = { task: "", cause: "" }): string {
  const rows = Array.from({ length: to - from }, (_, i) => row(samples, from + i));
  const body = rows.join("");
  const facts = headerFacts(samples, from, to, origin, episode.cause);
  const covered = [...facts].sort(([a], [b]) => (a < b ? -1 : 1)).map(([key, value]) => `${key}: ${value}\n`).join("");
  const check = crc32(covered, crc32(body)).toString(16).padStart(8, "0");
  const header = facts.map(([key, value]) => `# ${key}: ${value}\n`).join("");
  // The check leaves the task out. JSON in ASCII, as the host writes it.
  const words = JSON.stringify(episode.task).replace(/[\u0080-\uffff]|[,;|](?="$)/g, (letter) => `\\u${letter.charCodeAt(0).toString(16).padStart(4, "0")}`);
  const task = episode.task && `# ${LOG.task}: ${words}\n`;
  return `# ${LOG.title}\n${header}${task}# ${LOG.check}: ${rows.length} rows, crc32 ${check}\n${LOG.heading}\n${body}`;
}

function row(samples: Samples, number: number): string {
  const cells = LOG.quantities.flatMap(([name, digits]) =>
    Array.from({ length: JOINTS }, (_, joint) => samples.value(number, name, joint).toFixed(digits)));
  const time = (samples.timeOf(number) / TICKS_A_SECOND).toFixed(LOG.timeDigits);
  return `${time},${cells.join(",")},${State.of(samples.state[number % samples.capacity]!).name}\n`;
}

function headerFacts(samples: Samples, from: number, to: number, { hello, raw }: Origin, cause: string): [string, string][] {
  const facts: [string, string][] = [];
  if (hello) {
    facts.push(["firmware", `${hello.fw_major}.${hello.fw_minor}.${hello.fw_patch}`]);
    facts.push(["board", Board.of(hello.board).name]);
  }
  if (raw) {
    facts.push(["parameter_crc", `0x${TABLE.crc(raw).toString(16).padStart(4, "0")}`]);
    facts.push(["period_ms", String(raw[TABLE.named("period_ms").index])]);
  }
  facts.push(["every_ticks", "1"]);
  if (raw) facts.push(...tableLines(raw));
  const ticks = to > from ? samples.timeOf(to - 1) - samples.timeOf(from) + 1 : 0;
  facts.push(["dropped_samples", String(ticks - (to - from))], ["recording", cause ? LOG.interrupted : LOG.complete], ["ended_by", cause]);
  return facts;
}

function tableLines(raw: readonly number[]): [string, string][] {
  const groups = new Map<string, string[]>();
  for (const parameter of TABLE.parameters) {
    const dot = parameter.name.lastIndexOf(".");
    const key = dot < 0 ? LOG.parameters : `${LOG.parameters}.${parameter.name.slice(0, dot)}`;
    const line = groups.get(key) ?? [];
    groups.set(key, line);
    line.push(`${parameter.name.slice(dot + 1)}=${physicalText(parameter, raw[parameter.index]!)}`);
  }
  return [...groups].map(([key, values]) => [key, values.join(" ")]);
}

/** A value in the parameter's unit, with the digits that still tell neighbouring raw values apart. */
export function physicalText(parameter: Parameter, raw: number): string {
  if (parameter.lsb === 1) return String(raw);
  const digits = Math.max(0, 1 - Math.floor(Math.log10(parameter.lsb)));
  return String(Number((raw * parameter.lsb).toFixed(digits)));
}
