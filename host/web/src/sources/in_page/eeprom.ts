// The board's EEPROM, kept by the browser. Content that is damaged is told and set aside.

import type { Store } from "../../parts/storage";
import { crc32 } from "../../link/crc32";

const KEY = "greywhale-eeprom-mega";
const BYTES = 4096; // of a Mega
const ASIDE = "greywhale-eeprom-damaged";

export type Kept = { readonly content: Uint8Array | null; readonly sentence: string };

/** The content that the browser has kept, and a sentence where something is wrong with it. */
export function keptEeprom(store: Store): Kept {
  if (!store.allowed) {
    return { content: null, sentence: "This browser keeps nothing for this page: what the board stores ends with it." };
  }
  const text = store.read(KEY);
  if (text === null) return { content: null, sentence: "" };
  const content = unpacked(text);
  if (content) return { content, sentence: "" };
  const where = store.move(KEY, ASIDE) ? `it is set aside as ${ASIDE}` : "without room to set it aside, it stays until the board stores anew";
  return { content: null, sentence: `What this browser had kept of the board's memory is damaged; ${where}, and the board has its defaults.` };
}

/** Keeps it from now on; false where the browser does not. */
export function keepEeprom(store: Store, content: Uint8Array): boolean {
  const data = Array.from(content, (byte) => byte.toString(16).padStart(2, "0")).join("");
  return store.write(KEY, `${data} ${crc32(data)}`);
}

function unpacked(text: string): Uint8Array | null {
  const [data = "", check] = text.split(" ");
  if (!/^[0-9a-f]*$/.test(data) || data.length !== 2 * BYTES || check !== String(crc32(data))) return null;
  return Uint8Array.from(data.match(/../g)!, (pair) => parseInt(pair, 16));
}
