// Acts once on a board that has started and that this page drives.

import { State } from "../link/schema";
import type { Session } from "../session/session";

export function whenDisabled(session: Session, act: () => Promise<void>, ready = (): boolean => true): void {
  let begun = false;
  session.changed.on(() => {
    if (begun || !session.driver.you || session.status?.state !== State.is.disabled || !ready()) return;
    begun = true;
    void act();
  });
}

/** Enables a simulated arm, near which nobody stands, unless its motors were on before: who stopped them meant it. */
export function letFollow(session: Session): void {
  whenDisabled(session, async () => {
    const { samples, stopsAsked } = session;
    const first = Math.max(samples.first, 0);
    const was = Array.from({ length: samples.end - first }, (_, row) => samples.state[(first + row) % samples.capacity]);
    if (!stopsAsked && was.every((state) => state === State.is.disabled)) await session.attempt(() => session.enable());
  }, () => session.samples.end !== 0); // samples come with those of before
}
