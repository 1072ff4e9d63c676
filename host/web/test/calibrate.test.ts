// The rules of a calibration answer the page what they answer Python, and the page asks them in their order.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { potReading } from "../src/session/pots";
import { Samples } from "../src/session/samples";
import { Rules, type Pose, type Sweep } from "../src/views/calibrate/rules";
import { Sample, State, TABLE } from "../src/link/schema";

type Asked = { rule: string; given: number[]; numbers: number[]; words: string };
const given = JSON.parse(readFileSync(process.env["CALIBRATIONS"]!, "utf8")) as { asked: Asked[]; pulse_set: number[] };
const rules = await Rules.load(readFileSync(join(process.env["SITE"]!, "calibration.wasm")));
const DEFAULTS = TABLE.parameters.map(({ initial }) => initial);
const ALL = [0, 1, 2, 3];

test("each rule answers the same numbers and words in both", () => {
  for (const { rule, given: numbers, ...answer } of given.asked) assert.deepEqual(rules.ask(rule, numbers), answer, rule);
});

// Potentiometers that are mounted alike, but for the leader's at joint 1, which is the other way round.
const scale = [0, 1, 2, 3, 4, 5, 6, 7].map((pot) => (pot === 1 ? -0.005 : 0.005));
const pose = (angle: number): Pose => ({ angles: ALL.map(() => angle), counts: scale.map((one) => 512 + angle / one) });
const sweeps: Sweep[] = scale.map((one) => ({ direction: Math.sign(one), low: 312, high: 712 }));
const off = ({ angles, counts }: Pose, pot: number, count: number): Pose => ({ angles, counts: counts.map((one, at) => (at === pot ? one + count : one)) });

test("zeros, scales and limits by the names of their parameters", () => {
  const found = rules.changesOf(rules.solve(sweeps, pose(0), pose(1), ALL), ALL);
  assert.equal(found.size, 24);
  for (const pot of ["leader1", "follower3"]) assert.equal(found.get(`${pot}.zero`), 512 * 16);
  assert.equal(found.get("leader1.scale"), -Math.floor((0.005 / 16) * 2 ** 25 + 0.5));
  assert.equal(found.get("joint2.limit_max"), Math.floor(0.97 * 4096 + 0.5));
  const two = rules.changesOf(rules.solve(sweeps.map((sweep, pot) => (pot % 4 < 2 ? sweep : null)), pose(0), pose(1), [0, 1]), [0, 1]);
  assert.deepEqual([...two.keys()].filter((name) => name.startsWith("follower")), ["follower0.zero", "follower0.scale", "follower1.zero", "follower1.scale"]);
});

test("poses that contradict each other are refused in sentences", () => {
  assert.throws(() => rules.solve(sweeps, pose(0), pose(0.2), ALL), /^Error: The two poses differ by 0.2 rad at joint 0; choose a second pose/);
  assert.throws(() => rules.requireNoSlip(pose(0), off(off(pose(0), 6, 9), 1, 9)), /^Error: Elsewhere than in the first pose: leader potentiometer 1 \(by 9 counts\), follower potentiometer 2 /);
  rules.requireNoSlip(pose(0), off(pose(0), 6, 8));
  const found = rules.solve(sweeps, pose(0), pose(1), ALL);
  assert.throws(() => rules.apartIn(found, off(pose(0.5), 1, 60), ALL), /^Error: Held in the same pose, leader and follower differ by 0.30 rad at joint 1/);
  assert.ok(Math.abs(rules.apartIn(found, off(pose(0.5), 1, 10), ALL)[1]! - 0.05) < 1e-12);
});

test("without a known second pose the tracks have the length that is given, and the follower is made to fit", () => {
  const same = { angles: ALL.map(() => 0), counts: pose(0.8).counts.map((count, pot) => (pot < 4 ? count : 512 + 0.9 * (count - 512))) };
  const { scale: found } = rules.match(sweeps, pose(0), same, 0.005 * 1023, ALL);
  found.forEach((one, pot) => assert.ok(Math.abs(one - scale[pot]! / (pot < 4 ? 1 : 0.9)) < 1e-12));
});

test("a motor is pulsed until it moves its joint, or another one", async () => {
  const pulses: (readonly [number, number])[] = [];
  const moves = (moved: number, least: number) => async (volts: number, way: number): Promise<number[]> => {
    pulses.push([volts, way]);
    return ALL.map((joint) => (joint === moved && volts > least ? -0.02 * volts * way : 0));
  };
  const { way, ...motor } = await rules.motor(moves(3, 2), 15, 3);
  const [weak, enough] = [0.1 * 15, 0.17 * 15];
  assert.deepEqual(motor, { joint: 3, sign: -1, volts: enough });
  assert.ok(Math.abs(way - 0.051) < 1e-12);
  assert.deepEqual(pulses.map(([volts, sent]) => volts * sent), [weak, -weak, enough, -enough, -enough, enough]);
  await assert.rejects(rules.motor(moves(2, 0), 15, 1), /^Error: The motor of joint 1 moved joint 2: their motors/);
  assert.deepEqual(rules.pulse(DEFAULTS, 2, 2.5).set, given.pulse_set);
});

test("counts are those of the converter, whatever set the angle came from", () => {
  const raw = [...DEFAULTS];
  raw[TABLE.named("leader0.scale").index] = -5367;
  const [leader, other] = rules.counts([-4096, 0, 0, 0, 0, 0, 0, 0], raw);
  assert.equal(leader!.toFixed(3), (8184 / 16 + (4096 * 8192) / 5367 / 16).toFixed(3));
  assert.equal(other, 8184 / 16);
});

test("a potentiometer reads what the rules say, in degrees once it is calibrated, and a rail is marked", () => {
  const raw = [...DEFAULTS];
  for (const [name, value] of [["leader0.scale", -9000], ["leader0.zero", 6000], ["follower3.scale", 0]] as const) raw[TABLE.named(name).index] = value;
  const samples = new Samples(64);
  const add = (leader: number[]): void => samples.add(Sample.pack({ tick: samples.end, state: State.is.disabled, fault: 0, leader, follower: [0, 0, 0, 0], voltage: [0, 0, 0, 0] }));
  add([-2048, 1024, 0, 0]);
  const counts = rules.counts([-2048, 1024, 0, 0, 0, 0, 0, 0], raw);
  const [mine, fresh] = [0, 1].map((pot) => potReading(samples, 0, pot, raw)!);
  assert.ok(Math.abs(mine!.counts - counts[0]!) < 1e-9 && Math.abs(fresh!.counts - counts[1]!) < 1e-9);
  assert.deepEqual([mine!.degrees?.toFixed(2), fresh!.degrees], ["-28.65", null]);
  assert.equal(potReading(samples, 0, 7, raw), null);
  add([0, 10724, -10724, 0]);
  assert.deepEqual([1, 2, 3].map((pot) => potReading(samples, 1, pot, raw)!.atRail), [true, true, false]);
});
