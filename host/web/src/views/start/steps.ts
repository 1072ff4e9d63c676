// The way to one's own arm, step by step: what each is for, how far it is, the next thing to do, and what helps where it failed.

import { Board } from "../../link/schema";
import { objectIn } from "../../session/services";
import type { Facts } from "./facts";

/** Where a person is led from Start. */
export type Paths = {
  show(view: string): void;
  /** Opens the form of a verb with fields filled in; null without a host. */
  readonly open: ((verb: string, given: Readonly<Record<string, unknown>>) => void) | null;
  /** The view in which a person connects a board, or writes its firmware; "" where none does. */
  readonly connectIn: string;
  readonly flashIn: string;
  /** True with a simulated arm: then the steps are the practice for a real one. */
  readonly practice: boolean;
  /** A sentence or two on what to do where no board is there. */
  readonly remedy: string;
};

/** How far a step is: done is null where nobody can tell. */
export type Told = { readonly done: boolean | null; readonly words: string };
export type Action = { readonly label: string; readonly act: () => void };

export type Step = {
  readonly title: string;
  readonly about: string;
  readonly failed: string;
  /** A page of the documentation with its place, and its title. */
  readonly more: readonly [page: string, title: string];
  /** The verbs whose newest result stands in the step. */
  readonly verbs: readonly string[];
  look(): Told;
  /** The next thing to do, then other ways. */
  actions(): readonly Action[];
};

const NO_BOARD: Told = { done: false, words: "No board is there yet." };
const POTS = ["leader", "follower"].flatMap((arm) => [0, 1, 2, 3].map((joint) => `${arm}${joint}`));

/** The steps in their order. */
export function stepsOf(facts: Facts, paths: Paths): readonly Step[] {
  return [connect(facts, paths), flash(facts, paths), supply(facts, paths), doctor(facts, paths), calibrate(facts, paths),
    enable(facts), learn(facts, paths), work(facts, paths)];
}

/** Opens a verb, or nothing where no host has verbs. */
function verb({ open }: Paths, label: string, name: string, given: Readonly<Record<string, unknown>> = {}): readonly Action[] {
  return open ? [{ label, act: () => open(name, given) }] : [];
}

function view({ show }: Paths, label: string, name: string): readonly Action[] {
  return name ? [{ label, act: () => show(name) }] : [];
}

function connect(facts: Facts, paths: Paths): Step {
  const { session } = facts;
  return {
    title: "Connect",
    about: paths.practice ? "A simulated board and arm are there to practise on; every step is the same on a real one." : paths.remedy,
    failed: paths.practice ? paths.remedy : "Take another USB cable, for many only charge; close other programs that use the port; on Linux `greywhale doctor` names a missing permission.",
    more: ["your-arm.html#first-flash-and-a-look", "First flash, and a look"],
    verbs: [],
    look: () => {
      const { link, hello } = session;
      if (facts.isUnflashed) return { done: true, words: "A port is there, and no firmware answers yet." };
      if (!link.open || !hello) return { done: false, words: link.sentence || NO_BOARD.words };
      return { done: true, words: `${Board.of(hello.board).description}: ${link.port}.` };
    },
    actions: () => view(paths, "Choose the port", paths.connectIn),
  };
}

function flash(facts: Facts, paths: Paths): Step {
  const { session } = facts;
  return {
    title: "Flash",
    about: "The board needs the firmware of this version, with the motors' supply off. What it has stored stays.",
    failed: "Choose the board as it is, Mega or Nano; press its reset button, and flash again. Until it succeeds the motors stay off.",
    more: ["your-arm.html#first-flash-and-a-look", "First flash, and a look"],
    verbs: ["flash"],
    look: () => {
      const { hello, link } = session;
      if (facts.isUnflashed) return { done: false, words: link.sentence };
      if (facts.speaks === null || !hello) return NO_BOARD;
      const version = `${hello.fw_major}.${hello.fw_minor}.${hello.fw_patch}`;
      return facts.speaks ? { done: true, words: `Firmware ${version} runs; it is this page's.` }
        : { done: false, words: `Firmware ${version} runs, which is another version than this page's.` };
    },
    actions: () => [...verb(paths, "Flash", "flash"), ...view(paths, "Flash", paths.flashIn)],
  };
}

function supply(facts: Facts, paths: Paths): Step {
  const { session } = facts;
  return {
    title: "Supply and driver",
    about: "Measure the motors' supply and enter it: the board cannot, and every voltage is a share of it. Say which signals your drivers take, and whether there is an emergency stop; then store, also where all was right.",
    failed: "A motor that hums and does not turn has the wrong driver, or its enable pin is open. Change driver, apply, and store.",
    more: ["your-arm.html#motor-drivers", "Motor drivers"],
    verbs: [],
    look: () => {
      const { parameters, status } = session;
      if (!parameters || !status) return NO_BOARD;
      const words = `The board counts on ${facts.value("supply_mv") / 1000} V, driver ${facts.value("driver")}, estop_input ${facts.value("estop_input")}`;
      return status.saves ? { done: true, words: `${words}, and has stored that.` } : { done: false, words: `${words}, and has stored nothing yet: are they yours?` };
    },
    actions: () => view(paths, "Set them", "Parameters"),
  };
}

