// The services of a host beside the board: files, predictions, verbs, a bench. Without one views hide what needs it.

import type { NamedText } from "../parts/named_text";
import type { ArmDescription, Heading, HostState, Job, Json, KeptFile, OutsideTorque, Prediction, Verb } from "./host_types";

export type * from "./host_types";

/** The object that stands in a verb's answer, an empty one where anything else does. */
export function objectIn(value: Json | undefined): { readonly [key: string]: Json } {
  return typeof value === "object" && value !== null && !Array.isArray(value) ? (value as { readonly [key: string]: Json }) : {};
}

/** The files of the host's folder that verbs take or write. A name that is taken is refused, replaced, or gets a number. */
export interface Files {
  fetch(name: string): Promise<Blob>;
  /** The name that a file got. */
  bring(name: string, content: Blob, ifThere: "refuse" | "replace" | "rename"): Promise<string>;
  rename(name: string, to: string): Promise<void>;
  remove(name: string): Promise<void>;
}

/** Answers by the questions' names; or a file of the folder that has some. */
export type ArmAnswers = string | { readonly [where: string]: string };

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

export interface Torques {
  /** Listens to what a model tells of the board's samples, by the board's filter_shift, until the result is called. */
  listen(model: string, filterShift: number, heard: (told: OutsideTorque) => void, refused: (sentence: string) => void): () => void;
}

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

/** A calibration that a board has had; none of its values is there where its file is damaged. */
export type KeptCalibration = Omit<KeptFile, "file" | "problem">;

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
