// The bench inside the page: its clock, what a browser keeps, and a life with the module and data in the folder that SITE
// names.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { encodeFrame, FrameDecoder } from "../src/link/frames";
import { EnableRequest, Fault, HelloReply, LeadRequest, Sample, State, TelemetryRequest } from "../src/link/schema";
import type { BenchData } from "../src/sources/in_page/messages";
import { Clock } from "../src/sources/in_page/clock";
import { Store } from "../src/parts/storage";
import { keepEeprom, keptEeprom } from "../src/sources/in_page/eeprom";
import { BenchLoop } from "../src/sources/in_page/bench_loop";
import { BenchModule } from "../src/sources/in_page/module";
import { readImage } from "../src/sources/serial/flash/image";

const site = process.env["SITE"] ?? "";
const data = JSON.parse(readFileSync(join(site, "bench.json"), "utf8")) as BenchData;
const { memory: firmware } = readImage({ name: "mega.hex", text: readFileSync(join(site, "mega.hex"), "utf8") });

/** A life and what its board has said. */
async function rig() {
  const module = await BenchModule.load(readFileSync(join(site, "bench.wasm")), data.numbers, data.bootloader, firmware);
  const life = new BenchLoop(module, data);
  const decoder = new FrameDecoder();
  const samples: Sample[] = [];
  let hellos = 0;
  const pass = (ticks: number): Sample => {
    for (; ticks; ticks--) {
      decoder.feed(life.tick(), ({ type, payload }) => {
        if (type === Sample.type) samples.push(Sample.unpack(payload));
        if (type === HelloReply.type) hellos++;
      });
    }
    return samples.at(-1)!;
  };
  const watch = (): void => life.send(encodeFrame(TelemetryRequest.type, 1, TelemetryRequest.pack({ every: 1 })));
  const start = (): void => {
    watch();
    life.send(encodeFrame(EnableRequest.type, 1, EnableRequest.pack({ lease_ms: 300 })));
  };
  life.start();
  return { life, module, pass, samples, watch, start, hellos: () => hellos };
}

test("a clock owes what passed, at any speed, and gives up what is more than a second", () => {
  const clock = new Clock();
  assert.equal(clock.due(1000, 1), 0);
  assert.equal(clock.due(1004.5, 1), 4);
  assert.equal(clock.due(1005, 1), 1);
  assert.equal(clock.due(1015, 0.25), 2);
  assert.equal(clock.due(1025, 10), 100);
  assert.equal(clock.due(1525, 1), 500);
  assert.equal(clock.due(9000, 1), 1000);
  clock.owe(300);
  assert.equal(clock.due(9001, 1), 301);
  clock.owe(900);
  assert.equal(clock.due(9500, 1), 1000);
  clock.hold();
  assert.equal(clock.due(20_000, 1), 0);
});

test("a hand leads, holds, and takes up other motions from where it is; unknown ones and mistakes are refused", async () => {
  const { life, pass, samples, start } = await rig();
  start();
  life.change({ leader: [0.5, 0.4, -0.3, 0.2] });
  const { leader } = pass(2000);
  [0.5, 0.4, -0.3, 0.2].forEach((angle, joint) => assert.ok(Math.abs(leader[joint]! - angle * 4096) < 60));
  for (const motion of ["reaches", "steps"]) {
    const from = samples.length;
    life.change({ motion });
    assert.equal(pass(1500).state, State.is.following);
    const moved = samples.slice(from).map(({ leader: now }, at) => Math.abs(now[0]! - samples[from + at - 1]!.leader[0]!) / 4096);
    assert.ok(Math.max(...moved) < 0.01, "no jump"); // rad in a tick: a hand's speed, and noise
  }
  life.change({ motion: "hold" });
  const held = pass(1000);
  assert.ok(pass(1000).leader.every((angle, joint) => Math.abs(angle - held.leader[joint]!) < 60));
  assert.throws(() => life.change({ motion: "log.csv" }), /no motion "log.csv"/);
  for (const wrong of ["pot-open", "pot-open:elbow", "no-such"]) {
    assert.throws(() => life.change({ fault: wrong }), /no mistake of this bench/);
  }
});

test("hands turn one joint, hold a pose and let the follower hang, while the motors are off", async () => {
  const { life, module, pass, watch, start } = await rig();
  watch();
  pass(1000);
  let left = 1000 * life.change({ turn: 6 });
  const joints = ({ leader, follower }: Sample): number[] => [...leader, ...follower];
  const first = joints(pass(20));
  const seen: number[][] = [];
  for (; left > 0; left -= 20) seen.push(joints(pass(20)).map((angle, pot) => (angle - first[pot]!) / 4096));
  const turned = seen.map((one) => one[6]!);
  const [most, least] = [Math.max(...turned), Math.min(...turned)];
  assert.ok(most - least > 2.4 && turned.indexOf(most) < turned.indexOf(least));
  assert.ok(seen.every((one) => one.every((angle, pot) => pot === 6 || Math.abs(angle) < 0.03)));
  life.change({ pose: [0.5, 0.4, -0.3, 0.2] });
  assert.throws(() => life.change({ turn: 0 }), /one thing after the other/);
  pass(1100);
  module.call("look");
  [0.5, 0.4, -0.3, 0.2].forEach((angle, joint) => assert.ok(Math.abs(module.leader()[joint]! - angle) < 1e-9));
  const hangs = pass(1000 * life.change({ hang: true }) + 100);
  assert.ok(Math.abs(hangs.follower[1]! / 4096 + (80 * Math.PI) / 180) < 0.03);
  life.change({ pose: [0, 0, 0, 0] });
  pass(1500);
  start();
  assert.equal(pass(1500).state, State.is.following);
  for (const wish of [{ turn: 0 }, { pose: [0, 0, 0, 0] }, { hang: true } as const]) {
    assert.throws(() => life.change(wish), /only while the motors are off/);
  }
});

