// numpy's PCG64 (XSL-RR 128/64): the same numbers from the same state.

const MULTIPLIER = 0x2360ed051fc65da44385df649fccf645n;
const WHOLE = (1n << 128n) - 1n;
const HALF = (1n << 64n) - 1n;

export class Random {
  private state: bigint;
  private readonly increment: bigint;

  constructor([state, increment]: readonly [string, string]) {
    this.state = BigInt(`0x${state}`);
    this.increment = BigInt(`0x${increment}`);
  }

  /** In [0, 1). */
  next(): number {
    this.state = (this.state * MULTIPLIER + this.increment) & WHOLE;
    const folded = (this.state >> 64n) ^ (this.state & HALF);
    const turn = this.state >> 122n;
    const turned = ((folded >> turn) | (folded << (64n - turn))) & HALF;
    return Number(turned >> 11n) / 2 ** 53;
  }

  some(count: number): number[] {
    return Array.from({ length: count }, () => this.next());
  }

  rows(count: number, size: number): number[][] {
    return Array.from({ length: count }, () => this.some(size));
  }
}
