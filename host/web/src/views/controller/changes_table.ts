// What a tuning changed: the factors of every joint before and after, how many corners of sets moved, and the error.

import { el, tableHead } from "../../parts/dom";
import { SET_NAMES, type FactorName } from "../../session/law";
import type { Tuned } from "../../session/services";
import { ofRows } from "./draft";
import { changeOf, pairOf, told } from "./numbers";

const FACTORS: readonly FactorName[] = ["kp", "kd", "ki", "ku_mv"];
const MRAD = 1000; // in a rad

export function changesTable({ before, after, mse }: Tuned): HTMLElement {
  const [old, found] = [ofRows(before), ofRows(after)];
  const rows = found.map((settings, joint) => {
    const was = old[joint]!;
    const moved = SET_NAMES.filter((name) => settings[name] !== was[name]).length;
    const error = mse.length ? pairOf(...(mse.map((row) => MRAD * Math.sqrt(row[joint]!)) as [number, number]), 1, "") : "–";
    return el("tr", {}, el("th", { attrs: { scope: "row" } }, String(joint)),
      ...[error, ...FACTORS.map((name) => changeOf(name, was[name], settings[name])), `${moved} of ${SET_NAMES.length}`]
        .map((text) => el("td", {}, text)));
  });
  const titles = FACTORS.map((name) => `${told(name).label}, ${told(name).unit}`);
  return el("div", { class: "scroll", attrs: { tabindex: "0", role: "region", "aria-label": "What the tuning changed" } },
    el("table", {}, tableHead("joint", "error, mrad rms", ...titles, "corners moved"), el("tbody", {}, ...rows)));
}
