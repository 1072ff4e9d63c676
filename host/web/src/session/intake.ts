// Brings samples into the order of their ticks as they come: what was before this page, and what a slow page has lost, is asked of the history.

import type { Board } from "./board";
import { FrameDecoder } from "../link/frames";
import { Sample } from "../link/schema";
import type { Samples } from "./samples";

const LONGEST_DELAY_TICKS = 5000; // of a sample behind the history's
const TICK_AT = Sample.place("tick").at;

function tickOf(payload: Uint8Array): number {
  return new DataView(payload.buffer, payload.byteOffset).getUint32(TICK_AT, true);
}

export class Intake {
  /** True while a board is known to have started anew of which no sample has come. */
  startTold = false;
  /** New samples, which wait while those before them are fetched; null once these are here. */
  private waiting: Uint8Array[] | null = [];

  /** `attempt` runs what may fail, and tells a person. */
  constructor(
    private readonly samples: Samples, private readonly history: Board["history"],
    private readonly attempt: (act: () => Promise<void>) => Promise<boolean>,
  ) {}

  /** Fetches the samples from before, once. */
  async begin(): Promise<void> {
    if (this.waiting && !this.samples.end) await this.fetch(null);
  }

  add(payload: Uint8Array): void {
    const { lastTick } = this.samples;
    if (this.waiting) {
      this.waiting.push(payload.slice());
    } else if (lastTick >= 0 && tickOf(payload) > lastTick + 1) {
      this.waiting = [payload.slice()]; // a slow page has lost pictures; who keeps the samples has them still
      void this.attempt(() => this.fetch(lastTick + 1));
    } else if (tickOf(payload) > lastTick || this.isNewStart(tickOf(payload))) {
      this.samples.add(payload);
    }
  }

  /** True if an earlier tick is that of a board which has started anew, and not one that the history had as well. */
  private isNewStart(tick: number): boolean {
    if (!this.startTold && tick > this.samples.lastTick - LONGEST_DELAY_TICKS) return false;
    this.startTold = false;
    return true;
  }

  private async fetch(from: number | null): Promise<void> {
    const before = this.samples.end;
    try {
      const frames = await this.history(from);
      new FrameDecoder().feed(frames, ({ type, payload }) => {
        if (type === Sample.type && payload.length === Sample.size) this.samples.add(payload);
      });
      if (from === null) this.samples.lost = 0;
    } finally {
      this.takeWaiting(this.samples.end > before);
    }
  }

  /** Takes what came meanwhile. Where that has a gap as well, the history is asked again, as long as it gives more. */
  private takeWaiting(askAgain: boolean): void {
    const waiting = this.waiting ?? [];
    this.waiting = null;
    for (const [number, payload] of waiting.entries()) {
      const tick = tickOf(payload);
      const { lastTick } = this.samples;
      if (askAgain && tick > lastTick + 1) {
        this.waiting = waiting.slice(number);
        void this.attempt(() => this.fetch(lastTick + 1));
        return;
      }
      if (tick > lastTick || this.isNewStart(tick)) this.samples.add(payload);
    }
  }
}
