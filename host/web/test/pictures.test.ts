// How often the page draws: each picture of the screen where that is quick, and never for much more than half of the time.
import assert from "node:assert/strict";
import { test } from "node:test";
import { drawPictures, type Screen } from "../src/parts/pictures";

const FRAME_MS = 16;

/** How many pictures are drawn in a second of a screen on which each takes so long. */
function drawn(costMs: number): number {
  let [now, count] = [0, 0];
  let next: () => void = () => undefined;
  const painted: (() => void)[] = [];
  const screen: Screen = { now: () => now, next: (act) => { next = act; }, painted: (act) => { painted.push(act); } };
  drawPictures(() => { count++; now += costMs; }, screen);
  while (now < 1000) {
    next();
    for (const act of painted.splice(0)) act();
    now = FRAME_MS * Math.floor(now / FRAME_MS + 1);
  }
  return count;
}

test("a quick picture is drawn each time, a slow one in half of the time", () => {
  for (const quick of [0, 4, 15]) assert.equal(drawn(quick), Math.ceil(1000 / FRAME_MS), `${quick} ms`);
  for (const slow of [20, 60, 150, 300]) {
    const share = (drawn(slow) * slow) / 1000;
    assert.ok(share > 0.3 && share < 0.65, `${slow} ms: ${share}`);
  }
});
