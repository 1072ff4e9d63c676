// A log as samples that charts draw, from the payloads that a host gives.

import { Sample } from "../link/schema";
import { BLOCK, Samples } from "../samples/samples";

const LOOKED_AT = 1000; // samples that tell how far samples are apart

export function samplesIn(payloads: Uint8Array): Samples {
  const count = Math.floor(payloads.length / Sample.size);
  const samples = new Samples(Math.ceil(count / BLOCK) * BLOCK, spacing(payloads, count));
  for (let at = 0; at < count * Sample.size; at += Sample.size) samples.add(payloads.subarray(at, at + Sample.size));
  return samples;
}

/** Ticks from one sample to the next: the median of the first ones, as some may be missing. */
function spacing(payloads: Uint8Array, count: number): number {
  const view = new DataView(payloads.buffer, payloads.byteOffset, payloads.byteLength);
  const tick = (number: number): number => view.getUint32(number * Sample.size + Sample.place("tick").at, true);
  const steps = Array.from({ length: Math.min(count - 1, LOOKED_AT) }, (_, number) => tick(number + 1) - tick(number));
  return steps.sort((a, b) => a - b)[steps.length >> 1] ?? 1;
}
