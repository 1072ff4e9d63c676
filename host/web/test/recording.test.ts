// A recording of a leader's motion: what a log holds is led again, and what is wrong in a file is told with its line. An
// episode has the next number, and its task in the form that a spreadsheet leaves whole.
import assert from "node:assert/strict";
import { test } from "node:test";
import { logText, nextEpisode } from "../src/files/log";
import { poseIn, readRecording } from "../src/files/recording";
import { Samples } from "../src/session/samples";

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

test("an episode has the next number of its folder, and its task as the host writes it", () => {
  assert.equal(nextEpisode([]), "episode_000.csv");
  assert.equal(nextEpisode(["episode_009-2.csv", "sub/episode_050.csv", "episode_77.csv", "log.csv", "episode_004.unfinished.csv"]), "episode_010.csv");
  const log = logText(new Samples(64), 0, 0, { hello: null, raw: null }, { task: 'Put "\u676f",', cause: "Why." });
  assert.ok(log.includes('\n# task: "Put \\"\\u676f\\"\\u002c"\n'), log);
  assert.ok(log.includes("\n# recording: interrupted\n# ended_by: Why.\n"));
});
