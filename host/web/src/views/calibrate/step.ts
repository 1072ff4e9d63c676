// The steps of a calibration, and what a page calls them.

import { potName, upperFirst } from "../../link/refusal";
import { JOINTS } from "../../session/samples";

export type Step =
  | { readonly kind: "sweep"; readonly pot: number }
  | { readonly kind: "pose"; readonly place: number }
  | { readonly kind: "motors" }
  | { readonly kind: "store" };

export const [FIRST, SECOND, AGAIN, THIRD] = [0, 1, 2, 3] as const;
const POSES = ["first pose", "second pose", "first pose again", "third pose"] as const;
const SHORT = ["First", "Second", "Again", "Third"] as const;

/** A step by its name, wherever it is spoken of. */
export function stepTitle(step: Step): string {
  switch (step.kind) {
    case "sweep": return `sweep of ${potName(step.pot).replace(" potentiometer ", " joint ")}`;
    case "pose": return POSES[step.place]!;
    case "motors": return "motors";
    case "store": return "store";
  }
}

/** The group of a step, and its name there. */
export function stepInGroup(step: Step): readonly [group: string, short: string] {
  if (step.kind === "sweep") return [`${step.pot < JOINTS ? "Leader" : "Follower"} sweeps`, String(step.pot % JOINTS)];
  return step.kind === "pose" ? ["Poses", SHORT[step.place]!] : ["Then", upperFirst(step.kind)];
}
