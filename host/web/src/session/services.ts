// The services of a host beside the board: files, predictions, verbs, a bench. Without one views hide what needs it.

import type { NamedText } from "../parts/named_text";
import type { Telling } from "./telling";

export type NamedFile = { readonly name: string; readonly kind: string; readonly size_bytes: number; /** since 1970 */ readonly changed_s: number };

export type HostState = {
  readonly greywhale: string;
  readonly arm: string;
  /** True if the arm is a model that was identified. */
  readonly identified: boolean;
  readonly folder: string;
  readonly sim: boolean;
  /** True if a simulated arm may follow as soon as a page is open. */
  readonly follows: boolean;
  readonly files: readonly NamedFile[];
  readonly controllers: readonly string[];
  readonly arms: readonly string[];
  /** The most that a file may have which a page brings. */
  readonly most_upload_bytes: number;
};

/** The files of the host's folder that verbs take or write. A name that is taken is refused, replaced, or gets a number. */
export interface Files {
  fetch(name: string): Promise<Blob>;
  /** The name that a file got. */
  bring(name: string, content: Blob, ifThere: "refuse" | "replace" | "rename"): Promise<string>;
  rename(name: string, to: string): Promise<void>;
  remove(name: string): Promise<void>;
}

/** A question about an arm, and what was answered: "" holds what is usual. */
export type Question = {
  readonly where: string;
  readonly text: string;
  readonly unit: string;
  readonly choices: readonly string[];
  /** True where a number will do. */
  readonly number: boolean;
  readonly usual: string;
  readonly given: string;
  readonly problem: string;
  readonly help: string;
};
export type Heading = { readonly heading: string; readonly questions: readonly Question[] };
/** Answers by the questions' names; or a file of the folder that has some. */
export type ArmAnswers = string | { readonly [where: string]: string };

/** A motion and how a model follows it: rows of four joints, rad. */
export type Predicted = {
  readonly time_s: readonly number[];
  readonly leader: readonly (readonly number[])[];
  readonly follower: readonly (readonly number[])[];
  readonly mse: readonly number[]; // of each joint, over the whole motion
};

export type Prediction = { readonly step: Predicted; readonly reach: Predicted };

/** An arm that can be predicted and tuned for; `says` tells a person what it is, in a sentence. */
export type Model = { readonly name: string; readonly identified: boolean; readonly says: string };

/** Predicts how an arm follows with controllers that nobody has uploaded yet. */
export interface Predictor {
  /** The arms there are; the first is the one to begin with. */
  models(): Promise<readonly Model[]>;
  /** Reads an arm.toml or model.toml of a person, where the source takes one. */
  readonly read?: (file: NamedText) => Model;
  /** Predicts a whole parameter set in raw values, on a board by its number. */
  predict(raw: readonly number[], board: number, model: Model): Promise<Prediction>;
}

/**
 * The torque that acts on a joint from outside, N m, with half its 90 % interval. `why` says that it cannot be told, "" where
 * it can; `share` is that of the motor's stall torque, without its sign.
 */
export type JointTorque = {
  readonly torque_nm: number; readonly half_width_nm: number; readonly why: string; readonly contact: boolean; readonly share: number;
};

/** Something that touched a joint, seen at a tick of the board's; `torque_nm` is the largest so far. */
export type ContactNow = {
  readonly joint: number; readonly tick: number; readonly torque_nm: number; readonly lasted_s: number; readonly lasts: boolean;
};

/** The torques of a moment, and the last contact to begin. */
export type OutsideTorque = { readonly joints: readonly JointTorque[]; readonly contact: ContactNow | null };

export interface Torques {
  /** Listens to what a model tells of the board's samples, by the board's filter_shift, until the result is called. */
  listen(model: string, filterShift: number, heard: (told: OutsideTorque) => void, refused: (sentence: string) => void): () => void;
}

export type ArmDescription = {
  readonly name: string;
  /** Of the links from the base to the tip, m. */
  readonly lengths: readonly number[];
  readonly joints: readonly { readonly min: number; readonly max: number; readonly fixed: boolean }[];
};

export type Range = { readonly minimum: number; readonly maximum: number; readonly value: number; readonly step?: number };

export const SIZES = ["supply", "load", "noise", "play", "speed"] as const;
export type Size = (typeof SIZES)[number];

/** A motion that the bench's leader makes by itself; `title` says what it does. */
export type NamedMotion = { readonly name: string; readonly title: string };

/** A fault of a group of its kind, as people say it, and the places where it can be. */
export type PossibleFault = {
  readonly name: string;
  readonly group: string;
  readonly title: string;
  readonly description: string;
  readonly places: readonly string[];
};

/** The things that can be changed on a simulated bench; what a bench lacks is left out. */
export type BenchControls = {
  readonly leader: { readonly minimum: readonly number[]; readonly maximum: readonly number[] };
  readonly faults: readonly PossibleFault[];
  readonly motions: readonly NamedMotion[];
  /** The faults of now, as they are wished; left out by a bench that does not tell. */
  readonly broken?: readonly string[];
} & { readonly [size in Size]?: Range };

/** One change: live angles of the leader, a motion, a fault by its name (null mends all), power, a size. */
export type BenchWish =
  | { readonly leader: readonly number[] }
  | { readonly motion: string }
  | { readonly fault: string | null }
  | { readonly power: boolean }
  | { readonly estop: boolean }
  | { readonly clutch: boolean }
  | { readonly [size in Size]?: number };

