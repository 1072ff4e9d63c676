// Watches every sample for an event and names the first that has it.

import { type Quantity, type Samples } from "../../session/samples";

export type Condition =
  | { readonly kind: "fault" }
  | { readonly kind: "level" | "rising" | "falling"; readonly quantity: Quantity; readonly joint: number; readonly at: number };

export class Trigger {
  private seen: number;

  /** Looks at samples that come from now on. */
  constructor(private readonly samples: Samples, private readonly condition: Condition) {
    this.seen = samples.end;
  }

  /** The number of the first sample since the last look that fulfils the condition, or null. */
  look(): number | null {
    for (let number = Math.max(this.seen, this.samples.first); number < this.samples.end; number++) {
      if (this.fires(number)) {
        this.seen = number + 1;
        return number;
      }
    }
    this.seen = this.samples.end;
    return null;
  }

  private fires(number: number): boolean {
    const { condition, samples } = this;
    const before = number - 1;
    if (condition.kind === "fault") {
      return samples.fault[number % samples.capacity] !== 0
        && (before < samples.first || samples.fault[before % samples.capacity] === 0);
    }
    const { quantity, joint } = condition;
    const value = samples.value(number, quantity, joint);
    if (condition.kind === "level") return Math.abs(value) >= Math.abs(condition.at);
    if (before < samples.first) return false;
    const last = samples.value(before, quantity, joint);
    return condition.kind === "rising"
      ? last < condition.at && value >= condition.at
      : last > condition.at && value <= condition.at;
  }
}
