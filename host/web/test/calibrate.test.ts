// Sweeps, poses and pulses are judged as the host judges them: the same values, or the same sentence.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { examineMotor, remarks, type Motor } from "../src/views/calibrate/motors";
import { pulseSet } from "../src/views/calibrate/pulses";
import { apartIn, changesOf, countsOf, requireNoSlip, solve, type Pose } from "../src/views/calibrate/solve";
import { judgeSweep, type Sweep } from "../src/views/calibrate/sweep";
import { TABLE } from "../src/link/schema";

type Solved = { sweeps: Sweep[]; first: Pose; second: Pose; raw: Record<string, number> | null; error: string };
type Swept = { counts: number[][]; pot: number; sweep: ReturnType<typeof judgeSweep> };
type Tried = { joint: number; pulses: { way: number; moved: number[] }[]; motor: Motor | null; error: string };
type Given = { solved: Solved[]; swept: Swept[]; tried: Tried[]; remarks: { motors: Motor[]; remarks: string[] }[]; pulse_set: number[] };
const given = JSON.parse(readFileSync(process.env["CALIBRATIONS"]!, "utf8")) as Given;
const { solved, swept } = given;
const DEFAULTS = TABLE.parameters.map(({ initial }) => initial);
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

test("a motor's direction, and what is wrong with it, from the same pulses", async () => {
  for (const { joint, pulses, motor, error } of given.tried) {
    let number = 0;
    const pulse = async (_: number, way: number): Promise<number[]> => {
      assert.equal(way, pulses[number]!.way);
      return pulses[number++]!.moved;
    };
    if (motor) assert.deepEqual(await examineMotor(pulse, 15, joint), motor);
    else await assert.rejects(examineMotor(pulse, 15, joint), as(error));
    assert.equal(number, pulses.length);
  }
  for (const { motors, remarks: told } of given.remarks) assert.deepEqual(remarks(motors, 15), told);
  assert.deepEqual(pulseSet(DEFAULTS, 2, 2.5), given.pulse_set);
});

test("counts are those of the converter, whatever set the angle came from", () => {
  const raw = [...DEFAULTS];
  assert.equal(countsOf(0, 0, raw), 8184 / 16);
  raw[TABLE.named("leader0.scale").index] = -5367;
  assert.equal(countsOf(-4096, 0, raw).toFixed(3), (8184 / 16 + (4096 * 8192) / 5367 / 16).toFixed(3));
});
