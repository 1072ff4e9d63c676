// The page's predictions against the host's (JSON in the file that PREDICTIONS names), with the module and data in the
// folder that SITE names.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { armIn } from "../src/files/arm_file";
import { follows } from "../src/session/follows";
import type { Prediction } from "../src/session/services";
import type { TunerData } from "../src/tuner/data";
import { TunerModule } from "../src/tuner/module";
import { Foresight } from "../src/tuner/prediction";

type Case = {
  arm: string; raw: number[]; board: number; prediction: Prediction; answers: ([overshoot: number, settling: number | null] | null)[];
};

function json<T>(path: string): T {
  return JSON.parse(readFileSync(path, "utf8")) as T;
}

const { cases, spoilt } = json<{ cases: Case[]; spoilt: { text: string; error: string }[] }>(process.env["PREDICTIONS"] ?? "");
const site = process.env["SITE"] ?? "";
const data = json<TunerData>(join(site, "tuner.json"));
const foresight = new Foresight(await TunerModule.load(readFileSync(join(site, "tuner.wasm")), data), data.predicted);
const DIGIT = 1e-4; // rad: the last one of the angles that the host tells

test("every error has the bits of the host's, and every angle is the same to its last digit", () => {
  for (const { arm, raw, board, prediction } of [...cases, ...cases]) { // also where an experiment is there already
    const found = foresight.predict(raw, board, arm ? armIn({ name: "arm.toml", text: arm }).numbers : null);
    for (const motion of ["step", "reach"] as const) {
      const [ours, theirs] = [found[motion], prediction[motion]];
      assert.deepEqual(ours.mse, theirs.mse);
      const far = (side: "leader" | "follower"): number => Math.max(...ours[side].flatMap((row, place) =>
        row.map((angle, joint) => Math.abs(angle - theirs[side][place]![joint]!))));
      assert.equal(ours.time_s.length, theirs.time_s.length);
      assert.ok(Math.max(far("leader"), far("follower")) < 0.51 * DIGIT);
    }
  }
});

test("overshoot and settling time are those of a log", () => {
  for (const { prediction, answers } of cases) {
    follows(prediction).forEach(({ overshoot, settling }, joint) => {
      const [percent, seconds] = answers[joint]!;
      assert.ok(Math.abs(overshoot! - percent) < 1e-6, `${overshoot} and ${percent} %`);
      assert.equal(settling?.toFixed(3), seconds?.toFixed(3));
    });
  }
  assert.ok(cases.some(({ answers }) => answers.some((one) => one && one[0] > 1)));
});

test("an arm that the host refuses is refused with its sentence, and so is one with a fixed joint", () => {
  for (const { text, error } of spoilt) assert.throws(() => armIn({ name: "arm.toml", text }), { message: error });
  const [fixed] = cases.flatMap(({ arm }) => (arm ? [arm.replace("[[joint]]", "[[joint]]\nfixed = true")] : []));
  assert.throws(() => armIn({ name: "arm.toml", text: fixed! }), /joint\[0\] is fixed; this page predicts arms of four joints/);
});
