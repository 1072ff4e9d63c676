// Counts the ticks that are due by the wall clock. What a busy machine missed is made up for, up to a second of it; one that is
// too slow falls behind.

const GIVE_UP_MS = 1000;

export class Clock {
  private last: number | null = null; // ms of the wall clock; null while time stands still
  private owed = 0; // ticks

  /** Ticks that are due now, at a speed in simulated seconds a second. */
  due(nowMs: number, speed: number): number {
    const passed = this.last === null ? 0 : Math.min(nowMs - this.last, GIVE_UP_MS);
    this.last = nowMs;
    this.owed = Math.min(this.owed + passed * speed, GIVE_UP_MS * speed);
    const whole = Math.floor(this.owed);
    this.owed -= whole;
    return whole;
  }

  /** Takes back ticks for which there was no time. */
  owe(ticks: number): void {
    this.owed += ticks;
  }

  /** Lets time stand still until ticks are asked for again. */
  hold(): void {
    this.last = null;
  }
}
