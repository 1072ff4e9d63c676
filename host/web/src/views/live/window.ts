// The span of time that all charts show: it moves with the newest sample until somebody pauses or looks back.

import { Signal } from "../../parts/signal";
import { TICKS_A_SECOND } from "../../session/samples";

/** The span that there is to show, in ticks. */
export type Extent = { readonly firstTime: number; readonly lastTime: number };

const SHORTEST_TICKS = 20;
const LONGEST_TICKS = 600 * TICKS_A_SECOND;
export const ZOOM_STEP = 1.6;

export class TimeWindow {
  readonly changed = new Signal();
  spanTicks = 10 * TICKS_A_SECOND;
  private held: number | null = null; // the end while it does not move, in ticks

  constructor(private readonly extent: Extent, private readonly longest = LONGEST_TICKS) {}

  get live(): boolean {
    return this.held === null;
  }

  get end(): number {
    return this.held ?? this.extent.lastTime;
  }

  get begin(): number {
    return this.end - this.spanTicks;
  }

  hold(): void {
    this.held = this.end;
    this.changed.emit();
  }

  follow(): void {
    this.held = null;
    this.changed.emit();
  }

  toggle(): void {
    if (this.live) this.hold();
    else this.follow();
  }

  private possible(span: number): number {
    return Math.max(SHORTEST_TICKS, Math.min(this.longest, span));
  }

  setSpan(ticks: number): void {
    this.spanTicks = this.possible(ticks);
    this.changed.emit();
  }

  /** Shows from `begin` to `end` and stays there. */
  show(begin: number, end: number): void {
    this.spanTicks = this.possible(end - begin);
    this.held = begin + this.spanTicks;
    this.changed.emit();
  }

  /** Zooms by a factor about a time that keeps its place; without one, about the end while live, else the middle. */
  zoom(factor: number, about?: number): void {
    if (this.held === null) {
      this.setSpan(this.spanTicks * factor);
      return;
    }
    const fixed = about ?? (this.begin + this.held) / 2;
    const share = (fixed - this.begin) / this.spanTicks;
    const span = this.possible(this.spanTicks * factor);
    this.show(fixed - share * span, fixed + (1 - share) * span);
  }

  /** Moves by a share of the span; moving past the newest sample follows it again. */
  pan(share: number): void {
    const end = this.end + share * this.spanTicks;
    if (end >= this.extent.lastTime) {
      this.follow();
      return;
    }
    this.held = Math.max(end, this.extent.firstTime);
    this.changed.emit();
  }
}
