// What all views share of a board, over a board that answers at once.
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Board, BoardListener } from "../src/session/board";
import { encodeFrame, FrameDecoder } from "../src/link/frames";
import {
  ClearFaultReply, ClearFaultRequest, Nack, NackCode,
  EnableReply, EnableRequest, HelloReply, HelloRequest, ParamGetReply, ParamGetRequest, SCHEMA_HASH, State, StatusReply, StatusRequest, StopReason, StopReply, StopRequest, TABLE,
  TelemetryReply, TelemetryRequest,
} from "../src/link/schema";
import { Session } from "../src/session/session";

const zeros = (size: number): Uint8Array => new Uint8Array(size);
const settled = (): Promise<void> => new Promise((done) => setImmediate(done));

test("a set that another program stored is shown, whichever tells of it first: its CRC or the status", async ({ mock }) => {
  mock.timers.enable({ apis: ["setInterval", "setTimeout"] });
  const values = TABLE.parameters.map(({ initial }) => initial);
  let saves = 0;
  let heard!: BoardListener;
  const answers = new Map<number, (payload: Uint8Array) => [number, Uint8Array]>([
    [HelloRequest.type, () => [HelloReply.type, HelloReply.pack({
      ...HelloReply.unpack(zeros(HelloReply.size)), schema_hash: SCHEMA_HASH, param_crc: TABLE.crc(values),
    })]],
    [StatusRequest.type, () => [StatusReply.type, StatusReply.pack({ ...StatusReply.unpack(zeros(StatusReply.size)), saves })]],
    [TelemetryRequest.type, (payload) => [TelemetryReply.type, payload]],
    [ParamGetRequest.type, (payload) => {
      const { index } = ParamGetRequest.unpack(payload);
      return [ParamGetReply.type, ParamGetReply.pack({ index, value: values[index]! })];
    }],
  ]);
  const board: Board = {
    listen: (listener) => { heard = listener; },
    send: (frame) => new FrameDecoder().feed(frame, ({ type, seq, payload }) => {
      const [reply, answer] = answers.get(type)!(payload);
      queueMicrotask(() => heard.bytes(encodeFrame(reply, seq, answer)));
    }),
    drive: () => undefined,
    release: () => undefined,
    history: () => Promise.resolve(zeros(0)),
  };
  const session = new Session(board);
  let shown: unknown = null;
  session.parametersChanged.on(() => { shown = { nothing: session.storesNothing, stored: session.stored?.[0] }; });
  heard.link({ open: true, port: "here", sentence: "" });
  await settled();
  assert.deepEqual(shown, { nothing: true, stored: TABLE.parameters[0]!.initial });
  values[0]!++;
  mock.timers.tick(500);
  await settled(); // it has read the set
  saves = 1;
  heard.stored(TABLE.crc(values));
  mock.timers.tick(500);
  await settled();
  assert.deepEqual(shown, { nothing: false, stored: values[0] });
});

for (const who of ["nobody", "another page", "this page"]) {
  test(`motors that are off for a change ${who === "nobody" ? "" : "do not "}start again when ${who} stops them meanwhile`, async ({ mock }) => {
    mock.timers.enable({ apis: ["setInterval", "setTimeout"] });
    const asked: number[] = [];
    let state: number = State.is.following;
    let heard!: BoardListener;
    const session = new Session({
      listen: (listener) => { heard = listener; },
      send: (frame) => new FrameDecoder().feed(frame, ({ type, seq }) => {
        asked.push(type);
        if (type === StopRequest.type) state = State.is.disabled;
        const status = StatusReply.pack({ ...StatusReply.unpack(zeros(StatusReply.size)), state });
        const reply = type === StatusRequest.type ? status : zeros(type === StopRequest.type ? StopReply.size : EnableReply.size);
        queueMicrotask(() => heard.bytes(encodeFrame(type | 0x80, seq, reply)));
      }),
      drive: () => undefined,
      release: () => undefined,
      history: () => Promise.resolve(zeros(0)),
    });
    heard.driver({ you: true, free: false, verb: null });
    session.link = { open: true, port: "here", sentence: "" };
    mock.timers.tick(500);
    await settled();
    assert.ok(session.motorsOn);
    await session.withMotorsOff(async () => {
      assert.ok(!session.motorsOn);
      if (who === "another page") heard.stopped("The arm was stopped from a page that watches.");
      if (who === "this page") await session.stop();
    });
    assert.equal(asked.includes(EnableRequest.type), who === "nobody");
  });
}