test("a lead is a pulse, which ends by its own lease", async () => {
  const { life, pass, watch } = await rig();
  watch();
  pass(1000);
  life.send(encodeFrame(LeadRequest.type, 2, LeadRequest.pack({ lease_ms: 160 })));
  assert.notEqual(pass(150).state, State.is.disabled);
  assert.equal(pass(20).state, State.is.disabled);
});

test("power, supply and emergency stop do what they say", async () => {
  const { life, module, pass, start, hellos } = await rig();
  start();
  pass(1500);
  life.change({ estop: true });
  assert.equal(pass(50).fault, Fault.is.estop);
  life.change({ estop: false });
  assert.equal(life.restarted(), false);
  const before = hellos();
  life.change({ power: false });
  pass(50);
  life.change({ power: true });
  pass(1000); // the bootloader waits for a host at first
  assert.ok(life.restarted());
  assert.equal(hellos(), before + 1);
  life.change({ fault: "brown-out" });
  start();
  pass(2000);
  assert.ok(life.restarted() && module.call("powered"));
  life.change({ speed: 2.5 });
  assert.equal(life.speed, 2.5);
  assert.throws(() => life.change({ supply: 31 }), /The supply is 31 V; choose one from 0 to 30/);
  assert.throws(() => life.change({ load: Number.NaN }), /The load is NaN kg/);
});

test("noise grows with its factor, or is none", async () => {
  const { life, pass, start } = await rig();
  const swing = (): number => {
    const angles = Array.from({ length: 500 }, () => pass(1).leader[0]!);
    return Math.max(...angles) - Math.min(...angles);
  };
  life.change({ motion: "hold" });
  start();
  pass(1500);
  const usual = swing();
  life.change({ noise: 0 });
  pass(20);
  assert.equal(swing(), 0);
  life.change({ noise: 10 });
  assert.ok(swing() > 5 * usual);
});

test("play in the gears lets a joint run past its goal", async () => {
  const past = async (play: number): Promise<number> => {
    const { life, pass, start } = await rig();
    life.change({ play });
    life.change({ leader: [0, 0, 0, 0] });
    start();
    pass(1500);
    life.change({ leader: [0, 0.7, 0.3, 0.5] });
    return Math.max(...Array.from({ length: 3000 }, () => pass(1).follower[3]!)) - 0.5 * 4096;
  };
  assert.ok(await past(10) > 100 + await past(0));
  await assert.rejects(() => past(11), /The play is 11 times; choose one from 0 to 10/);
});

/** A browser's store with room for so many letters, which it counts as browsers do. */
function storage(kept: Map<string, string>, room = Infinity): Store {
  const size = (): number => [...kept].flat().join("").length;
  return new Store(() => ({
    getItem: (key: string) => kept.get(key) ?? null,
    setItem: (key: string, text: string) => {
      if (size() - (kept.has(key) ? `${key}${kept.get(key)!}`.length : 0) + `${key}${text}`.length > room) throw new Error("full");
      kept.set(key, text);
    },
    removeItem: (key: string) => void kept.delete(key),
  } as Storage));
}

const FORBIDDEN = [new Store(() => null), new Store(() => { throw new Error("denied"); })];

test("a browser keeps the board's memory; what is damaged is told and set aside", () => {
  const kept = new Map<string, string>();
  const content = Uint8Array.from({ length: 4096 }, (_, place) => place * 7);
  assert.deepEqual(keptEeprom(storage(kept)), { content: null, sentence: "" });
  assert.ok(keepEeprom(storage(kept), content));
  assert.deepEqual(keptEeprom(storage(kept)).content, content);
  const [[key, whole]] = [...kept] as [[string, string]];
  for (const damaged of [whole.replace("07", "08"), whole.slice(2), `${"00".repeat(2000)} 1`, "", "é 0"]) {
    kept.set(key, damaged);
    const found = keptEeprom(storage(kept));
    assert.ok(found.content === null && found.sentence.includes("set aside"), damaged);
    assert.deepEqual([kept.get(key), [...kept.values()]], [undefined, [damaged]]);
  }
});

test("a full store loses nothing, and a forbidden one is told", () => {
  const content = new Uint8Array(4096);
  for (const [room, sentence] of [[9, "is set aside as"], [1, "stays until the board stores anew"]] as const) {
    const kept = new Map([["greywhale-eeprom-mega", "damaged"], ["other", "x".repeat(3000)]]);
    const full = storage(kept, [...kept].flat().join("").length + room);
    const found = keptEeprom(full);
    assert.ok(found.content === null && found.sentence.includes(sentence));
    assert.ok([...kept.values()].includes("damaged"));
    assert.equal(keepEeprom(full, content), false);
    assert.ok([...kept.values()].includes("damaged"));
  }
  for (const store of FORBIDDEN) {
    assert.match(keptEeprom(store).sentence, /keeps nothing/);
    assert.deepEqual([store.read("a"), store.write("a", "b"), store.move("a", "b"), keepEeprom(store, content)], [null, false, false, false]);
  }
});
