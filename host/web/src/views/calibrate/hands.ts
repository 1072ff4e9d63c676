// The hands of a simulated bench, where there is one, do what a step asks of a person, and say when they are there.

import type { Bench, HandsWish } from "../../session/services";
import type { Session } from "../../session/session";

const LOOK_MS = 50;
const REST_TICKS = 550; // after the hands are there: a pose is looked at for 500

export class Hands {
  private asked = 0; // the number of the last wish
  private doing: number | null = null; // the wish that they are at

  constructor(private readonly session: Session, private readonly bench: Bench) {}

  /** True while somebody waits for them. */
  get areBusy(): boolean {
    return this.doing === this.asked;
  }

  /** Lets them do it; false where somebody has gone on without them. */
  async do(wish: HandsWish): Promise<boolean> {
    const number = this.doing = ++this.asked;
    try {
      return await this.wait(wish, number);
    } finally {
      if (this.doing === number) this.doing = null;
    }
  }

  private async wait(wish: HandsWish, number: number): Promise<boolean> {
    const { session, session: { samples } } = this;
    const before = samples.lastTick;
    const takes = 1000 * await this.bench.hands(wish) + REST_TICKS;
    const end = await session.tick() + takes;
    while (samples.lastTick < end) {
      const restarted = samples.lastTick < before;
      if (number !== this.asked || restarted || !session.link.open) return false;
      await new Promise((settle) => setTimeout(settle, LOOK_MS));
    }
    return number === this.asked;
  }

  /** Nobody waits for them any more. */
  letGo(): void {
    this.asked++;
  }
}
