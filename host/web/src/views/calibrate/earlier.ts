// The calibrations that a board has had, the newest first, each with its date, what it changed, and a way back to it.

import { CALIBRATION } from "../../files/rules";
import { TABLE } from "../../link/schema";
import { button, el } from "../../parts/dom";
import type { KeptCalibration } from "../../session/services";

const WHY: Readonly<Record<string, string>> = { found: "as the board was found", page: "calibrated here", back: "gone back to", set: "parameters changed" };

/** `back` is called with the one that a person wants again; each button is given out, to be made grey. */
export function earlierList(kept: readonly KeptCalibration[], back: (one: KeptCalibration) => void, given: (made: HTMLButtonElement) => void): HTMLElement {
  const items = [...kept].reverse().map((one, at) => {
    const when = new Date(one.when).toLocaleString();
    const title = `${one.number}: ${when}, ${WHY[one.why] ?? `greywhale ${one.why}`}`;
    const again = at && Object.keys(one.values).length ? [button("Go back", () => back(one), { attrs: { "aria-label": `Go back to calibration ${one.number}` } })] : [];
    again.forEach(given);
    return el("li", {}, el("div", { class: "row" }, el("span", {}, at ? title : `${title} (the newest)`), ...again),
      ...one.changed.map((line) => el("div", { class: "quiet" }, line)));
  });
  return el("details", { class: "earlier" }, el("summary", {}, `Earlier calibrations (${kept.length})`), el("ul", {}, ...items));
}

/** True if two whole sets read the same angles and turn the motors the same way. */
export function haveSameCalibration(one: readonly number[], other: readonly number[]): boolean {
  return CALIBRATION.map((name) => TABLE.named(name).index).every((index) => one[index] === other[index]);
}

/** The set `running` with the calibration of `one`: everything else stays. */
export function withCalibration(running: readonly number[], { values }: KeptCalibration): readonly number[] {
  const raw = [...running];
  for (const [name, value] of Object.entries(values)) raw[TABLE.named(name).index] = value;
  return raw;
}
