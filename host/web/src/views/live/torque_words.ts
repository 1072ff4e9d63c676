// Torques from outside and contacts as a person reads them.

import type { ContactNow, JointTorque } from "../../session/services";

/** A joint's torque with its interval, or the reason why it cannot be told; a contact in any case. */
export function torqueText({ torque_nm, half_width_nm, why, contact }: JointTorque): string {
  if (contact) return `contact ${signed(torque_nm)}`;
  return why || `${signed(torque_nm)} ±${half_width_nm.toFixed(2)}`;
}

/** A contact in a sentence: that it began, or how it was. */
export function contactText({ joint, torque_nm, lasted_s, lasts }: ContactNow, seconds: number): string {
  const where = `joint ${joint} at ${seconds.toFixed(2)} s`;
  return lasts ? `Contact: ${where}.` : `Last contact: ${where}, up to ${signed(torque_nm)} N m, for ${lasted_s.toFixed(2)} s.`;
}

function signed(torque: number): string {
  return `${torque < 0 ? "" : "+"}${torque.toFixed(2)}`;
}
