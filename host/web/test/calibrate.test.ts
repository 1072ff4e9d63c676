// Sweeps, poses and pulses are judged as the host judges them: the same values, or the same sentence.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { apartIn, changesOf, countsOf, requireNoSlip, solve, type Pose } from "../src/calibrate/solve";
import { judgeSweep, type Sweep } from "../src/calibrate/sweep";
import { TABLE } from "../src/link/schema";

type Solved = { sweeps: Sweep[]; first: Pose; second: Pose; raw: Record<string, number> | null; error: string };
type Swept = { counts: number[][]; pot: number; sweep: ReturnType<typeof judgeSweep> };
const { solved, swept } = JSON.parse(readFileSync(process.env["CALIBRATIONS"]!, "utf8")) as { solved: Solved[]; swept: Swept[] };
const ALL = [0, 1, 2, 3];
/** The host's sentence begins with its port, or small. */
const as = (error: string) => ({ message }: Error): boolean => message.slice(1) === error.slice(1);

test("what a sweep shows, and each mistake", () => {
  for (const { counts, pot, sweep } of swept) assert.deepEqual(judgeSweep(counts.map((column) => Float64Array.from(column)), pot), sweep);
});

test("zeros, scales and limits", () => {
  for (const { sweeps, first, second, raw, error } of solved) {
    if (raw) assert.deepEqual(Object.fromEntries(changesOf(solve(sweeps, first, second, ALL))), raw);
    else assert.throws(() => solve(sweeps, first, second, ALL), as(error));
  }
});

test("a shaft that slipped and arms that differ are told by the poses after", () => {
  const { sweeps, first, second } = solved[0]!;
  const off = (pot: number, count: number): Pose => ({ ...second, counts: second.counts.map((one, at) => (at === pot ? one + count : one)) });
  assert.throws(() => requireNoSlip(second, off(6, 9)), /^Error: Follower potentiometer 2 reads 9 counts elsewhere in the same pose/);
  requireNoSlip(second, off(6, 8));
  const found = solve(sweeps, first, second, ALL);
  assert.throws(() => apartIn(found, off(1, 60), ALL), /^Error: Held in the same pose, leader and follower differ by 0.\d\d rad at joint 1/);
  assert.ok(apartIn(found, off(1, 10), ALL)[1]! > 0.03);
});

test("counts are those of the converter, whatever set the angle came from", () => {
  const raw = TABLE.parameters.map(({ initial }) => initial);
  assert.equal(countsOf(0, 0, raw), 8184 / 16);
  raw[TABLE.named("leader0.scale").index] = -5367;
  assert.equal(countsOf(-4096, 0, raw).toFixed(3), (8184 / 16 + (4096 * 8192) / 5367 / 16).toFixed(3));
});
