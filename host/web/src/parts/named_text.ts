// A file's bytes as text: UTF-8 alone is read, as the host does, and the mark before it stays for who reads the text.

/** A text file; `spoiltAt` is its first byte that is not UTF-8. */
export type NamedText = { readonly name: string; readonly text: string; readonly spoiltAt?: number };

export function namedText(name: string, bytes: Uint8Array): NamedText {
  const text = new TextDecoder("utf-8", { ignoreBOM: true }).decode(bytes);
  const spoiltAt = firstSpoilt(bytes, new TextEncoder().encode(text));
  return spoiltAt < 0 ? { name, text } : { name, text, spoiltAt };
}

/** The place of the first letter that is no UTF-8, by what came of it; -1 for none. */
function firstSpoilt(bytes: Uint8Array, again: Uint8Array): number {
  let at = bytes.findIndex((byte, place) => byte !== again[place]);
  if (at < 0 && bytes.length === again.length) return -1;
  if (at < 0) at = bytes.length;
  while ((again[at]! & 0xc0) === 0x80) at--;
  return at;
}
