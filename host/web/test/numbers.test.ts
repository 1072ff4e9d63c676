// The numbers of controllers as people read them.
import assert from "node:assert/strict";
import { test } from "node:test";
import { TABLE } from "../src/link/schema";
import { SETTING_NAMES } from "../src/session/law";
import { changeOf, textOf, told } from "../src/views/controller/numbers";

const raw = (name: string, value: number): number => Math.round(value / TABLE.named(`joint0.${name}`).lsb);

test("four digits are shown, and of a change as many as tell both apart", () => {
  assert.deepEqual([textOf("ze_a", raw("ze_a", -0.249939)), textOf("ku_mv", 11_873), textOf("ce_ticks", 7)], ["-0.2499", "11.87", "7"]);
  assert.equal(changeOf("kp", raw("kp", 0.513), raw("kp", 0.75)), "0.513 → 0.75");
  assert.equal(changeOf("ku_mv", 15_000, 15_000), "15");
  for (const name of SETTING_NAMES) {
    const { maximum } = TABLE.named(`joint0.${name}`);
    const [from, to] = changeOf(name, maximum - 1, maximum).split(" → ").map(Number) as [number, number];
    assert.ok(from < to, `${name}: the nearest two of its largest values`);
    assert.equal(Math.round(to / told(name).step), maximum);
  }
});
