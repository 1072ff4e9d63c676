// The controllers that a person edits: four joints' settings beside those that run, with undo and two places to compare.

import { TABLE } from "../../link/schema";
import { Signal } from "../../parts/signal";
import { JOINTS } from "../../session/samples";
import { SETTING_NAMES, type Settings } from "../../session/law";

const MOST_STEPS = 200;

type Name = keyof Settings;
export type Four = readonly Settings[];

export function parameterName(joint: number, name: Name): string {
  return `joint${joint}.${name}`;
}

/** The four joints of a whole parameter set in raw values. */
export function jointsOf(raw: readonly number[]): Four {
  return ofRows(Array.from({ length: JOINTS }, (_, joint) =>
    SETTING_NAMES.map((name) => raw[TABLE.named(parameterName(joint, name)).index]!)));
}

/** A whole parameter set with these joints in it. */
export function withJoints(raw: readonly number[], joints: Four): number[] {
  const all = [...raw];
  joints.forEach((settings, joint) => {
    for (const name of SETTING_NAMES) all[TABLE.named(parameterName(joint, name)).index] = settings[name];
  });
  return all;
}

/** The joints' settings in the order of the table, and back. */
export function rowsOf(joints: Four): number[][] {
  return joints.map((settings) => SETTING_NAMES.map((name) => settings[name]));
}

export function ofRows(rows: readonly (readonly number[])[]): Four {
  return rows.map((row) => Object.fromEntries(SETTING_NAMES.map((name, place) => [name, row[place]!])) as Settings);
}

export function areSame(one: Four, other: Four): boolean {
  return one.every((settings, joint) => SETTING_NAMES.every((name) => settings[name] === other[joint]![name]));
}

export class Draft {
  readonly changed = new Signal();
  private steps: Four[];
  private at = 0;
  private grip = ""; // what is being dragged: its moves are one step

  constructor(first: Four) {
    this.steps = [first];
  }

  get joints(): Four {
    return this.steps[this.at]!;
  }

  get canUndo(): boolean {
    return this.at > 0;
  }

  get canRedo(): boolean {
    return this.at < this.steps.length - 1;
  }

  /** Changes one setting; changes with the same `grip` in a row are undone together. */
  set(joint: number, name: Name, value: number, grip = ""): void {
    const next = this.joints.map((settings, one) => (one === joint ? { ...settings, [name]: value } : settings));
    if (grip && grip === this.grip) {
      this.steps[this.at] = next;
      this.changed.emit();
    } else {
      this.replace(next);
    }
    this.grip = grip;
  }

  /** Ends a drag: the next change is a step of its own. */
  letGo(): void {
    this.grip = "";
  }

  /** Takes other controllers, as one step. */
  replace(next: Four): void {
    this.grip = "";
    this.steps = [...this.steps.slice(Math.max(0, this.at + 2 - MOST_STEPS), this.at + 1), next];
    this.at = this.steps.length - 1;
    this.changed.emit();
  }

  undo(): void {
    if (this.canUndo) this.move(-1);
  }

  redo(): void {
    if (this.canRedo) this.move(1);
  }

  private move(by: number): void {
    this.grip = "";
    this.at += by;
    this.changed.emit();
  }
}
