// Counts how long nothing has come, and does one thing after another as it gets longer.

export class Silence {
  private timer = 0;

  /** The things to do after so many ms, in their order. */
  constructor(private readonly stages: readonly (readonly [ms: number, act: () => void])[]) {}

  /** Something came, or is expected from now on. */
  begin(): void {
    this.end();
    this.waitFor(0, 0);
  }

  end(): void {
    clearTimeout(this.timer);
  }

  private waitFor(stage: number, passedMs: number): void {
    const next = this.stages[stage];
    if (!next) return;
    const [ms, act] = next;
    this.timer = window.setTimeout(() => {
      act();
      this.waitFor(stage + 1, ms);
    }, ms - passedMs);
  }
}
