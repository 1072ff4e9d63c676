// Firmware images (Intel HEX) and what an image of greywhale says about itself: refused as greywhale/board/flash/images.py does.

import { LinkError } from "../../../link/declared";
import type { NamedText } from "../../../parts/named_text";
import { TARGETS, titleOf, type Target } from "./targets";

/** A HEX file from address 0 to its last one; what it leaves out is erased memory. */
export type Image = { readonly name: string; readonly memory: Uint8Array; readonly signature: string | null };

const MAGIC = new TextEncoder().encode("greywhale image\0");
const LAYOUT = 1;
const RECORD = 44; // bytes
const LARGEST = 1 << 20; // bytes; no board has as much
export const ERASED = 0xff;
const KIND = { data: 0, end: 1, segment: 2, linear: 4 };

export function hex(bytes: Uint8Array): string {
  return Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
}

export function readImage({ name, text }: NamedText): Image {
  const memory = new Uint8Array(LARGEST).fill(ERASED);
  let end = 0;
  for (const { address, data } of chunks(name, text)) {
    if (address + data.length > LARGEST) {
      throw new LinkError(`${name}: data at address 0x${address.toString(16)}; no board has as much memory.`);
    }
    if (!data.length) continue;
    memory.set(data, address);
    end = Math.max(end, address + data.length);
  }
  if (!end) throw new LinkError(`${name}: the file holds no data; give the .hex that PlatformIO built.`);
  const whole = memory.slice(0, end);
  return { name, memory: whole, signature: signatureIn(whole) };
}

/** Refuses an image that is plainly for another board. */
export function checkImage({ name, memory, signature }: Image, board: Target): void {
  if (signature !== null && signature !== board.signature) {
    const other = TARGETS.find((one) => one.signature === signature);
    const meant = other ? `an ${titleOf(other)}` : `a chip with signature ${signature}`;
    throw new LinkError(`${name}: this image is for ${meant}, but the board on this port is an ${titleOf(board)}; choose another file.`);
  }
  if (memory.length > board.space) {
    throw new LinkError(
      `${name}: the image reaches up to byte ${memory.length}, but an ${titleOf(board)} has room for ${board.space}; choose another file.`,
    );
  }
}

function* chunks(name: string, text: string): Generator<{ address: number; data: Uint8Array }> {
  let base = 0;
  for (const [at, whole] of text.split(/\r\n?|\n/).entries()) {
    const line = whole.replace(/^[ \t]+|[ \t]+$/g, "");
    if (!line) continue;
    const record = parse(line);
    if (!record) throw new LinkError(`${name}, line ${at + 1}: this is no Intel HEX record; give the .hex that PlatformIO built.`);
    const [size, high, low, kind] = record as unknown as [number, number, number, number];
    const data = record.subarray(4, 4 + size);
    if (kind === KIND.end) return;
    if (kind === KIND.data) yield { address: base + high * 256 + low, data };
    else if (kind === KIND.segment || kind === KIND.linear) {
      base = (data[0]! * 256 + data[1]!) * (kind === KIND.segment ? 16 : 65_536);
    }
  }
  throw new LinkError(`${name}: the file ends too early; copy or build it again.`);
}

/** The bytes of one record; null where it is none, or moves the base without the two bytes that say where to. */
function parse(line: string): Uint8Array | null {
  if (!/^:([0-9a-f]{2}){5,}$/i.test(line)) return null;
  const bytes = Uint8Array.from(line.slice(1).match(/../g)!, (pair) => parseInt(pair, 16));
  const sum = bytes.reduce((total, byte) => total + byte, 0);
  const moves = bytes[3] === KIND.segment || bytes[3] === KIND.linear;
  return bytes.length === bytes[0]! + 5 && sum % 256 === 0 && (!moves || bytes[0] === 2) ? bytes : null;
}

/** The chip that firmware/src/image_record.cpp names; null in an image that is not greywhale's. */
function signatureIn(memory: Uint8Array): string | null {
  for (let at = memory.indexOf(MAGIC[0]!); at >= 0; at = memory.indexOf(MAGIC[0]!, at + 1)) {
    if (MAGIC.every((byte, i) => memory[at + i] === byte)) {
      return memory.length >= at + RECORD && memory[at + MAGIC.length] === LAYOUT ? hex(memory.subarray(at + MAGIC.length + 1, at + MAGIC.length + 4)) : null;
    }
  }
  return null;
}
