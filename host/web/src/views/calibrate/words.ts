// What the page asks of a person in each step.

import { fixed } from "../../files/words";
import { potName, upperFirst } from "../../link/refusal";
import { JOINT_NAMES, JOINTS } from "../../session/samples";
import type { Rules } from "./rules";
import { AGAIN, FIRST, THIRD } from "./step";

const WHY = ["", "", " A potentiometer that slips on its shaft shows.", " It shows how far the arms are apart."] as const;

/** Leader joint 1, shoulder pitch. */
export function jointTitle(pot: number): string {
  return `${upperFirst(potName(pot)).replace(" potentiometer ", " joint ")}, ${JOINT_NAMES[pot % JOINTS]!}`;
}

/** Joints at angles in rad, as a person reads them. */
export function poseInWords(angles: readonly number[], joints: readonly number[]): string {
  if (joints.every((joint) => !angles[joint])) return "every joint at 0 (stretched out, level)";
  return joints.map((joint) => `joint ${joint} at ${fixed((180 / Math.PI) * angles[joint]!, 0)} degrees`).join(", ");
}

/** Asks for a pose; `known` is false where the second one may be any. */
export function poseAsked(place: number, first: string, known: boolean): string {
  if (place === AGAIN) return `Hold both arms once more in the first pose: ${first}.${WHY[place]}`;
  if (place === THIRD) return `Hold both arms in one and the same third pose, away from the other two.${WHY[place]}`;
  if (place === FIRST) return "Hold both arms still at these angles. At 0 an arm is stretched out and level.";
  return known ? "Hold both arms still at these angles, every joint at least 20 degrees from the first pose."
    : "Hold both arms in one and the same other pose, every joint at least 20 degrees from the first.";
}

export function motorsAsked(rules: Rules, supplyVolts: number): string {
  return "Each motor gets short weak pulses, of a tenth to a third of the supply. The board counts on "
    + `${supplyVolts} V: if the motors' supply has not, set supply_mv in Parameters first. ${rules.readyAsked()}`;
}
