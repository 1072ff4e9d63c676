// Gives a board's motor short weak pulses. The firmware itself limits them: a set that is never stored gives this motor few
// volts and the others none, nobody renews the lease, and a joint that runs away is a fault.

import { fixed } from "../../files/words";
import { LinkError } from "../../link/declared";
import { ResetCause, State, TABLE } from "../../link/schema";
import { COUNT, JOINTS, traceOf } from "../../session/samples";
import type { Session } from "../../session/session";
import type { Motor, Rules } from "./rules";

const LOOK_MS = 20;
const ALL = Array.from({ length: JOINTS }, (_, joint) => joint);

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
    const { set, leaseMs, settleMs, stillMs, patienceMs, step, still } = this.rules.pulse(this.calibrated, joint, volts);
    await session.apply(set);
    const from = samples.end;
    await this.until(patienceMs, () => this.isStill(from, stillMs, still), "The follower does not come to rest; lay it down, and begin anew.");
    const [begin, before] = [samples.end, samples.lastTick];
    const restarted = (): boolean => samples.lastTick < before;
    let reference: readonly number[] = [];
    try {
      ({ reference } = await session.lead(leaseMs, ALL.map((other) => (other === joint ? way * step : 0))));
      await this.until(patienceMs, () => restarted() || this.sinceOn(begin) >= leaseMs + settleMs, "The board sends no samples; check its cable, and begin anew.");
    } catch (error) {
      if (!restarted()) throw error;
    }
    if (restarted()) throw this.sunkSupply(volts);
    if (session.state === State.is.fault) {
      set[TABLE.named("tracking_limit").index] = 0; // cleared where any distance from the leader will do: nobody holds the arm
      await session.apply(set);
      await session.clearFault();
    }
    return ALL.map((other) => COUNT.follower * this.angles(this.firstOn(begin), other).map((angle) => angle - reference[other]!)
      .reduce((most, one) => (Math.abs(one) > Math.abs(most) ? one : most)));
  }

  private sunkSupply(volts: number): LinkError {
    const cause = ResetCause.of(this.session.hello?.reset_cause ?? 0).description;
    return new LinkError(`The board restarted while the motor of joint ${this.joint} was driven with ${fixed(volts, 1)} V (${cause}): `
      + "its supply sinks when a motor draws. Give the motors a supply of their own, with a common ground, and 1000 uF or more at the drivers, and begin anew.");
  }

  private async until(patienceMs: number, reached: () => boolean, sentence: string): Promise<void> {
    for (let waited = 0; !reached(); waited += LOOK_MS) {
      if (this.session.stopsAsked !== this.stopsAsked || document.visibilityState === "hidden") {
        throw new LinkError(`The motor of joint ${this.joint} was not tried to the end: Stop was pressed, or the page was hidden.`);
      }
      if (waited > patienceMs) throw new LinkError(sentence);
      await new Promise((settle) => setTimeout(settle, LOOK_MS));
    }
  }

  /** The first sample with the motors on, from a number on: what came before shows the arm as it was before the pulse. */
  private firstOn(from: number): number {
    const { samples } = this.session;
    const isOn = (number: number): boolean => [State.is.soft_start, State.is.following].some((one) => one === samples.state[number % samples.capacity]);
    let number = Math.max(from, samples.first);
    while (number < samples.end && !isOn(number)) number++;
    return number;
  }

  /** The ticks that have passed since then; 0 before. */
  private sinceOn(from: number): number {
    const { samples } = this.session;
    const on = this.firstOn(from);
    return on < samples.end ? samples.lastTime - samples.timeOf(on) : 0;
  }

  private angles(from: number, joint: number): number[] {
    const { samples } = this.session;
    return Array.from({ length: samples.end - from }, (_, at) => samples.count(from + at, traceOf("follower", joint)));
  }

  /** True if the follower has rested for a while since a sample; it may have been falling since the last pulse. */
  private isStill(from: number, ticks: number, least: number): boolean {
    const begin = this.session.samples.end - ticks;
    return begin >= from && ALL.every((joint) => {
      const angles = this.angles(begin, joint);
      return (Math.max(...angles) - Math.min(...angles)) * COUNT.follower <= least;
    });
  }
}
