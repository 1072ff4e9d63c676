// Instructions to a person, as the page gives them.

import { potName } from "../../link/refusal";
import { JOINT_NAMES, JOINTS } from "../../session/samples";
import type { Rules } from "./rules";

export const POSES = ["First pose", "Second pose", "First pose again", "Third pose"] as const;
export const POSES_ASKED = [
  "Hold both arms still with these angles of joint 0 to 3, in rad.",
  "Hold both arms still with these angles, each at least 0.3 rad from the first.",
  "Hold both arms once more in the first pose: a potentiometer that slips on its shaft shows.",
  "Hold both arms in one and the same other pose: it shows how far they are apart.",
] as const;

export function sweepAsked(rules: Rules, pot: number): string {
  const joint = `${potName(pot).replace(" potentiometer ", " joint ")}, ${JOINT_NAMES[pot % JOINTS]!}`;
  return `Now ${joint}: ${rules.turnAsked(pot % JOINTS)}`;
}

export function motorsAsked(rules: Rules): string {
  return `Each motor gets short weak pulses, of a tenth to a third of the supply that the board counts on (supply_mv). ${rules.readyAsked()}`;
}