/**
 * What a calibration asks of a person's hands, as the bench's do it: a joint by its potentiometer turned to both ends and
 * back, both arms in one pose (rad), the follower hanging.
 */
export type HandsWish = { readonly turn: number } | { readonly pose: readonly number[] } | { readonly hang: true };

export interface Bench {
  controls(): Promise<BenchControls>;
  change(wish: BenchWish): Promise<void>;
  /** Begins to do it; the seconds of the bench's time until it is done. */
  hands(wish: HandsWish): Promise<number>;
}

export type Argument = {
  readonly name: string;
  /** Its word on the command line, "" where its place alone tells. */
  readonly option: string;
  readonly label: string;
  readonly unit: string;
  /** True if it matters first. */
  readonly first: boolean;
  readonly kind: "flag" | "number" | "choice" | "file" | "text" | "answers";
  /** The shape of a text, such as J:MIN:MAX; "" for any. */
  readonly shape: string;
  /** The kinds of files that it takes; none where it names a new one. */
  readonly files: readonly string[];
  readonly least: number | null;
  readonly most: number | null;
  readonly choices: readonly string[];
  readonly default: unknown;
  readonly required: boolean;
  readonly many: boolean;
  readonly help: string;
};

export type Verb = {
  readonly verb: string;
  /** As a person would ask for it. */
  readonly title: string;
  readonly group: string;
  readonly help: string;
  /** How it uses a board. Taken: it has the port itself, with or without a board at it. */
  readonly board: "none" | "lent" | "taken";
  readonly arguments: readonly Argument[];
};

/** The JSON that a verb may answer with. */
export type Json = null | boolean | number | string | readonly Json[] | { readonly [key: string]: Json };

export type Job = {
  readonly id: string;
  readonly verb: string;
  readonly arguments: Readonly<Record<string, unknown>>;
  readonly state: "running" | "done" | "failed" | "stopped";
  readonly progress: { readonly done: number; readonly total: number; readonly text: string; readonly note: string } | null;
  /** Seconds until the arm moves; 0: it is not counted. */
  readonly countdown: number;
  /** The result for people; null where there is none. */
  readonly telling: Telling | null;
  readonly result: Json;
  readonly error: string | null;
  readonly said: readonly string[];
};

export interface Jobs {
  verbs(): Promise<readonly Verb[]>;
  /** Starts a verb; the id of its job. */
  start(verb: string, given: Readonly<Record<string, unknown>>): Promise<string>;
  stop(id: string): Promise<void>;
  /** Forgets a job that has ended. */
  putAway(id: string): Promise<void>;
  /** Hears each job as it is, and whenever something about it changes; `gone` hears which was put away. */
  listen(heard: (job: Job) => void, gone?: (id: string) => void): void;
}

/** The progress of a search for controllers. */
export type Searched = {
  readonly share: number; // 0 to 1
  readonly words: string;
  /** The best cost so far after each batch: of each joint, or one of all joints together. `unit` is that of `x`. */
  readonly curve: { readonly unit: string; readonly x: readonly number[]; readonly y: readonly (readonly number[])[] };
};

type Controllers = readonly (readonly number[])[]; // four joints' settings in raw values, in the order of the table

/** The result of a search, and how the arm follows a hand with it and did before: rows of four joints, rad. */
export type Tuned = {
  readonly before: Controllers; // with which the search began
  readonly after: Controllers;
  readonly notes: readonly string[]; // sentences
  readonly mse: readonly (readonly number[])[]; // before, after; of each joint. Empty where nobody has judged it
  readonly time_s: readonly number[]; // empty where there is no picture
  readonly leader: readonly (readonly number[])[];
  readonly followers: readonly (readonly (readonly number[])[])[]; // before, after
};

/** Searches controllers. */
export interface Tuner {
  /** Sentences on what it does, and what it does not. */
  readonly promise: string;
  readonly limits: string;
  /** Tunes for a model, and begins with four joints' settings where it can; one tuning at a time. */
  tune(before: Controllers, model: Model, heard: (searched: Searched) => void): Promise<Tuned>;
  /** Ends the search with the best so far. */
  stop(): void;
}

/** A calibration that a board has had. `changed` says in words what it changed against the one before. */
export type KeptCalibration = {
  readonly number: number;
  readonly when: string; // ISO 8601
  readonly why: string; // "found", "page", "back", or a verb
  readonly changed: readonly string[];
  readonly values: Readonly<Record<string, number>>; // raw, by parameter; none where its file is damaged
};

/** The calibrations of the board that is connected; none is ever written over. */
export interface Calibrations {
  /** The oldest first. */
  list(): Promise<readonly KeptCalibration[]>;
  /** Keeps that of a whole set in raw values, unless the newest is the same. */
  keep(raw: readonly number[], board: number, why: "found" | "page" | "back" | "set"): Promise<void>;
}

export interface Services {
  readonly calibrations: Calibrations;
  readonly jobs: Jobs;
  readonly bench: Bench;
  readonly files: Files;
  /** The questions of `arm new` that follow from the answers so far. */
  questions(answers: ArmAnswers): Promise<readonly Heading[]>;
  readonly predictor: Predictor;
  readonly torques: Torques;
  readonly tuner: Tuner;
  state(): Promise<HostState>;
  /** The samples of a log: payloads of the link's Sample, one after the other, ticks from the log's first row. */
  log(file: string): Promise<Uint8Array>;
  /** Raw values by parameter name of a built-in controller or a file. */
  controller(file: string): Promise<Readonly<Record<string, number>>>;
  arm(): Promise<ArmDescription>;
}
