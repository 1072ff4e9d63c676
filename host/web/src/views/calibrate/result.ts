// What a calibration would change, in tables: potentiometers, joints and motors, before and after.

import { fixed } from "../../files/words";
import { potName, upperFirst } from "../../link/refusal";
import { el, tableHead } from "../../parts/dom";
import { COUNT14_PER_COUNT, FULL_SCALE, potParameter, potsOf } from "../../session/pots";
import { JOINT_NAMES } from "../../session/samples";
import type { Motor } from "./rules";
import type { Found } from "./walk";

const degrees = (angle: number): number => (180 / Math.PI) * angle;
const row = (name: string, ...cells: readonly string[]): HTMLElement =>
  el("tr", {}, el("th", { attrs: { scope: "row" } }, name), ...cells.map((cell) => el("td", {}, cell)));

/** A motor's way in words. */
export function motorInWords(motor: Motor | undefined): string {
  if (!motor) return "not tried, stays as it is";
  return `${motor.sign > 0 ? "turns as it should" : "turned the wrong way, motor_sign is changed"} (${fixed(motor.volts, 1)} V)`;
}

export function foundTables(found: Found, joints: readonly number[], motors: ReadonlyMap<number, Motor>): HTMLElement {
  const table = (head: readonly string[], rows: readonly HTMLElement[]): HTMLElement =>
    el("table", {}, tableHead(...head), el("tbody", {}, ...rows));
  return el("div", { class: "scroll", attrs: { tabindex: "0", role: "region", "aria-label": "What changes" } },
    table(["potentiometer", "zero, counts", "track, degrees", "direction"], potsOf(joints).map((pot) => potRow(pot, found))),
    table(["joint", "limits, degrees", "the arms differ by", "motor"], joints.map((joint) => {
      const [low, high] = found.calibration.limits[joint]!.map((end) => fixed(degrees(end), 0));
      return row(`${joint} ${JOINT_NAMES[joint]!}`, `${low} to ${high}`, `${fixed(1000 * found.apart[joint]!, 0)} mrad`, motorInWords(motors.get(joint)));
    })));
}

function potRow(pot: number, { before, after }: Found): HTMLElement {
  const [zero, scale] = [potParameter(pot, "zero"), potParameter(pot, "scale")];
  const change = (show: (raw: readonly number[]) => string): string => {
    const [was, is] = [show(before), show(after)];
    return was === is ? is : `${was} → ${is}`;
  };
  return row(upperFirst(potName(pot)).replace(" potentiometer", ""),
    change((raw) => fixed(raw[zero.index]! / COUNT14_PER_COUNT, 1)),
    change((raw) => fixed(degrees(Math.abs(raw[scale.index]!) * scale.lsb * FULL_SCALE * COUNT14_PER_COUNT), 1)),
    change((raw) => (raw[scale.index]! > 0 ? "as the joint" : "reversed")));
}
