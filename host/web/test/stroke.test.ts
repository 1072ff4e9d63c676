// A motion that a person draws: straight between the places of the pen, and as it was drawn where it is played.
import assert from "node:assert/strict";
import { test } from "node:test";
import { angleAt, shareOf } from "../src/views/bench/limits";
import { Stroke } from "../src/views/bench/stroke";

test("a stroke is played as it was drawn, up and down, and held beyond its ends", () => {
  const stroke = new Stroke(101);
  assert.equal(stroke.at(0.5), null);
  for (const [share, angle] of [[0.2, 0], [0.6, 2], [0.8, -1]] as const) stroke.drawTo(share, angle);
  const told = [0, 0.2, 0.3, 0.4, 0.6, 0.7, 0.8, 1].map((share) => stroke.at(share)!);
  [0, 0, 0.5, 1, 2, 0.5, -1, -1].forEach((angle, place) => assert.ok(Math.abs(told[place]! - angle) < 1e-9, String(told)));
  stroke.lift();
  stroke.drawTo(1, 3);
  assert.equal(stroke.angles[95], null, "a new stroke begins where the pen comes down");
  stroke.drawTo(0.7, 3);
  assert.equal(stroke.at(0.75), 3, "backwards it is drawn over");
  stroke.clear();
  assert.ok(stroke.empty);
});

test("angles and shares of a range are each other's inverse, and end at its ends", () => {
  const limits = { minimum: [-1, 0], maximum: [3, 2] };
  assert.equal(angleAt(limits, 0, 0.25), 0);
  assert.equal(shareOf(limits, 0, angleAt(limits, 0, 0.75)), 0.75);
  assert.equal(angleAt(limits, 1, 7), 2);
  assert.equal(shareOf(limits, 1, -5), 0);
});
