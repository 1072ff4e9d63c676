// The board of every view: send a frame; frames arrive. No view knows where they come from.

export type LinkState = {
  readonly open: boolean;
  readonly port: string;
  readonly sentence: string;
  /** True if something is at the port that does not answer as this firmware does, or just gets it. */
  readonly unflashed?: boolean;
};

/** The client that may change what the board does; `verb` is what uses the board now at the host, in the place of any page. */
export type DriverState = { readonly you: boolean; readonly free: boolean; readonly verb: string | null };

export type BoardListener = {
  /** Bytes of the link, in pieces of any size; the listener may not keep them. */
  bytes(data: Uint8Array): void;
  link(state: LinkState): void;
  driver(state: DriverState): void;
  /** The CRC of the set that the board stores, as far as the source has seen it start or store; null: unknown. */
  stored(crc: number | null): void;
  /** A frame that did not reach the board, and why. */
  refused(seq: number, type: number, sentence: string): void;
  /** Somebody else stopped the arm. */
  stopped(sentence: string): void;
};

/**
 * A source of frames: a server, a serial port of the browser, a board inside the page. Whoever enables the motors gives
 * a lease; the source renews it for as long as this page is open and visible, and no longer.
 */
export interface Board {
  listen(listener: BoardListener): void;
  /** Sends one whole frame; what is sent while no board is there is lost. */
  send(frame: Uint8Array): void;
  /** Asks for the right to change things; `driver` tells when it is this page's. */
  drive(): void;
  release(): void;
  /** Frames of the kept samples from a tick on, null for all, oldest first; empty where nobody keeps them. */
  history(from: number | null): Promise<Uint8Array>;
}
