// The page's state in its address: what is written is read again, and whatever is wrong is told in a sentence.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { fragmentOf, stateOf, type PageState } from "../src/entries/link_to_state";
import type { BenchControls } from "../src/session/services";
import { TABLE } from "../src/link/schema";

const VIEWS = ["Start", "Live", "Controller"];
const CONTROLS: BenchControls = {
  leader: { minimum: [-2, -2, -2, -2], maximum: [2, 2, 2, 2] },
  faults: [
    { name: "pot-open", group: "", title: "", places: ["leader0", "follower1"], description: "" },
    { name: "brown-out", group: "", title: "", places: [], description: "" },
  ],
  motions: [{ name: "reaches", title: "" }, { name: "steps", title: "" }],
  noise: { minimum: 0, maximum: 10, value: 1 },
  load: { minimum: 0, maximum: 2, value: 0 },
};
const DEFAULTS = TABLE.parameters.map(({ initial }) => initial);
const read = (fragment: string): PageState | null => stateOf(fragment, VIEWS, CONTROLS);

test("a state comes back from its fragment, every parameter to the count", () => {
  assert.equal(read(""), null);
  for (const share of [0, 0.37, 1]) {
    const state: PageState = {
      view: "Controller", joint: 2, sizes: [{ load: 0.25 }, { noise: 3 }],
      acts: [{ leader: [0, 0.7, -0.3, 0] }, { motion: "steps" }, { fault: "pot-open:follower1" }, { fault: "brown-out" }],
      raw: TABLE.parameters.map(({ minimum, maximum }) => Math.round(minimum + share * (maximum - minimum)) + 0),
    };
    assert.deepEqual(read(fragmentOf(state)), state);
  }
  const plain = { view: "Start", joint: 0, sizes: [], acts: [], raw: DEFAULTS };
  assert.equal(fragmentOf(plain), "view=start&joint=0");
  assert.deepEqual(read("joint=0"), plain);
});

test("whatever is wrong in a fragment is named, with what would be right", () => {
  for (const [fragment, remedy] of [
    ["noise=11", 'noise is "11": choose a number from 0 to 10'],
    ["noise=", 'noise is "": choose a number'],
    ["play=2", 'play is "2": the page knows no such word'], // this bench has none
    ["view=Live", 'view is "Live": choose start, live, controller'],
    ["joint=4", 'joint is "4": choose 0, 1, 2, 3'],
    ["motion=log.csv", 'motion is "log.csv": choose reaches, steps'],
    ["leader=0,0,0", 'leader is "0,0,0": give four angles in rad'],
    ["leader=0,0,0,3", "choose a number from -2 to 2"],
    ["fault=pot-open", "choose one of those in the view Bench"],
    ["fault=brown-out:leader0", "choose one of those in the view Bench"],
    ["joint1.kp=65", 'joint1.kp is "65": choose a number from 0 to 64'],
    ["joint7.kp=1", "the page knows no such word"],
    ["%E0%A4%A", "the page knows no such word"],
  ] as const) {
    assert.throws(() => read(`view=live&${fragment}`), (error: Error) => error.message.includes("set aside") && error.message.includes(remedy), fragment);
  }
});

test("every link of the lessons names a state", () => {
  const controls = { ...CONTROLS, play: { minimum: 0, maximum: 10, value: 1 } };
  const lessons = [...readFileSync("../../docs/lessons.md", "utf8").matchAll(/\]\(page:([^)]+)\)/g)];
  assert.ok(lessons.length > 10);
  for (const [, lesson] of lessons) {
    const state = stateOf(lesson!, VIEWS, controls)!;
    assert.deepEqual(stateOf(fragmentOf(state), VIEWS, controls), state, lesson);
  }
});
