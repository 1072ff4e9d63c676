// A sweep and two poses give the raw values that the host works out, or its sentence.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { countsOf, solve, type Ends, type Pose } from "../src/calibrate/solve";
import { TABLE } from "../src/link/schema";

type Case = { sweep: Ends[]; first: Pose; second: Pose; raw: Record<string, number> | null; error: string };
const cases = JSON.parse(readFileSync(process.env["CALIBRATIONS"]!, "utf8")) as Case[];

test("zeros, scales and limits are the host's", () => {
  for (const { sweep, first, second, raw, error } of cases) {
    if (raw) assert.deepEqual(Object.fromEntries(solve(sweep, first, second, [0, 1, 2, 3])), raw);
    else assert.throws(() => solve(sweep, first, second, [0, 1, 2, 3]), ({ message }: Error) => message.slice(1) === error.slice(1));
  }
});

test("a sweep that hardly moved and a reading at a rail are refused", () => {
  const { sweep, first, second } = cases[0]!;
  const refused = (pot: number, ends: Ends): string => {
    try {
      solve(sweep.map((one, place) => (place === pot ? ends : one)), first, second, [0, 1, 2, 3]);
    } catch (error) {
      return (error as Error).message;
    }
    return "";
  };
  assert.match(refused(5, { low: 500, high: 530 }), /^Follower potentiometer 1 was hardly turned/);
  assert.match(refused(0, { low: 2, high: 900 }), /^Leader potentiometer 0 reads 2..900 of 1023, at a rail/);
});

test("counts are those of the converter, whatever set the angle came from", () => {
  const raw = TABLE.parameters.map(({ initial }) => initial);
  assert.equal(countsOf(0, 0, raw), 8184 / 16);
  raw[TABLE.named("leader0.scale").index] = -5367;
  assert.equal(countsOf(-4096, 0, raw).toFixed(3), (8184 / 16 + (4096 * 8192) / 5367 / 16).toFixed(3));
});
