// The calibrations that a page keeps where it has no host: none is lost, and going back changes nothing else.
import assert from "node:assert/strict";
import { test } from "node:test";
import { CALIBRATION } from "../src/files/rules";
import { TABLE } from "../src/link/schema";
import { Store } from "../src/parts/storage";
import { BrowserCalibrations } from "../src/sources/browser_calibrations";
import { withCalibration } from "../src/views/calibrate/earlier";

const KEY = "calibrations";
const DEFAULTS = TABLE.parameters.map(({ initial }) => initial);

/** A browser's storage, of so many letters. */
function storage(kept: Map<string, string>, most = Infinity): Store {
  return new Store(() => ({
    getItem: (key: string) => kept.get(key) ?? null,
    setItem: (key: string, text: string) => {
      if (text.length > most) throw new Error("full");
      kept.set(key, text);
    },
    removeItem: (key: string) => kept.delete(key),
  }) as unknown as Storage);
}

function changed(values: Readonly<Record<string, number>>): readonly number[] {
  const raw = [...DEFAULTS];
  for (const [name, value] of Object.entries(values)) raw[TABLE.named(name).index] = value;
  return raw;
}

test("each calibration is kept once, with what it changed", async () => {
  const own = new BrowserCalibrations(storage(new Map()), KEY);
  assert.deepEqual(await own.list(), []);
  await own.keep(DEFAULTS, 1, "found");
  await own.keep(changed({ "joint2.kp": 5 }), 1, "page");
  await own.keep(changed({ "joint2.limit_max": 4096, "joint1.motor_sign": -1 }), 1, "page");
  const found = await own.list();
  assert.deepEqual(found.map(({ number, why }) => [number, why]), [[1, "found"], [2, "page"]]);
  assert.deepEqual(found[1]!.changed, ["joint1.motor_sign 1 to -1", "joint2.limit_max 2.5 to 1 rad"]);
  assert.deepEqual(Object.keys(found[1]!.values).sort(), [...CALIBRATION].sort());
});

test("going back leaves all but the calibration", async () => {
  const own = new BrowserCalibrations(storage(new Map()), KEY);
  await own.keep(changed({ "leader0.zero": 8000, "joint2.kp": 7 }), 1, "found");
  const running = changed({ "joint2.kp": 5, "joint3.limit_min": -100 });
  const again = withCalibration(running, (await own.list())[0]!);
  assert.deepEqual(again, changed({ "joint2.kp": 5, "leader0.zero": 8000 }));
});

test("what somebody damaged is set aside, and a full browser loses none and stops nobody", async () => {
  for (const damaged of ["{", "{}", "[{}]", "null", '[{"when":"x","why":"page","values":{}}]']) {
    const kept = new Map([[KEY, damaged]]);
    const own = new BrowserCalibrations(storage(kept), KEY);
    assert.deepEqual(await own.list(), [], damaged);
    assert.equal(kept.get(`${KEY}-damaged`), damaged);
    await own.keep(DEFAULTS, 1, "found");
    assert.equal((await own.list()).length, 1);
  }
  const kept = new Map<string, string>();
  await new BrowserCalibrations(storage(kept), KEY).keep(DEFAULTS, 1, "found");
  const full = new BrowserCalibrations(storage(kept, kept.get(KEY)!.length + 1), KEY);
  await full.keep(changed({ "leader0.zero": 8000 }), 1, "page");
  assert.deepEqual((await full.list()).map(({ why }) => why), ["found"]);
  const none = new BrowserCalibrations(new Store(() => { throw new Error("forbidden"); }), KEY);
  await none.keep(DEFAULTS, 1, "found");
  assert.deepEqual(await none.list(), []);
});
