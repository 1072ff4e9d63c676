// The picture that a chart draws of a span: the exact samples where there is room for them, else the extremes of each column.

import { BLOCK, COUNT, QUANTITIES, TICKS_A_SECOND, TRACES, JOINTS, type Samples } from "./samples";

const GAP_SAMPLES = 20; // a longer hole is drawn as one

/** x in seconds; y has one list for each trace, null where a line breaks. Reused from one picture to the next. */
export type Picture = { readonly x: number[]; readonly y: (number | null)[][]; exact: boolean };

export function emptyPicture(): Picture {
  return { x: [], y: Array.from({ length: TRACES }, () => []), exact: true };
}

const COUNTS = QUANTITIES.flatMap((quantity) => Array.from({ length: JOINTS }, () => COUNT[quantity]));

/** Fills `into` with the samples from `begin` to `end` (ticks), at most some two points for each of so many columns. */
export function draw(samples: Samples, begin: number, end: number, columns: number, into: Picture): void {
  const from = Math.max(samples.first, samples.at(begin) - 1);
  const to = Math.min(samples.end, samples.at(end) + 1);
  const step = stepFor(to - from, columns);
  into.exact = step === 1;
  const pen = new Pen(samples, into);
  for (let number = Math.max(samples.first, Math.floor(from / step) * step); number < to; number += step) {
    pen.column(number, Math.min(number + step, samples.end), step >= BLOCK);
  }
  pen.end();
}

/** Puts columns of samples into a picture, one after the other, and breaks the line where samples are missing. */
class Pen {
  private at = 0;
  private before = NaN; // time of the last sample drawn
  private readonly gap: number; // ticks

  constructor(private readonly samples: Samples, private readonly into: Picture) {
    this.gap = GAP_SAMPLES * samples.every;
  }

  column(from: number, to: number, blocks: boolean): void {
    const { samples } = this;
    const time = samples.timeOf(from);
    const last = samples.timeOf(to - 1);
    if (last - time - (to - 1 - from) * samples.every > this.gap) {
      const behind = this.gapIn(from, to);
      this.column(from, behind, false);
      this.column(behind, to, false);
      return;
    }
    if (time - this.before > this.gap) this.point((time + this.before) / 2, null);
    if (to - from === 1) {
      this.point(time, samples.values, (from % samples.capacity) * TRACES);
    } else {
      spread(samples, from, to, blocks);
      this.point(time, extremes.low);
      this.point((time + last) / 2, extremes.high);
    }
    this.before = last;
  }

  /** The first sample behind the first gap of a column that has one; in one that only lacks single samples, its middle. */
  private gapIn(from: number, to: number): number {
    for (let number = from + 1; number < to; number++) {
      if (this.samples.timeOf(number) - this.samples.timeOf(number - 1) > this.gap) return number;
    }
    return (from + to) >> 1;
  }

  private point(time: number, counts: Int16Array | null, base = 0): void {
    const { x, y } = this.into;
    x[this.at] = time / TICKS_A_SECOND;
    for (let trace = 0; trace < TRACES; trace++) y[trace]![this.at] = counts && counts[base + trace]! * COUNTS[trace]!;
    this.at++;
  }

  end(): void {
    this.into.x.length = this.at;
    for (const list of this.into.y) list.length = this.at;
  }
}

/** Samples in a column: a power of two, so that columns stay where they are while the picture moves on. */
function stepFor(count: number, columns: number): number {
  if (count <= 2 * columns) return 1;
  return 2 ** Math.ceil(Math.log2(count / columns));
}

const extremes = { low: new Int16Array(TRACES), high: new Int16Array(TRACES) };

/** The extremes of every trace from sample `from` to before `to`, by blocks where a column holds whole ones. */
function spread(samples: Samples, from: number, to: number, blocks: boolean): void {
  const { low, high } = extremes;
  low.fill(32767);
  high.fill(-32768);
  const stride = blocks ? BLOCK : 1; // whole blocks, the last one as far as it is full
  const slots = samples.capacity / stride;
  const [lows, highs] = blocks ? [samples.low, samples.high] : [samples.values, samples.values];
  for (let number = from; number < to; number += stride) {
    const base = (Math.floor(number / stride) % slots) * TRACES;
    for (let trace = 0; trace < TRACES; trace++) {
      const down = lows[base + trace]!;
      const up = highs[base + trace]!;
      if (down < low[trace]!) low[trace] = down;
      if (up > high[trace]!) high[trace] = up;
    }
  }
}