function doctor(facts: Facts, paths: Paths): Step {
  return {
    title: "Doctor",
    about: "Looks at port, firmware, parameters, potentiometers and link, and says what to mend. The motors stay off; keep both arms still.",
    failed: "Mend what it names, from the top down, and start it again.",
    more: ["doctor.html", "greywhale doctor"],
    verbs: ["doctor"],
    look: () => {
      if (!paths.open) return { done: null, words: "It needs greywhale on this computer: `greywhale doctor`." };
      const { verdict } = objectIn(facts.jobs.get("doctor")?.result);
      if (verdict === undefined) return { done: false, words: "It has not looked since this page's server started." };
      return { done: verdict !== "bad", words: verdict === "bad" ? "It has found something to mend." : "Nothing must be mended." };
    },
    actions: () => verb(paths, "Let it look", "doctor"),
  };
}

/** True if no potentiometer in use has the shipped zero and scale; null while the set is not read. */
function calibrated(facts: Facts): boolean | null {
  return facts.session.parameters && shippedPots(facts).length === 0;
}

function shippedPots(facts: Facts): readonly string[] {
  return POTS.filter((pot) => facts.value(`${pot}.scale`) !== 0 && facts.changed([`${pot}.zero`, `${pot}.scale`])?.length === 0);
}

function calibrate(facts: Facts, paths: Paths): Step {
  return {
    title: "Calibrate",
    about: "From potentiometers mounted anyhow to angles: turn each joint, lay both arms into four poses, let each motor answer. What is the wrong way round is put right.",
    failed: "It names the potentiometer or the joint. Mend the wire or the coupling, and take that step again; nothing is stored before you say so.",
    more: ["calibrate.html", "Calibrate"],
    verbs: [],
    look: () => {
      const is = calibrated(facts);
      if (is === null) return NO_BOARD;
      if (is) return { done: true, words: "Every potentiometer in use has its own zero or scale." };
      const shipped = shippedPots(facts).length;
      return { done: false, words: `${shipped === 1 ? "A potentiometer has" : `${shipped} potentiometers have`} the shipped zero and scale: right for a track of 300 degrees that is mounted in its middle.` };
    },
    actions: () => view(paths, "Calibrate", "Calibrate"),
  };
}

function enable(facts: Facts): Step {
  const { session } = facts;
  return {
    title: "First enable",
    about: "Hold the leader as the follower lies, with a hand at the emergency stop, and enable. The soft start begins with little voltage; the space bar stops.",
    failed: "The line under the header says which protection acted, and the remedy. Clear the fault, and enable again.",
    more: ["your-arm.html#first-enable", "First enable"],
    verbs: [],
    look: () => {
      if (!session.link.open) return NO_BOARD;
      if (session.motorsOn) return { done: true, words: "The arm follows." };
      if (session.faulty) return { done: false, words: session.whyNotEnable };
      if (facts.hasMoved) return { done: true, words: "The arm has moved with its motors; they are off now." };
      return { done: false, words: session.whyNotEnable || "The motors are off." };
    },
    actions: () => (session.motorsOn ? [] : [{ label: "Enable", act: () => void session.attempt(() => session.enable()) }]),
  };
}

function learn(facts: Facts, paths: Paths): Step {
  return {
    title: "Let it learn",
    about: "Commission does all of it: the arm moves by itself, greywhale finds its friction, play and motors, finds controllers for them, and keeps what was measured best. Or go step by step.",
    failed: "It says which joint and why, and what it kept. Nothing worse than before stays on the board.",
    more: ["your-arm.html#let-it-learn", "Let it learn"],
    verbs: ["record", "identify", "tune", "commission", "upload"],
    look: () => {
      if (!paths.open) return { done: null, words: "Tune in Controller works here with the arm of this page; for your own arm it needs greywhale on this computer: `greywhale commission`." };
      if (!facts.hasFolder) return { done: null, words: "" };
      const [logs, models, controllers] = ["log", "model", "controller"].map((kind) => facts.files(kind));
      const there = [counted(logs!, "recording"), ...models!.slice(-1), ...controllers!.slice(-1)].filter(Boolean).join(", ");
      const words = facts.running ? `The board runs ${facts.running}.` : "The board runs no controller of this folder.";
      return { done: facts.running !== null, words: there ? `${words} Here are: ${there}.` : words };
    },
    actions: () => [...verb(paths, "Commission", "commission"), ...nextOfLearning(facts, paths), ...(paths.open ? [] : view(paths, "Tune in the page", "Controller"))],
  };
}

/** The next of record, identify, tune and upload, by what the folder has. */
function nextOfLearning(facts: Facts, paths: Paths): readonly Action[] {
  const [log, model, controller] = ["log", "model", "controller"].map((kind) => facts.files(kind).at(-1));
  if (!log) return verb(paths, "Step by step: record", "record", { excite: true, out: "fit.csv" });
  if (!model) return verb(paths, "Step by step: identify", "identify", { logs: [log], out: "model.toml" });
  if (!controller) return verb(paths, "Step by step: tune", "tune", { model_file: model, out: "controller.toml" });
  return facts.running ? [] : verb(paths, "Step by step: upload", "upload", { controller });
}

function work(facts: Facts, paths: Paths): Step {
  const { session } = facts;
  return {
    title: "Work",
    about: "Lead the arm. Adapt keeps the controllers right while you work; record keeps what you do as episodes.",
    failed: "A fault names its cause under the header. If the arm follows worse than before, commission it again.",
    more: ["adapt.html", "greywhale adapt"],
    verbs: ["adapt"],
    look: () => ({ done: session.motorsOn, words: session.motorsOn ? "The arm follows." : "The motors are off." }),
    actions: () => [...verb(paths, "Adapt while it works", "adapt"), ...verb(paths, "Record", "record", { enable: true }), ...view(paths, "See it live", "Live")],
  };
}

function counted(files: readonly string[], what: string): string {
  return files.length ? `${files.length} ${what}${files.length > 1 ? "s" : ""}` : "";
}
