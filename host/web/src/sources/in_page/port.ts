// The serial port of the board inside a page, as a browser's is: so a flasher finds its bootloader.

import type { Port } from "../serial/line";

export type Cable = { send(data: Uint8Array): void; restart(): void };

export class PagePort implements Port {
  readable: ReadableStream<Uint8Array> | null = null;
  writable: WritableStream<Uint8Array> | null = null;
  private heard: ReadableStreamDefaultController<Uint8Array> | null = null;
  private ready = false; // DTR

  /** `cable` leads to the board. */
  constructor(private readonly cable: Cable) {}

  async open(): Promise<void> {
    this.readable = new ReadableStream<Uint8Array>({
      start: (controller) => { this.heard = controller; },
      cancel: () => this.end(),
    });
    this.writable = new WritableStream<Uint8Array>({ write: (data) => this.cable.send(data) });
  }

  async close(): Promise<void> {
    this.end();
    this.writable = null;
  }

  /** The board restarts as DTR rises. */
  async setSignals({ dataTerminalReady }: SerialOutputSignals): Promise<void> {
    if (dataTerminalReady && !this.ready) this.cable.restart();
    this.ready = dataTerminalReady === true;
  }

  /** What the board says. */
  hear(data: Uint8Array): void {
    this.heard?.enqueue(data);
  }

  private end(): void {
    this.readable = this.heard = null;
  }
}
