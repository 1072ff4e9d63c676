// A controller.toml and a parameter file give the raw values that the host finds in them, or are refused in the host's
// words; what the page writes, it reads.
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { controllerIn } from "../src/files/controller_file";
import { parameterFile, statedIn } from "../src/files/parameter_file";
import { TABLE } from "../src/link/schema";
import { namedText } from "../src/parts/named_text";
import type { NamedText } from "../src/parts/named_text";
import { readImage } from "../src/sources/serial/flash/image";

type Case<Raw> = { text: string; raw: Raw | null; error: string };

function compare<Raw>(given: string, read: (file: NamedText) => Raw): Case<Raw>[] {
  const cases = JSON.parse(readFileSync(process.env[given]!, "utf8")) as Case<Raw>[];
  assert.ok(cases.length > 20);
  for (const { text, raw, error } of cases) {
    let told = "";
    try {
      assert.deepEqual(read({ name: "c.toml", text }), raw);
    } catch (problem) {
      if (raw) throw problem;
      told = (problem as Error).message;
    }
    // Where a file is no TOML, each parser has words of its own for the reason.
    const same = error.startsWith("c.toml: not valid TOML") && !error.includes("CSV") ? [told.slice(0, 22), error.slice(0, 22)] : [told, error];
    assert.equal(same[0], same[1], text.slice(0, 400));
  }
  return cases;
}

test("each controller file is read or refused as the host does", () => {
  compare("CONTROLLER_FILES", (file) => Object.fromEntries(controllerIn(file)));
});

test("each parameter file is read or refused as the host does, and what is written is read", () => {
  const sound = compare("PARAMETER_FILES", (file) => [...statedIn(file)]).filter(({ raw }) => raw);
  assert.ok(sound.length > 5);
  const whole = sound.filter(({ raw }) => raw!.length === TABLE.parameters.length);
  assert.ok(whole.length > 2 && whole.length < sound.length, "files of older layouts state less");
  for (const { raw } of whole) {
    assert.deepEqual([...statedIn({ name: "p.toml", text: parameterFile(raw!.map(([, value]) => value)) })], raw);
  }
});

test("the files that the host's tests read too are taken or refused in the same words", () => {
  const folder = process.env["BOTH"]!;
  const words = JSON.parse(readFileSync(join(folder, "told.json"), "utf8")) as Record<string, string>;
  const readers: Record<string, (file: NamedText) => unknown> = { controller: controllerIn, parameters: statedIn, image: readImage };
  assert.equal(readdirSync(folder).length, Object.keys(words).length + 1);
  for (const [name, behind] of Object.entries(words)) {
    const read = readers[/^[a-z]+/.exec(name)![0]]!;
    let told = "";
    try {
      read(namedText(name, readFileSync(join(folder, name))));
    } catch (error) {
      told = (error as Error).message;
    }
    assert.equal(told.slice(0, behind ? name.length + behind.length : undefined), behind && name + behind);
  }
});
