// Frames on the wire: COBS( type | seq | payload | CRC-16 ) and a zero byte; docs/link.md has the definition.

import { crc16 } from "./crc";
import { LinkError } from "./declared";
import { MAX_PAYLOAD } from "./schema";

const OVERHEAD = 4; // type, seq and CRC
const MAX_WIRE = MAX_PAYLOAD + OVERHEAD + 1; // with the COBS byte, without the closing zero

export type Frame = { readonly type: number; readonly seq: number; readonly payload: Uint8Array };

/** The bytes of one frame, the closing zero included. */
export function encodeFrame(type: number, seq: number, payload: Uint8Array): Uint8Array {
  if (payload.length > MAX_PAYLOAD) {
    throw new LinkError(`A frame carries at most ${MAX_PAYLOAD} bytes, but ${payload.length} were given; send less.`);
  }
  const body = new Uint8Array(payload.length + OVERHEAD);
  body.set([type, seq]);
  body.set(payload, 2);
  const crc = crc16(body, 0, body.length - 2);
  body.set([crc & 0xff, crc >> 8], body.length - 2);
  return stuff(body);
}

/** COBS: no zero within, one at the end. A body is shorter than 254 bytes, so that one block length always fits. */
function stuff(body: Uint8Array): Uint8Array {
  const wire = new Uint8Array(body.length + 2);
  let code = 0;
  body.forEach((byte, i) => {
    if (byte) wire[i + 1] = byte;
    else {
      wire[code] = i + 1 - code;
      code = i + 1;
    }
  });
  wire[code] = body.length + 1 - code;
  return wire;
}

/** The body in wire[0..length), written over the wire's own bytes; null when it is not COBS. */
function unstuff(wire: Uint8Array, length: number): Uint8Array | null {
  let from = 0;
  let to = 0;
  while (from < length) {
    const end = from + wire[from]!;
    if (end > length) return null;
    for (from++; from < end; from++) wire[to++] = wire[from]!;
    if (end < length) wire[to++] = 0;
  }
  return wire.subarray(0, to);
}

/** Finds frames in bytes that come in pieces of any size. `bad` counts the pieces between two zeros that were none. */
export class FrameDecoder {
  bad = 0;
  private readonly piece = new Uint8Array(MAX_WIRE + 1);
  private length = 0;

  /** Calls `arrived` for each whole frame; its payload is the callee's only until it returns. */
  feed(bytes: Uint8Array, arrived: (frame: Frame) => void): void {
    for (const byte of bytes) {
      if (byte) {
        if (this.length <= MAX_WIRE) this.piece[this.length++] = byte;
      } else if (this.length) {
        const frame = this.decode();
        this.length = 0;
        if (frame) arrived(frame);
        else this.bad++;
      }
    }
  }

  private decode(): Frame | null {
    if (this.length <= OVERHEAD || this.length > MAX_WIRE) return null;
    const body = unstuff(this.piece, this.length);
    if (!body || body.length < OVERHEAD) return null;
    const crc = body[body.length - 2]! | (body[body.length - 1]! << 8);
    if (crc16(body, 0, body.length - 2) !== crc) return null;
    return { type: body[0]!, seq: body[1]!, payload: body.subarray(2, body.length - 2) };
  }

  /** Forgets a piece of a frame, as after the board came anew. */
  reset(): void {
    this.length = 0;
  }
}
