// A controller.toml gives the raw values that the host finds in it, or is refused in the host's words.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { controllerIn } from "../src/files/controller_file";

type Case = { text: string; raw: Record<string, number> | null; error: string };
const cases = JSON.parse(readFileSync(process.env["CONTROLLER_FILES"]!, "utf8")) as Case[];

test("each file is read or refused as the host does", () => {
  assert.ok(cases.length > 30);
  for (const { text, raw, error } of cases) {
    let told = "";
    try {
      assert.deepEqual(Object.fromEntries(controllerIn({ name: "c.toml", text })), raw);
    } catch (problem) {
      if (raw) throw problem;
      told = (problem as Error).message;
    }
    // Where a file is no TOML, each parser has words of its own for the reason.
    const same = error.startsWith("c.toml: not valid TOML") && !error.includes("CSV") ? [told.slice(0, 22), error.slice(0, 22)] : [told, error];
    assert.equal(same[0], same[1], text.slice(0, 400));
  }
});
