// Firmware images (Intel HEX) and what an image of greywhale says about itself.

import { LinkError } from "../../../link/declared";
import type { NamedText } from "../../../parts/named_text";
import * as sentences from "../../../files/rules";
import * as rules from "./rules";
import { titleOf, type Target } from "./targets";

/** A HEX file from address 0 to its last one; what it leaves out is erased memory. */
export type Image = { readonly name: string; readonly memory: Uint8Array; readonly signature: string | null };

const MAGIC = new TextEncoder().encode(rules.IMAGE_MAGIC);
const LARGEST = rules.LARGEST_IMAGE_BYTES;

export function hex(bytes: Uint8Array): string {
  return Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
}

export function hexNumber(value: number): string {
  return `0x${value.toString(16)}`;
}

export function readImage({ name, text }: NamedText): Image {
  const memory = new Uint8Array(LARGEST).fill(rules.ERASED);
  let end = 0;
  for (const { address, data } of chunks(name, text)) {
    if (address + data.length > LARGEST) {
      throw new LinkError(`${name}: ${sentences.beyondAnyBoard({ address: hexNumber(address) })}`);
    }
    if (!data.length) continue;
    memory.set(data, address);
    end = Math.max(end, address + data.length);
  }
  if (!end) throw new LinkError(`${name}: ${sentences.noData()}`);
  const whole = memory.slice(0, end);
  return { name, memory: whole, signature: signatureIn(whole) };
}

/** Refuses an image that is plainly for another board. */
export function checkImage({ name, memory, signature }: Image, board: Target): void {
  if (signature !== null && signature !== board.signature) {
    const other = rules.TARGETS.find((one) => one.signature === signature);
    const meant = other ? `an ${titleOf(other)}` : `a chip with signature ${signature}`;
    throw new LinkError(`${name}: ${sentences.otherBoard({ meant, port: "this port", board: titleOf(board) })}`);
  }
  if (memory.length > board.space) {
    throw new LinkError(`${name}: ${sentences.noRoom({ end: memory.length, board: titleOf(board), space: board.space })}`);
  }
}

function* chunks(name: string, text: string): Generator<{ address: number; data: Uint8Array }> {
  let base = 0;
  for (const [at, whole] of text.split(/\r\n?|\n/).entries()) {
    const line = whole.replace(/^[ \t]+|[ \t]+$/g, "");
    if (!line) continue;
    const record = parse(line);
    if (!record) throw new LinkError(`${name}, line ${at + 1}: ${sentences.noHexRecord()}`);
    const [size, high, low, kind] = record as unknown as [number, number, number, number];
    const data = record.subarray(4, 4 + size);
    if (kind === rules.HEX_END) return;
    if (kind === rules.HEX_DATA) yield { address: base + high * 256 + low, data };
    else if (kind === rules.HEX_SEGMENT || kind === rules.HEX_LINEAR) {
      base = (data[0]! * 256 + data[1]!) * (kind === rules.HEX_SEGMENT ? 16 : 65_536);
    }
  }
  throw new LinkError(`${name}: ${sentences.endsTooEarly()}`);
}

/** The bytes of one record; null where it is none, or moves the base without the two bytes that say where to. */
function parse(line: string): Uint8Array | null {
  if (!/^:([0-9a-f]{2}){5,}$/i.test(line)) return null;
  const bytes = Uint8Array.from(line.slice(1).match(/../g)!, (pair) => parseInt(pair, 16));
  const sum = bytes.reduce((total, byte) => total + byte, 0);
  const moves = bytes[3] === rules.HEX_SEGMENT || bytes[3] === rules.HEX_LINEAR;
  return bytes.length === bytes[0]! + 5 && sum % 256 === 0 && (!moves || bytes[0] === 2) ? bytes : null;
}

/** The chip that firmware/src/image_record.cpp names; null in an image that is not greywhale's. */
function signatureIn(memory: Uint8Array): string | null {
  for (let at = memory.indexOf(MAGIC[0]!); at >= 0; at = memory.indexOf(MAGIC[0]!, at + 1)) {
    if (MAGIC.every((byte, i) => memory[at + i] === byte)) {
      const layout = at + MAGIC.length;
      const whole = memory.length >= at + rules.IMAGE_RECORD_BYTES && memory[layout] === rules.IMAGE_LAYOUT;
      return whole ? hex(memory.subarray(layout + 1, layout + 4)) : null;
    }
  }
  return null;
}
