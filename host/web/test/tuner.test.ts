// The tuner's search against greywhale tune's own (JSON in the file that TUNING names), with the module and data in the
// folder that SITE names.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import type { Controllers, TunerData } from "../src/tuner/data";
import { Judge } from "../src/tuner/judge";
import { TunerModule } from "../src/tuner/module";
import { Search } from "../src/tuner/search";
import { Tuning } from "../src/tuner/tuning";

type Golden = {
  pack: number; budget: number; before: Controllers; best: Controllers; curve: unknown; judged: Controllers[]; short: number[][];
};

function json<T>(path: string): T {
  return JSON.parse(readFileSync(path, "utf8")) as T;
}

const site = process.env["SITE"] ?? "";
const golden = json<Golden>(process.env["TUNING"] ?? "");
const shipped = json<TunerData>(join(site, "tuner.json"));
const data = { ...shipped, search: { ...shipped.search, pack: golden.pack, budget: golden.budget } };
const module = await TunerModule.load(readFileSync(join(site, "tuner.wasm")), data);
const judge = new Judge(module, data, golden.before);

test("every cost and the best controllers of a search have the bits of greywhale tune's", () => {
  const search = new Search(data.search, golden.before, module, (rows, refine) => judge.costs(rows, refine));
  for (const _ of search.run());
  assert.deepEqual([search.best, search.curve], [golden.best, golden.curve]);
});

test("the same joints fall short of what held before", () => {
  assert.deepEqual(golden.judged.map((one) => judge.short(one)), golden.short);
  assert.ok(golden.short.some(({ length }) => length) && golden.short.some(({ length }) => !length));
});

test("another judge of the same module begins anew, and refuses limits of another version", () => {
  const costs = judge.costs(golden.judged, true);
  assert.deepEqual(new Judge(module, data, golden.before).costs(golden.judged, true), costs);
  assert.throws(() => new Judge(module, { ...data, limits: data.limits.slice(1) }, golden.before), /two versions/);
});

test("a search that is ended at once leaves the controllers as they are, and shows them twice", () => {
  const tuning = new Tuning(module, data, golden.before);
  tuning.run().next();
  const { before, after, notes, followers: [first, second], mse } = tuning.result();
  assert.deepEqual([before, after, notes, second, mse[1]], [golden.before, golden.before, [], first, mse[0]]);
});
