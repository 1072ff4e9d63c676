// The way through a calibration: its steps in their order, what each has found, and what follows from them all.

import { LinkError } from "../../link/declared";
import { State, TABLE } from "../../link/schema";
import { jointsInUse, POTS, potsOf } from "../../session/pots";
import { JOINTS, traceOf } from "../../session/samples";
import type { Session } from "../../session/session";
import type { Calibration, Motor, Pose, Rules, Sweep } from "./rules";
import { AGAIN, FIRST, SECOND, stepTitle, THIRD, type Step } from "./step";

const HELD_TICKS = 500; // that a pose is looked at

/** The result of all steps: the set from before, the set to store, what was found, and how far the arms are apart in rad. */
export type Found = {
  readonly before: readonly number[]; readonly after: readonly number[]; readonly calibration: Calibration; readonly apart: readonly number[];
};

export class Walk {
  readonly steps: Step[];
  readonly joints: readonly number[];
  /** The step that a person is at. */
  at = 0;
  readonly motors = new Map<number, Motor>(); // that have moved their joints
  /** True where a person wants the motors to stay as they are. */
  motorsLeft = false;
  private readonly sweeps: (Sweep | null)[] = POTS.map(() => null);
  private poses: (Pose | null)[] = [null, null, null, null];
  private since = 0; // the first sample of this step

  /** `before` is the set that runs; with a `track` in rad, the second pose is any in which both arms agree. */
  constructor(
    private readonly session: Session, private readonly rules: Rules, before: readonly number[], private readonly track: number | null,
  ) {
    this.joints = jointsInUse(before);
    this.steps = [
      ...potsOf(this.joints).map((pot): Step => ({ kind: "sweep", pot })), ...this.poses.map((_, place): Step => ({ kind: "pose", place })),
      { kind: "motors" }, { kind: "store" },
    ];
    this.go(0);
  }

  get step(): Step {
    return this.steps[this.at]!;
  }

  /** Goes to a step, or begins it anew. */
  go(at: number): void {
    this.at = at;
    this.since = this.session.samples.end;
  }

  isDone(step: Step): boolean {
    if (step.kind === "sweep") return this.sweeps[step.pot] !== null;
    if (step.kind === "pose") return this.poses[step.place] !== null;
    return step.kind === "motors" && (this.motorsLeft || this.joints.every((joint) => this.motors.has(joint)));
  }

  /** The reason why a step must wait, in a sentence; empty where it need not. */
  whyNot(at: number): string {
    const open = this.steps.slice(0, at).find((step) => !this.isDone(step));
    return open ? `First comes: ${stepTitle(open)}.` : "";
  }

  /** Goes to the first step that is not done. */
  next(): void {
    this.go(this.steps.findIndex((step) => !this.isDone(step)));
  }

  /** Puts the sweep of now behind the other sweeps. */
  later(): void {
    const [step] = this.steps.splice(this.at, 1);
    this.steps.splice(potsOf(this.joints).length - 1, 0, step!);
    this.next();
  }

  /** Takes the sweep of now in; the mistake that it shows, a sentence with its remedy, else empty. */
  async takeSweep(pot: number): Promise<string> {
    const raw = await this.running();
    this.requireOff(this.since);
    const { mistake, ...sweep } = this.rules.sweep(this.rules.counts(this.angles(this.since), raw), pot);
    this.sweeps[pot] = mistake ? null : sweep;
    return mistake;
  }

  /** Takes a pose in, unless it contradicts what was before; those after it are to be taken again. `angles` are in rad. */
  async takePose(place: number, angles: readonly number[]): Promise<void> {
    const raw = await this.running();
    const pose = { angles: place === AGAIN ? this.poses[FIRST]!.angles : angles, counts: this.held(raw) };
    const poses = this.poses.map((kept, one) => (one < place ? kept : one === place ? pose : null));
    const { [FIRST]: first, [SECOND]: second, [AGAIN]: again, [THIRD]: third } = poses;
    if (second && !again) this.solved(poses);
    if (again && !third) this.rules.requireNoSlip(first!, again);
    if (third) this.rules.apartIn(this.solved(poses), third, this.joints);
    this.poses = poses;
  }

  private solved({ [FIRST]: first, [SECOND]: second }: readonly (Pose | null)[]): Calibration {
    const { rules, sweeps, track, joints } = this;
    return track === null ? rules.solve(sweeps, first!, second!, joints) : rules.match(sweeps, first!, second!, track, joints);
  }

  /** What the sweeps, the poses and the motors give, as soon as all of them are done. */
  async found(): Promise<Found> {
    const before = await this.running();
    if (String(jointsInUse(before)) !== String(this.joints)) throw new LinkError("Other joints are in use than at the beginning; begin anew.");
    const calibration = this.solved(this.poses);
    const apart = this.rules.apartIn(calibration, this.poses[THIRD]!, this.joints);
    const changes = this.rules.changesOf(calibration, this.joints);
    const after = TABLE.parameters.map(({ name, index }) => changes.get(name) ?? before[index]!);
    for (const { joint, sign } of this.motors.values()) after[TABLE.named(`joint${joint}.motor_sign`).index]! *= sign;
    return { before, after, calibration, apart };
  }

  /** The set that runs, by which the counts are known; the motors must be off. */
  private async running(): Promise<readonly number[]> {
    if (this.session.motorsOn || this.session.state === State.is.boot) throw new LinkError("Calibrate with the motors off; press Stop first.");
    return this.session.readParameters();
  }

  /** With motors on, samples have the reference in the place of the leader. */
  private requireOff(from: number): void {
    const { samples } = this.session;
    for (let number = Math.max(from, samples.first); number < samples.end; number++) {
      const state = samples.state[number % samples.capacity];
      if (state === State.is.soft_start || state === State.is.following) throw new LinkError("The motors were on meanwhile; do it again with the motors off.");
    }
  }

  /** The angles in the samples from a number on, rows of eight. */
  private angles(from: number): number[] {
    const { samples } = this.session;
    const begin = Math.max(from, samples.first);
    if (begin >= samples.end) throw new LinkError("No sample has come yet; is the board silent?");
    return Array.from({ length: samples.end - begin }, (_, row) =>
      POTS.map((pot) => samples.count(begin + row, traceOf(pot < JOINTS ? "leader" : "follower", pot % JOINTS)))).flat();
  }

  /** The counts of arms that were held still. */
  private held(raw: readonly number[]): readonly number[] {
    const { samples } = this.session;
    const from = samples.end - HELD_TICKS;
    if (from < samples.first) throw new LinkError("There are too few samples yet; hold the pose for half a second.");
    this.requireOff(from);
    return this.rules.held(this.rules.counts(this.angles(from), raw));
  }
}
