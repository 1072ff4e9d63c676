// The law, against numbers that greywhale/fuzzy made (JSON in the file that LAW names).
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { jointsOf } from "../src/views/controller/draft";
import { cornerRange, infer, inputs, refusal, SET_NAMES, type Settings } from "../src/session/law";
import { Refusal, TABLE } from "../src/link/schema";

type Case = { settings: Settings; period_ms: number; error: number; change: number; x: number; y: number; u: number };
type Refused = { settings: Settings; period_ms: number; refusal: number };
const law = JSON.parse(readFileSync(process.env["LAW"] ?? "", "utf8")) as { cases: Case[]; refused: Refused[] };

test("the law gives the exact law's numbers", () => {
  assert.ok(law.cases.length >= 200);
  for (const { settings, period_ms, error, change, x, y, u } of law.cases) {
    const [gotX, gotY] = inputs(error, change, settings, period_ms);
    const got = [gotX, gotY, infer(gotX, gotY, settings).u];
    [x, y, u].forEach((value, i) => assert.ok(Math.abs(got[i]! - value) < 1e-9, JSON.stringify({ settings, got, x, y, u })));
  }
});

test("what a board refuses is refused for the same reason", () => {
  for (const one of law.refused) assert.equal(refusal(one.settings, one.period_ms), one.refusal, JSON.stringify(one));
  assert.ok(new Set(law.refused.map((one) => one.refusal)).size === 6);
});

test("a corner dragged anywhere in its range is accepted", () => {
  const [joint] = jointsOf(TABLE.parameters.map(({ initial }) => initial));
  for (const name of SET_NAMES) {
    for (const value of cornerRange(name)) assert.equal(refusal({ ...joint!, [name]: value }, 1), Refusal.is.none);
  }
});
