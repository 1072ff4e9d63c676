// A recording of a leader's motion: what a log holds is led again, and what is wrong in a file is told with its line.
import assert from "node:assert/strict";
import { test } from "node:test";
import { poseIn, readRecording } from "../src/files/recording";

const HEADER = "time_s,leader_0,leader_1,leader_2,leader_3,follower_0\n";
const read = (text: string) => readRecording({ name: "hand.csv", text }, async () => undefined);

test("a log's leader comes back at any time between its rows, and ends with them", async () => {
  const recording = await read(`# greywhale log\n${HEADER}5.0,0,0.1,0.2,0.3,9\n5.5,1,0.1,-0.2,0.3,9\n7.0,1,0.1,-0.2,0,9\n`);
  assert.deepEqual(poseIn(recording, 0), [0, 0.1, 0.2, 0.3]);
  assert.deepEqual(poseIn(recording, 0.25)!.map((angle) => Number(angle.toFixed(9))), [0.5, 0.1, 0, 0.3]);
  assert.deepEqual(poseIn(recording, 2), [1, 0.1, -0.2, 0]);
  assert.equal(poseIn(recording, 2.001), null);
});

test("whatever is wrong in a recording is named with its line", async () => {
  for (const [text, sentence] of [
    ["a,b\n", /has no column time_s/],
    ["", /holds no motion/],
    [`${HEADER}0,0,0,0,0,0\n`, /two or more rows/],
    [`${HEADER}0,0,0,0,0,0\n1,0,0,x,0,0\n`, /line 3: "x" is no number for leader_2/],
    [`${HEADER}0,0,0,0,0,0\n1,0,0\n`, /line 3: "" is no number for leader_2/],
    [`${HEADER}1,0,0,0,0,0\n1,0,0,0,0,0\n`, /line 3: time_s does not grow/],
  ] as const) {
    await assert.rejects(read(text), sentence);
  }
});
