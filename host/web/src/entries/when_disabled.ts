// Acts once on a board that has started and that this page drives.

import { State } from "../link/schema";
import type { Session } from "../session/session";

export function whenDisabled(session: Session, act: () => Promise<void>): void {
  let begun = false;
  session.changed.on(() => {
    if (begun || !session.driver.you || session.status?.state !== State.is.disabled) return;
    begun = true;
    void act();
  });
}

/** Enables a simulated arm, near which nobody stands, unless its motors were on before: who stopped them meant it. */
export function letFollow(session: Session): void {
  let begun = false;
  session.changed.on(() => {
    const { driver, status, samples, stopsAsked } = session;
    if (begun || !driver.you || status?.state !== State.is.disabled || !samples.end) return; // samples come with those of before
    begun = true;
    const first = Math.max(samples.first, 0);
    const was = Array.from({ length: samples.end - first }, (_, row) => samples.state[(first + row) % samples.capacity]);
    if (!stopsAsked && was.every((state) => state === State.is.disabled)) void session.attempt(() => session.enable());
  });
}
