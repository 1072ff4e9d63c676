// The samples of ten minutes in typed rings, with the extremes of each block of 64 for pictures of long spans.

import { Sample } from "../link/schema";

export const JOINTS = 4;
export const JOINT_NAMES = ["base yaw", "shoulder pitch", "wrist pitch", "wrist roll"];
export const TICKS_A_SECOND = 1000;
export const BLOCK = 64;
const MOST_SAMPLES = 600_000; // a multiple of BLOCK

/** The traces of a sample in the order in which the rings hold them: four joints of each. */
export const QUANTITIES = ["leader", "follower", "error", "voltage"] as const;
export type Quantity = (typeof QUANTITIES)[number];
export const QUANTITY_TITLES = ["leader rad", "follower rad", "error rad", "voltage V"];
export const TRACES = QUANTITIES.length * JOINTS;

/** Physical size of one count of a quantity: rad, rad, rad, V. */
export const COUNT: Readonly<Record<Quantity, number>> = {
  leader: Sample.place("leader").lsb,
  follower: Sample.place("follower").lsb,
  error: Sample.place("leader").lsb,
  voltage: Sample.place("voltage").lsb,
};

export function traceOf(quantity: Quantity, joint: number): number {
  return QUANTITIES.indexOf(quantity) * JOINTS + joint;
}

const AT = {
  tick: Sample.place("tick").at,
  state: Sample.place("state").at,
  fault: Sample.place("fault").at,
  leader: Sample.place("leader").at,
  follower: Sample.place("follower").at,
  voltage: Sample.place("voltage").at,
};
const ERROR = traceOf("error", 0);
const VOLTAGE = traceOf("voltage", 0);

/**
 * Samples are numbered from 0 in the order in which they came; `first` to `end` - 1 are kept. Time is in ticks and always
 * grows: when the board has started anew, its ticks go on a second after the last one.
 */
export class Samples {
  readonly time: Float64Array;
  readonly values: Int16Array; // TRACES of each sample, side by side
  readonly state: Uint8Array;
  readonly fault: Uint8Array;
  readonly low: Int16Array; // TRACES of each block
  readonly high: Int16Array;
  /** Ticks of which no sample came, since the page has been open. */
  lost = 0;
  end = 0;
  /** The board's own tick of the newest sample, -1 before any. */
  lastTick = -1;
  private offset = 0;

  /** `capacity` is a multiple of BLOCK; `every` is how many ticks there are from one sample to the next. */
  constructor(readonly capacity = MOST_SAMPLES, readonly every = 1) {
    this.time = new Float64Array(capacity);
    this.values = new Int16Array(capacity * TRACES);
    this.state = new Uint8Array(capacity);
    this.fault = new Uint8Array(capacity);
    this.low = new Int16Array((capacity / BLOCK) * TRACES);
    this.high = new Int16Array((capacity / BLOCK) * TRACES);
  }

  /** The oldest sample that is kept; a whole block is given up at a time. */
  get first(): number {
    return Math.max(0, Math.ceil((this.end - this.capacity) / BLOCK) * BLOCK);
  }

  /** Takes the payload of one sample. */
  add(payload: Uint8Array): void {
    const view = new DataView(payload.buffer, payload.byteOffset, payload.byteLength);
    const tick = view.getUint32(AT.tick, true);
    if (this.lastTick >= 0) {
      if (tick <= this.lastTick) this.offset += this.lastTick + TICKS_A_SECOND - tick;
      else this.lost += tick - this.lastTick - 1;
    }
    this.lastTick = tick;
    const slot = this.end % this.capacity;
    this.time[slot] = this.offset + tick;
    this.state[slot] = view.getUint8(AT.state);
    this.fault[slot] = view.getUint8(AT.fault);
    const base = slot * TRACES;
    for (let joint = 0; joint < JOINTS; joint++) {
      const leader = view.getInt16(AT.leader + 2 * joint, true);
      const follower = view.getInt16(AT.follower + 2 * joint, true);
      this.values[base + joint] = leader;
      this.values[base + JOINTS + joint] = follower;
      this.values[base + ERROR + joint] = Math.max(-32768, Math.min(32767, leader - follower));
      this.values[base + VOLTAGE + joint] = view.getInt16(AT.voltage + 2 * joint, true);
    }
    this.widen(base);
    this.end++;
  }

  private widen(base: number): void {
    const fresh = this.end % BLOCK === 0;
    const block = (Math.floor(this.end / BLOCK) % (this.capacity / BLOCK)) * TRACES;
    for (let trace = 0; trace < TRACES; trace++) {
      const value = this.values[base + trace]!;
      if (fresh || value < this.low[block + trace]!) this.low[block + trace] = value;
      if (fresh || value > this.high[block + trace]!) this.high[block + trace] = value;
    }
  }

  timeOf(number: number): number {
    return this.time[number % this.capacity]!;
  }

  /** One trace of one sample in counts. */
  count(number: number, trace: number): number {
    return this.values[(number % this.capacity) * TRACES + trace]!;
  }

  /** One number of one sample in its unit, rad or V. */
  value(number: number, quantity: Quantity, joint: number): number {
    return this.count(number, traceOf(quantity, joint)) * COUNT[quantity];
  }

  /** That number as a table shows it. */
  text(number: number, quantity: Quantity, joint: number): string {
    return this.value(number, quantity, joint).toFixed(quantity === "voltage" ? 3 : 4);
  }

  /** The newest sample's values of each joint, in their unit; 0 before any. */
  newest(quantity: Quantity): number[] {
    return Array.from({ length: JOINTS }, (_, joint) => (this.end ? this.value(this.end - 1, quantity, joint) : 0));
  }

  /** The first kept sample at or after a time in ticks; `end` when there is none. */
  at(time: number): number {
    let low = this.first;
    let high = this.end;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.timeOf(middle) < time) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  get firstTime(): number {
    return this.end ? this.timeOf(this.first) : 0;
  }

  get lastTime(): number {
    return this.end ? this.timeOf(this.end - 1) : 0;
  }
}

const LOOKED_AT = 1000; // samples that tell how far samples are apart

/** A log as samples that charts draw, from the payloads that a host gives. */
export function samplesIn(payloads: Uint8Array): Samples {
  const count = Math.floor(payloads.length / Sample.size);
  const samples = new Samples(Math.ceil(count / BLOCK) * BLOCK, spacing(payloads, count));
  for (let at = 0; at < count * Sample.size; at += Sample.size) samples.add(payloads.subarray(at, at + Sample.size));
  return samples;
}

/** Ticks from one sample to the next: the median of the first ones, as some may be missing. */
function spacing(payloads: Uint8Array, count: number): number {
  const view = new DataView(payloads.buffer, payloads.byteOffset, payloads.byteLength);
  const tick = (number: number): number => view.getUint32(number * Sample.size + AT.tick, true);
  const steps = Array.from({ length: Math.min(count - 1, LOOKED_AT) }, (_, number) => tick(number + 1) - tick(number));
  return steps.sort((a, b) => a - b)[steps.length >> 1] ?? 1;
}
