// A board at a port: what is refused before any byte is written, and a browser without ports.
import assert from "node:assert/strict";
import { test } from "node:test";
import type { LinkState } from "../src/session/board";
import { encodeFrame } from "../src/link/frames";
import { EnableRequest, LeadRequest, Sample, State } from "../src/link/schema";
import { SerialBoard } from "../src/sources/serial/board";
import { checkImage, readImage } from "../src/sources/serial/flash/image";
import { Lease } from "../src/sources/serial/lease";
import { TARGETS } from "../src/sources/serial/flash/rules";

function record(address: number, kind: number, data: readonly number[]): string {
  const bytes = [data.length, address >> 8, address & 0xff, kind, ...data];
  const sum = -bytes.reduce((total, byte) => total + byte, 0) & 0xff;
  return `:${[...bytes, sum].map((byte) => byte.toString(16).padStart(2, "0")).join("")}\n`;
}

const END = record(0, 1, []);
const nano = TARGETS.find(({ name }) => name === "nano")!;

test("a HEX file is read with its segments and gaps", () => {
  const { memory, signature } = readImage({ name: "a.hex", text: record(2, 0, [1, 2]) + record(0, 2, [0x10, 0]) + record(0, 0, [3]) + END });
  assert.deepEqual([...memory.subarray(0, 5)], [255, 255, 1, 2, 255]);
  assert.deepEqual([memory.length, memory.at(-1), signature], [0x10001, 3, null]);
});

test("a file that is no image for this board is refused in one sentence", () => {
  const refused = (text: string): string => {
    try {
      checkImage(readImage({ name: "a.hex", text }), nano);
    } catch (error) {
      return (error as Error).message;
    }
    return "";
  };
  const other = [...new TextEncoder().encode("greywhale image\0"), 1, 0x1e, 0x93, 0x0b, ...new Uint8Array(24)];
  assert.equal(refused("time_s,leader_0\n"), "a.hex, line 1: this is no Intel HEX record; give the .hex that PlatformIO built.");
  assert.equal(refused(record(0, 0, [1]).replace("01", "02") + END).slice(0, 14), "a.hex, line 1:");
  assert.equal(refused(record(0, 0, [1])), "a.hex: the file ends too early; copy or build it again.");
  assert.equal(refused(END), "a.hex: the file holds no data; give the .hex that PlatformIO built.");
  assert.match(refused(record(30_720, 0, [1]) + END), /reaches up to byte 30721, but an Arduino Nano .* has room for 30720; choose another file/);
  assert.match(refused(record(0, 4, [0, 0x10]) + record(0, 0, [1]) + END), /data at address 0x100000; no board has as much memory/);
  assert.equal(refused(record(0, 0, other.slice(0, -1)) + END), ""); // half of a record says nothing
  assert.match(refused(record(0, 0, other) + END), /this image is for a chip with signature 1e930b, but the board on this port is an Arduino Nano/);
});

test("the lease with which the page leads ends by itself, whatever was asked before", () => {
  const renewed: Uint8Array[] = [];
  const lease = new Lease((frame) => renewed.push(frame), () => true);
  const follow = (from: number): void => {
    for (let tick = from; tick < from + 200; tick++) {
      const still = { fault: 0, leader: [0, 0, 0, 0], follower: [0, 0, 0, 0], voltage: [0, 0, 0, 0] };
      lease.onHeard(encodeFrame(Sample.type, 0, Sample.pack({ tick, state: State.is.following, ...still })), () => assert.fail());
    }
  };
  lease.onSent(encodeFrame(EnableRequest.type, 1, EnableRequest.pack({ lease_ms: 300 })));
  follow(1000);
  assert.equal(renewed.length, 4);
  lease.onSent(encodeFrame(LeadRequest.type, 2, LeadRequest.pack({ lease_ms: 160 })));
  follow(2000);
  assert.equal(renewed.length, 4);
});

test("a browser without serial ports is told so", () => {
  const told: LinkState[] = [];
  const nothing = (): void => undefined;
  new SerialBoard(undefined, async (name) => ({ name, text: "" }))
    .listen({ bytes: nothing, driver: nothing, stored: nothing, refused: nothing, stopped: nothing, link: (state) => told.push(state) });
  assert.match(told[0]!.sentence, /^This browser reaches no serial port: take a recent Chromium/);
});
