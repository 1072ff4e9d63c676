// The model's prediction of each trial of a commissioning, beside what was measured on the arm.

import { el, select, tableHead } from "../../parts/dom";
import type { Json } from "../../session/services";

/** The way to show each measure of a part of the check. */
const MEASURES = {
  error: { unit: "mrad rms", size: (squared: number) => 1000 * Math.sqrt(squared), digits: 1 },
  unrest: { unit: "mrad rms", size: (rad: number) => 1000 * rad, digits: 2 },
  rattle: { unit: "mrad rms", size: (rad: number) => 1000 * rad, digits: 2 },
  chatter: { unit: "1/s", size: (value: number) => value, digits: 1 },
  ripple: { unit: "V rms", size: (value: number) => value, digits: 2 },
  voltage: { unit: "V", size: (value: number) => value, digits: 2 },
  overshoot: { unit: "%", size: (value: number) => value, digits: 1 },
  settling: { unit: "s", size: (value: number) => value, digits: 2 },
} as const;
type Measure = keyof typeof MEASURES;
const NAMES = Object.keys(MEASURES) as Measure[];

type Parts = { readonly [part: string]: { readonly [measure in Measure]: readonly (number | null)[] } };
export type Trial = { readonly trial: string; readonly predicted: Parts; readonly measured: Parts };

/** The trials in a result, none where it is another verb's. */
export function trialsIn(result: { readonly [key: string]: Json }): readonly Trial[] {
  const { trials } = result;
  const known = (Array.isArray(trials) ? trials : []) as readonly Partial<Trial>[];
  return known.filter((one): one is Trial => one.trial !== undefined && !!one.predicted && !!one.measured);
}

/** A measure of every joint in a part of the check, by trials. */
export function predictedBeside(trials: readonly Trial[]): HTMLElement {
  const parts = Object.keys(trials[0]!.measured);
  const joints = trials[0]!.measured[parts[0]!]!.error.map((_, joint) => joint);
  const body = el("tbody");
  const unit = el("span", { class: "quiet" });
  let part = parts[0]!;
  let name: Measure = "error";
  const text = (all: Parts, joint: number): string => {
    const value = all[part]?.[name]?.[joint];
    return typeof value === "number" ? MEASURES[name].size(value).toFixed(MEASURES[name].digits) : "–";
  };
  const show = (): void => {
    unit.textContent = `${MEASURES[name].unit}, predicted / measured`;
    body.replaceChildren(...trials.map(({ trial, predicted, measured }) =>
      el("tr", {}, el("th", { attrs: { scope: "row" } }, trial), ...joints.map((joint) =>
        el("td", {}, `${text(predicted, joint)} / ${text(measured, joint)}`)))));
  };
  show();
  return el("div", { class: "scroll beside", attrs: { tabindex: "0", role: "region", "aria-label": "Predicted and measured" } },
    el("div", { class: "row" },
      select("Measure", NAMES.map((one) => [one, one] as const), (one) => { name = one; show(); }),
      select("Part of the check", parts.map((one) => [one, `in ${one}`] as const), (one) => { part = one; show(); }),
      unit),
    el("table", {}, tableHead("trial", ...joints.map((joint) => `joint ${joint}`)), body));
}
