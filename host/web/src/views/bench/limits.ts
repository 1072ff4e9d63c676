// The angles that a hand may lead to, as shares of a joint's range: 0 at its lower end, 1 at its upper one.

import type { BenchControls } from "../../session/services";

export type Limits = BenchControls["leader"];

function within(share: number): number {
  return Math.max(0, Math.min(1, share));
}

export function angleAt(limits: Limits, joint: number, share: number): number {
  const low = limits.minimum[joint]!;
  return low + within(share) * (limits.maximum[joint]! - low);
}

export function shareOf(limits: Limits, joint: number, angle: number): number {
  const low = limits.minimum[joint]!;
  const width = limits.maximum[joint]! - low;
  return width > 0 ? within((angle - low) / width) : 0.5; // no joint there
}

/** The place of a pointer in a picture: shares from its left and from its bottom. */
export function pointed(picture: Element, { clientX, clientY }: PointerEvent): [across: number, up: number] {
  const box = picture.getBoundingClientRect();
  return [within((clientX - box.left) / box.width), within(1 - (clientY - box.top) / box.height)];
}
