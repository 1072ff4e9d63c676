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
