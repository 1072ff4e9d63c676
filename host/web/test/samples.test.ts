// Rings of samples, what charts make of them, triggers and the running measures.
import assert from "node:assert/strict";
import { test } from "node:test";
import { Sample } from "../src/link/schema";
import { Trigger } from "../src/views/live/trigger";
import { TimeWindow } from "../src/views/live/window";
import { delay, ripple } from "../src/session/measures";
import { draw, emptyPicture } from "../src/session/picture";
import { COUNT, Samples, samplesIn, traceOf } from "../src/session/samples";

function sample(tick: number, leader = 0, follower = 0, fault = 0): Uint8Array {
  return Sample.pack({
    tick, state: 3, fault, leader: [leader, 0, 0, 0], follower: [follower, 0, 0, 0], voltage: [tick % 7, 0, 0, 0],
  });
}

function filled(count: number, capacity = 6400): Samples {
  const samples = new Samples(capacity);
  for (let tick = 0; tick < count; tick++) samples.add(sample(tick, tick % 1000, 10));
  return samples;
}

test("rings keep the newest samples, their error, and what was lost", () => {
  const samples = filled(10_000);
  assert.ok(samples.end - samples.first > 6300 && samples.end - samples.first <= 6400);
  assert.equal(samples.count(9_999, traceOf("error", 0)), 989);
  assert.equal(samples.at(9_000), 9_000);
  samples.add(sample(10_004));
  assert.equal(samples.lost, 4);
  samples.add(sample(3)); // the board has started anew
  assert.equal(samples.lost, 4);
  assert.equal(samples.lastTime, 11_004);
});

test("zoomed in, a picture has each sample; zoomed out, the extremes of all of them", () => {
  const samples = filled(6_000);
  const picture = emptyPicture();
  draw(samples, 5_000, 5_100, 100, picture);
  assert.ok(picture.exact);
  assert.equal(picture.y[0]![picture.x.indexOf(5.05)], 50 * COUNT.leader);
  for (const columns of [20, 100, 1_000]) {
    draw(samples, 0, 6_000, columns, picture);
    assert.ok(!picture.exact && picture.x.length <= 4 * columns, `${columns}`);
    const drawn = picture.y[0]!.filter((value) => value !== null);
    assert.equal(Math.max(...drawn), 999 * COUNT.leader);
    assert.equal(Math.min(...drawn), 0);
    assert.ok(picture.x.every((x, i) => i === 0 || x >= picture.x[i - 1]!));
  }
});

test("a line breaks where samples are missing, also within a column", () => {
  const samples = filled(1_000);
  for (let tick = 3_000; tick < 4_000; tick++) samples.add(sample(tick));
  const picture = emptyPicture();
  for (const columns of [10, 50, 5_000]) {
    draw(samples, 0, 4_000, columns, picture);
    const broken = picture.x.filter((_, i) => picture.y[0]![i] === null);
    assert.equal(broken.length, 1);
    assert.ok(broken[0]! > 0.99 && broken[0]! < 3, `${columns}`);
  }
});

test("a log with a sample each 50 ticks is drawn without breaks but where samples are missing", () => {
  const ticks = Array.from({ length: 500 }, (_, number) => 50 * number + (number < 300 ? 0 : 5_000));
  const payloads = ticks.map((tick) => sample(tick, tick % 1000));
  const samples = samplesIn(Uint8Array.from(payloads.flatMap((payload) => [...payload])));
  assert.deepEqual([samples.end, samples.every, samples.lastTime], [500, 50, 29_950]);
  const picture = emptyPicture();
  for (const columns of [10, 100, 1_000]) {
    draw(samples, 0, 30_000, columns, picture);
    assert.equal(picture.y[0]!.filter((value) => value === null).length, 1);
  }
  assert.equal(samplesIn(new Uint8Array()).end, 0);
});

test("a window moves with the newest sample, and stays where somebody looks", () => {
  const samples = filled(6_000);
  const window = new TimeWindow(samples);
  window.setSpan(1_000);
  assert.deepEqual([window.begin, window.end], [4_999, 5_999]);
  window.pan(-1);
  samples.add(sample(6_000));
  assert.deepEqual([window.begin, window.end, window.live], [3_999, 4_999, false]);
  window.zoom(0.5, 4_499);
  assert.deepEqual([window.begin, window.end], [4_249, 4_749]);
  window.pan(100);
  assert.ok(window.live);
});

test("triggers fire once, at the sample that fulfils them", () => {
  const samples = new Samples(640);
  const at = 500 * COUNT.leader;
  const rising = new Trigger(samples, { kind: "rising", quantity: "leader", joint: 0, at });
  const falling = new Trigger(samples, { kind: "falling", quantity: "leader", joint: 0, at });
  const fault = new Trigger(samples, { kind: "fault" });
  const level = new Trigger(samples, { kind: "level", quantity: "leader", joint: 0, at: -at });
  [0, 499, 600, 700, 400].forEach((leader, tick) => samples.add(sample(tick, leader, 0, tick === 3 ? 4 : 0)));
  assert.deepEqual([rising, falling, fault, level].map((one) => one.look()), [2, 4, 3, 2]);
  assert.equal(rising.look(), null);
});

test("delay and ripple of known signals", () => {
  const motion = (at: number): number => Math.sin(at / 300) + 0.3 * Math.sin(at / 110);
  const leader = Float64Array.from({ length: 9_000 }, (_, k) => motion(k));
  const follower = Float64Array.from({ length: 9_000 }, (_, k) => 0.8 * motion(k - 57) + 0.1);
  assert.ok(Math.abs(delay(leader, follower)! - 0.057) < 0.0005);
  assert.equal(delay(leader, new Float64Array(9_000)), null);
  const hum = Float64Array.from({ length: 5_000 }, (_, k) => 3 + Math.sin((2 * Math.PI * k) / 5));
  assert.ok(Math.abs(ripple(hum) - Math.SQRT1_2) < 0.01);
});
