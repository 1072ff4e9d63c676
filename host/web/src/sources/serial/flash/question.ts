// A question to a bootloader: its bytes, and the pattern of its answer.

export type Bytes = ArrayLike<number> & Iterable<number>;
export type Question = { readonly asks: readonly number[]; readonly answer: readonly number[] };

// Of a pattern, beside bytes: any byte, and one that was asked for.
export const ANY = -1;
const KEPT = -2;

export function kept(count: number): number[] {
  return new Array<number>(count).fill(KEPT);
}

/** The bytes that were asked for, of an answer; null where it is another one. */
export function keep(heard: Uint8Array, pattern: readonly number[]): Uint8Array | null {
  const fits = heard.length === pattern.length && pattern.every((wanted, i) => wanted < 0 || wanted === heard[i]);
  return fits ? heard.filter((_, i) => pattern[i] === KEPT) : null;
}

/** A number in so many bytes. */
export function lowFirst(value: number, width: number): number[] {
  return Array.from({ length: width }, (_, i) => (value >> (8 * i)) & 0xff);
}

/** A number in so many bytes. */
export function highFirst(value: number, width: number): number[] {
  return lowFirst(value, width).reverse();
}
