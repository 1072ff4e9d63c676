// Instructions to a person: joints by name, and which way of each is positive: greywhale/board/calibrate/words.py.

import { potName } from "../../link/refusal";
import { JOINT_NAMES } from "../../session/samples";

const POSITIVE_WAYS = [
  "counter-clockwise, seen from above",
  "up: the hand rises",
  "up: the hand rises, while the upper arm is level",
  "clockwise, seen from the elbow along the hand",
];

export const POSES = ["First pose", "Second pose", "First pose again", "Third pose"] as const;
export const POSES_ASKED = [
  "Hold both arms still with these angles of joint 0 to 3, in rad.",
  "Hold both arms still with these angles, each at least 0.3 rad from the first.",
  "Hold both arms once more in the first pose: a potentiometer that slips on its shaft shows.",
  "Hold both arms in one and the same other pose: it shows how far they are apart.",
] as const;

export function sweepAsked(pot: number): string {
  const joint = `${potName(pot).replace(" potentiometer ", " joint ")}, ${JOINT_NAMES[pot % 4]!}`;
  return `Now ${joint}: turn it, and no other, slowly to its positive end (${POSITIVE_WAYS[pot % 4]!}), then to its negative end, `
    + "and let it rest.";
}

export const MOTORS_ASKED = "Each motor gets short weak pulses, of a tenth to a third of the supply that the board counts on (supply_mv). "
  + "Let the follower hang or lie so that every joint can move by 20 degrees to both sides, switch the motors' supply on, and keep a hand on its switch.";
