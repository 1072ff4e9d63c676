// The interface of a board that a person connects by hand: open its port, let it go, flash it.

import type { NamedText } from "../parts/named_text";

/** The progress of something long: its step, and the share that is done. */
export type Report = (stage: string, share: number) => void;

export interface BoardPort {
  /** The reason why this browser reaches no port, in a sentence; empty where it does. */
  readonly missing: string;
  /** Opens the port that was chosen last, or lets the person choose; `restart` restarts the board for sure. */
  connect(how: { readonly restart: boolean; readonly choose: boolean }): Promise<void>;
  disconnect(): Promise<void>;
  /** Writes a HEX file, or else the firmware that came with the page, reads it back, and connects; the board's name. */
  flash(file: NamedText | null, report: Report): Promise<string>;
}
