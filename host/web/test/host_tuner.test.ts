// The host's tuner: the verb's facts, one after the other, become a course, and its result the edited controllers.
import assert from "node:assert/strict";
import { test } from "node:test";
import { TABLE } from "../src/link/schema";
import { SETTING_NAMES } from "../src/session/law";
import type { HostState, Job, Jobs, Searched, Services } from "../src/session/services";
import { HostTuner } from "../src/sources/host_tuner";

const KP = SETTING_NAMES.indexOf("kp");
const LSB = TABLE.named("joint0.kp").lsb;
const edited = Array.from({ length: 4 }, () => SETTING_NAMES.map(() => 7));
const model = { name: "model.toml", identified: true, says: "" };
const first: Job = {
  kind: "job", id: "a", verb: "tune", arguments: {}, state: "running", progress: null, countdown: 0, telling: null, result: null, error: null,
  exit_code: null, said: [],
};
const evaluation = (size: number): object => ({ joints: [1, 2, 3, 4].map((joint) => ({ mse_rad2: joint * size })) });
const RESULT = {
  before: { "joint0.kp": 0.5 }, notes: ["Mind the step."],
  held_out: [{ motion: "steps" }, { motion: "human-like reaches", before: evaluation(2), after: evaluation(1) }],
  curves: [1, 2, 3, 4].map((joint) => ({ evaluations: [1, 8], cost: [1, joint / 10] })),
} as unknown as Job["result"];

/** A host on which the verb tells these facts. */
class Host {
  readonly started: (readonly [verb: string, given: unknown])[] = [];
  readonly stopped: string[] = [];
  readonly services: Pick<Services, "jobs" | "state" | "controller">;

  constructor(facts: readonly Partial<Job>[], files: readonly string[]) {
    let heard: (job: Job) => void = () => undefined;
    this.services = {
      jobs: {
        listen: (listener) => { heard = listener; },
        start: async (verb, given) => {
          this.started.push([verb, given]);
          let job = first;
          for (const fact of facts) heard(job = { ...job, ...fact }); // before the answer arrives
          heard({ ...job, id: "another's", state: "failed" });
          return "a";
        },
        stop: async (id) => void this.stopped.push(id),
      } as Partial<Jobs> as Jobs,
      state: async () => ({ files: files.map((name) => ({ name, kind: "controller" })) }) as unknown as HostState,
      controller: async (file) => ({ "joint0.kp": file.length, "joint2.ki": 3 }),
    };
  }
}

async function tuned(facts: readonly Partial<Job>[], files: readonly string[] = []): Promise<unknown> {
  const host = new Host(facts, files);
  const heard: Searched[] = [];
  const { before, after, mse, notes } = await new HostTuner(host.services).tune(edited, model, (searched) => heard.push(searched));
  return { started: host.started, heard, before: before[0]![KP], after: [after[0]![KP], after[1]![KP]], mse, notes };
}

test("the verb's file becomes the controllers, and its result says what came before and how far it errs", async () => {
  const found = await tuned([{ state: "done", progress: { done: 1, total: 1, text: "judging", note: "" }, result: RESULT }],
    ["controller.toml", "controller-2.toml"]) as { heard: Searched[] };
  assert.deepEqual({ ...found, heard: found.heard.at(-1)!.curve }, {
    started: [["tune", { model_file: "model.toml", out: "controller-3.toml" }]],
    heard: { unit: "sets", x: [1, 8], y: [[1, 0.1], [1, 0.2], [1, 0.3], [1, 0.4]] },
    before: Math.floor(0.5 / LSB + 0.5), after: ["controller-3.toml".length, 7],
    mse: [[2, 4, 6, 8], [1, 2, 3, 4]], notes: ["Written: controller-3.toml.", "Mind the step."],
  });
});

test("one that is stopped ends with the best so far, which its file has; one that fails says why", async () => {
  const error = "The best controllers so far are in controller.toml.";
  const found = await tuned([{ state: "stopped", error }]) as { after: number[]; notes: string[]; mse: unknown[] };
  assert.deepEqual([found.after[0], found.notes, found.mse], ["controller.toml".length, [error], []]);
  await assert.rejects(tuned([{ state: "failed", error: "model.toml: it is not validated; go on with --force." }]), /not validated/);
});

test("a model that nobody has identified is tuned by force, and a stop reaches the verb that runs", async () => {
  const host = new Host([{ state: "done", result: RESULT }], []);
  const tuner = new HostTuner(host.services);
  tuner.stop();
  await tuner.tune(edited, { ...model, name: "default", identified: false }, () => undefined);
  tuner.stop();
  assert.deepEqual([host.started[0], host.stopped], [["tune", { model_file: "default", out: "controller.toml", force: true }], ["a"]]);
});
