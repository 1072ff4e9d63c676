// The link client against the golden vectors of shared/link (JSON in the file that GOLDEN names) and damaged bytes.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { LinkClient, PATIENCE_MS } from "../src/link/client";
import { crc16 } from "../src/link/crc";
import { LinkError } from "../src/link/declared";
import { encodeFrame, FrameDecoder, type Frame } from "../src/link/frames";
import { faultSentence } from "../src/link/refusal";
import * as schema from "../src/link/schema";

type Vector = { message: keyof typeof schema.MESSAGES; seq: number; payload: string; wire: string; values: object };
type Golden = { vector: Vector[]; parameters: { defaults: string; crc: number } };
const golden = JSON.parse(readFileSync(process.env["GOLDEN"] ?? "", "utf8")) as Golden;
const bytes = (hex: string): Uint8Array => Uint8Array.from(Buffer.from(hex, "hex"));
const hex = (data: Uint8Array): string => Buffer.from(data).toString("hex");

function decode(decoder: FrameDecoder, data: Uint8Array): Frame[] {
  const frames: Frame[] = [];
  decoder.feed(data, (frame) => frames.push({ ...frame, payload: frame.payload.slice() }));
  return frames;
}

test("every golden vector packs, frames and comes back", () => {
  assert.ok(golden.vector.length > 50);
  for (const { message, seq, payload, wire, values } of golden.vector) {
    const type = schema.MESSAGES[message];
    const pack = type.pack as (values: object) => Uint8Array;
    assert.equal(hex(pack.call(type, values)), payload, message);
    assert.equal(hex(encodeFrame(type.type, seq, bytes(payload))), wire, message);
    const [frame, ...more] = decode(new FrameDecoder(), bytes(wire));
    assert.deepEqual([frame!.type, frame!.seq, hex(frame!.payload), more.length], [type.type, seq, payload, 0]);
    assert.deepEqual(type.unpack(frame!.payload), values, message);
  }
});

test("the parameter table packs to the board's bytes and check", () => {
  const defaults = schema.TABLE.parameters.map(({ initial }) => initial);
  assert.equal(hex(schema.TABLE.pack(defaults)), golden.parameters.defaults);
  assert.equal(schema.TABLE.crc(defaults), golden.parameters.crc);
  assert.equal(crc16(new TextEncoder().encode("123456789")), 0x29b1);
});

test("a value that does not fit is refused", () => {
  assert.throws(() => schema.ParamGetRequest.pack({ index: 65536 }), LinkError);
  assert.throws(() => schema.HelloReply.unpack(new Uint8Array(3)), LinkError);
});

test("damaged bytes cost the frames that they hit and no other", () => {
  const stream = golden.vector.map(({ wire }) => bytes(wire));
  const whole = Uint8Array.from(stream.flatMap((wire) => [...wire]));
  const wanted = golden.vector.map(({ payload }) => payload);
  for (let seed = 1; seed <= 300; seed++) {
    const damaged = whole.slice();
    const at = (seed * 7919) % whole.length;
    const before = damaged[at]!;
    damaged[at] = before ^ (1 + (seed * 31) % 255);
    const decoder = new FrameDecoder();
    const got = [0, 1, 2].flatMap((part) => {
      const cut = Math.floor((damaged.length * part) / 3);
      return decode(decoder, damaged.subarray(cut, Math.floor((damaged.length * (part + 1)) / 3)));
    }).map(({ payload }) => hex(payload));
    // One byte lies in one frame, and a lost or a new zero in it touches at most the next one.
    assert.ok(got.length >= wanted.length - 2, `seed ${seed}: ${got.length} of ${wanted.length}`);
    let from = 0;
    for (const payload of got) {
      from = wanted.indexOf(payload, from) + 1;
      assert.ok(from > 0, `seed ${seed}: a frame that nobody sent`);
    }
    assert.ok(decoder.bad > 0 || got.length === wanted.length - 1);
  }
});

test("noise without an end is counted once and passed over", () => {
  const decoder = new FrameDecoder();
  assert.equal(decode(decoder, new Uint8Array(5000).fill(7)).length, 0);
  const wire = bytes(golden.vector[0]!.wire);
  assert.equal(decode(decoder, Uint8Array.from([0, ...wire])).length, 1);
  assert.equal(decoder.bad, 1);
});

/** A client, what it sent, and what it told. */
function rig() {
  const sent: Frame[] = [];
  const heard: string[] = [];
  const client = new LinkClient(
    (wire) => sent.push(...decode(new FrameDecoder(), wire)),
    { sample: (payload) => heard.push(`sample ${payload.length}`), hello: (reply) => heard.push(`hello ${reply.board}`) },
  );
  return { client, sent, heard };
}

test("replies find their request in any order, and a refusal is one sentence", async () => {
  const { client, sent } = rig();
  const first = client.ask(schema.ParamGetRequest, { index: 3 });
  const second = client.ask(schema.ParamGetRequest, { index: 4 });
  const third = client.ask(schema.EnableRequest, { lease_ms: 300 });
  const [one, two, three] = sent.map(({ seq }) => seq);
  client.receive(encodeFrame(schema.Nack.type, three!, schema.Nack.pack({ request: 8, code: 7, detail: 0x0240 })));
  client.receive(encodeFrame(schema.ParamGetReply.type, two!, schema.ParamGetReply.pack({ index: 4, value: -9 })));
  client.receive(encodeFrame(schema.ParamGetReply.type, one!, schema.ParamGetReply.pack({ index: 3, value: 7 })));
  assert.deepEqual([(await first).value, (await second).value], [7, -9]);
  await assert.rejects(third, /refused "enable": .*\(joint 2, 2\.00 rad\): move the leader/);
});

test("a fault names the potentiometer or the joint, as the kind of fault has it", () => {
  const place = (fault: number, where: number): string => faultSentence({ fault, fault_where: where });
  const { leader_jump, pot_high, tracking, estop } = schema.Fault.is;
  assert.match(place(leader_jump, 2), /jumped \(leader potentiometer 2\)\./);
  assert.match(place(pot_high, 5), /\(follower potentiometer 1\)\./);
  assert.match(place(tracking, 1), /\(joint 1\)\./);
  assert.doesNotMatch(place(estop, 0xff), /\(/);
});

test("silence is asked again with the same frame, then told", async ({ mock }) => {
  mock.timers.enable({ apis: ["setTimeout"] });
  const { client, sent } = rig();
  const asked = client.ask(schema.StatusRequest, {});
  for (let i = 0; i < 4; i++) mock.timers.tick(PATIENCE_MS);
  await assert.rejects(asked, /does not answer status/);
  assert.equal(new Set(sent.map(({ seq }) => seq)).size, 1);
  assert.equal(sent.length, 4);
});

test("what nobody asked for goes to who listens, and a board that went ends every request", async () => {
  const { client, heard } = rig();
  const of = (name: string): Vector => golden.vector.find(({ message }) => message === name)!;
  client.receive(bytes(of("Sample").wire));
  client.receive(bytes(of("HelloReply").wire));
  assert.deepEqual(heard, ["sample 30", "hello 0"]);
  const asked = client.ask(schema.StopRequest, {});
  client.abandon("The board went.");
  await assert.rejects(asked, /The board went/);
});