test("motors that their lease turns off are told of, and no notice says that they are off once this page has enabled them", async ({ mock }) => {
  mock.timers.enable({ apis: ["setInterval", "setTimeout"] });
  let [state, stop_reason]: number[] = [State.is.disabled, StopReason.is.lease]; // of those who had them before
  let heard!: BoardListener;
  const session = new Session({
    listen: (listener) => { heard = listener; },
    send: (frame) => new FrameDecoder().feed(frame, ({ type, seq }) => {
      if (type === EnableRequest.type) state = State.is.soft_start;
      const status = StatusReply.pack({ ...StatusReply.unpack(zeros(StatusReply.size)), state: state!, stop_reason: stop_reason! });
      queueMicrotask(() => heard.bytes(encodeFrame(type | 0x80, seq, type === StatusRequest.type ? status : zeros(EnableReply.size))));
    }),
    drive: () => undefined,
    release: () => undefined,
    history: () => Promise.resolve(zeros(0)),
  });
  heard.driver({ you: true, free: false, verb: null });
  session.link = { open: true, port: "here", sentence: "" };
  const look = async (): Promise<string | undefined> => {
    mock.timers.tick(500);
    await settled();
    return session.notice?.sentence;
  };
  assert.equal(await look(), undefined);
  heard.refused(0, 0, "The motors are off: the page that drives fell silent.");
  assert.match((await look())!, /^The motors are off/);
  await session.enable();
  assert.equal(await look(), undefined);
  [state, stop_reason] = [State.is.disabled, StopReason.is.lease];
  assert.match((await look())!, /nobody renewed their lease/);
  await session.enable();
  session.tell("The log begins later.");
  [state, stop_reason] = [State.is.disabled, StopReason.is.host];
  assert.equal(await look(), "The log begins later.");
});

test("a refusal is taken back once the board does what it refused", async ({ mock }) => {
  mock.timers.enable({ apis: ["setInterval", "setTimeout"] });
  let mended = false;
  let heard!: BoardListener;
  const session = new Session({
    listen: (listener) => { heard = listener; },
    send: (frame) => new FrameDecoder().feed(frame, ({ type, seq }) => {
      const refused = type === ClearFaultRequest.type && !mended;
      const nack = Nack.pack({ request: type, code: NackCode.is.pot_bad, detail: 0x0500 });
      const reply = refused ? nack : zeros(type === StatusRequest.type ? StatusReply.size : ClearFaultReply.size);
      queueMicrotask(() => heard.bytes(encodeFrame(refused ? Nack.type : type | 0x80, seq, reply)));
    }),
    drive: () => undefined, release: () => undefined, history: () => Promise.resolve(zeros(0)),
  });
  heard.driver({ you: true, free: false, verb: null });
  session.link = { open: true, port: "here", sentence: "" };
  const clear = async (): Promise<string> => {
    await session.attempt(() => session.clearFault());
    return session.notice?.sentence ?? "";
  };
  assert.match(await clear(), /^The board refused "clear fault": .*\(follower potentiometer 1\)/);
  mended = true;
  assert.equal(await clear(), "");
  session.tell("The log begins later.");
  assert.equal(await clear(), "The log begins later.");
});

test("what was told of the link is taken back when it holds no more, and nothing else is", ({ mock }) => {
  mock.timers.enable({ apis: ["setInterval", "setTimeout"] });
  let heard!: BoardListener;
  const session = new Session({
    listen: (listener) => { heard = listener; }, send: () => undefined, drive: () => undefined, release: () => undefined,
    history: () => Promise.resolve(zeros(0)),
  });
  session.hello = HelloReply.unpack(zeros(HelloReply.size));
  session.link = { open: true, port: "here", sentence: "" };
  const silent = { open: true, port: "here", sentence: "The board is silent: is its supply on?" };
  const told = (): string | undefined => session.notice?.sentence;
  heard.link(silent);
  assert.equal(told(), silent.sentence);
  heard.link({ ...silent, sentence: "" });
  assert.equal(told(), undefined);
  heard.link(silent);
  session.tell("The log begins later.");
  heard.link({ ...silent, sentence: "" });
  assert.equal(told(), "The log begins later.");
});
