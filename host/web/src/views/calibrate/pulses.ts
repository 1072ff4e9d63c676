// Gives a board's motor short weak pulses. The firmware itself limits them: a set that is never stored gives this motor few
// volts and the others none, nobody renews the lease, and a joint that runs away is a fault.

import { fixed } from "../../files/words";
import { LinkError } from "../../link/declared";
import { ResetCause, State, TABLE } from "../../link/schema";
import { COUNT, JOINTS, traceOf } from "../../session/samples";
import type { Session } from "../../session/session";
import type { Motor, Rules } from "./rules";

const LEASE_MS = 160; // soft start is 100 of it
const WAY_STEPS = 82; // 0.08 rad, where a pulse sends its joint
const FARTHEST_RAD = 0.16; // of a joint from where it should be: twice a pulse's way
const STILL_TICKS = 200;
const STILL_RAD = 0.008; // an arm that still falls would hide a weak pulse
const PATIENCE_MS = 5000;
const SETTLE_TICKS = 250; // watched after the lease, while the joint settles
const STIFF_KP = 64; // so that a small error already gets the whole voltage of the pulse
const LOOK_MS = 20;
const ALL = Array.from({ length: JOINTS }, (_, joint) => joint);

/** The set with which a pulse of so many volts runs, made from that of a calibrated board. */
export function pulseSet(calibrated: readonly number[], joint: number, volts: number): number[] {
  const raw = [...calibrated];
  const set = (name: string, value: number): void => {
    const { index, lsb } = TABLE.named(name);
    raw[index] = Math.floor(value / lsb + 0.5);
  };
  const common = { period_ms: 1, soft_start_ms: 100, tracking_limit: FARTHEST_RAD, tracking_ms: 1, stall_volts: 0, unrest_amplitude: 0 };
  for (const [name, value] of Object.entries(common)) set(name, value);
  const { maximum, lsb } = TABLE.named("joint0.limit_max");
  for (const other of ALL) {
    const own = { kp: STIFF_KP, kd: 0, ki: 0, ku_mv: other === joint ? 1000 * volts : 0, limit_min: -maximum * lsb, limit_max: maximum * lsb };
    for (const [name, value] of Object.entries(own)) set(`joint${other}.${name}`, value);
  }
  return raw;
}

/** One motor's pulses. A stop that a person asks for, or a page that nobody sees, ends them. */
export class Trial {
  private readonly stopsAsked: number;

  /** `calibrated` is the set that runs, `before`, with the potentiometers calibrated. */
  constructor(
    private readonly session: Session, private readonly rules: Rules, private readonly before: readonly number[],
    private readonly calibrated: readonly number[], private readonly joint: number,
  ) {
    this.stopsAsked = session.stopsAsked;
  }

  /** Examines the motor; the set from before runs again afterwards. */
  async run(): Promise<Motor> {
    try {
      return await this.rules.motor((volts, way) => this.pulse(volts, way), this.before[TABLE.named("supply_mv").index]! / 1000, this.joint);
    } finally {
      await this.session.stop();
      await this.session.apply(this.before);
    }
  }

  private async pulse(volts: number, way: number): Promise<readonly number[]> {
    const { session, session: { samples }, joint } = this;
    const set = pulseSet(this.calibrated, joint, volts);
    await session.apply(set);
    const from = samples.end;
    await this.until(() => this.isStill(from), "The follower does not come to rest; lay it down, and begin anew.");
    const [begin, tick] = [samples.end, samples.lastTick];
    const restarted = (): boolean => samples.lastTick < tick;
    let reference: readonly number[] = [];
    try {
      ({ reference } = await session.lead(LEASE_MS, ALL.map((other) => (other === joint ? way * WAY_STEPS : 0))));
      await this.until(() => restarted() || samples.lastTick - tick >= LEASE_MS + SETTLE_TICKS, "The board sends no samples; check its cable, and begin anew.");
    } catch (error) {
      if (!restarted()) throw error;
    }
    if (restarted()) throw this.sunkSupply(volts);
    if (session.state === State.is.fault) {
      set[TABLE.named("tracking_limit").index] = 0; // cleared where any distance from the leader will do: nobody holds the arm
      await session.apply(set);
      await session.clearFault();
    }
    return ALL.map((other) => COUNT.follower * this.angles(begin, other).map((angle) => angle - reference[other]!)
      .reduce((most, one) => (Math.abs(one) > Math.abs(most) ? one : most)));
  }

  private sunkSupply(volts: number): LinkError {
    const cause = ResetCause.of(this.session.hello?.reset_cause ?? 0).description;
    return new LinkError(`The board restarted while the motor of joint ${this.joint} was driven with ${fixed(volts, 1)} V (${cause}): `
      + "its supply sinks when a motor draws. Give the motors a supply of their own, with a common ground, and 1000 uF or more at the drivers, and begin anew.");
  }

  private async until(reached: () => boolean, sentence: string): Promise<void> {
    for (let waited = 0; !reached(); waited += LOOK_MS) {
      if (this.session.stopsAsked !== this.stopsAsked || document.visibilityState === "hidden") {
        throw new LinkError(`The motor of joint ${this.joint} was not tried to the end: Stop was pressed, or the page was hidden.`);
      }
      if (waited > PATIENCE_MS) throw new LinkError(sentence);
      await new Promise((settle) => setTimeout(settle, LOOK_MS));
    }
  }

  private angles(from: number, joint: number): number[] {
    const { samples } = this.session;
    return Array.from({ length: samples.end - from }, (_, at) => samples.count(from + at, traceOf("follower", joint)));
  }

  /** True if the follower has rested for a while since a sample; it may have been falling since the last pulse. */
  private isStill(from: number): boolean {
    const begin = this.session.samples.end - STILL_TICKS;
    return begin >= from && ALL.every((joint) => {
      const angles = this.angles(begin, joint);
      return (Math.max(...angles) - Math.min(...angles)) * COUNT.follower <= STILL_RAD;
    });
  }
}
