// The loop of a bench inside the page, tick by tick: what the page sends, what a person wishes, the lease, the hand.

import type { BenchWish, HandsWish, Range, Size } from "../../session/services";
import { encodeFrame, FrameDecoder } from "../../link/frames";
import { EnableRequest, LeadRequest, RenewRequest, StopRequest } from "../../link/schema";
import type { BenchData, Motion } from "./messages";
import type { BenchModule } from "./module";

const LEASE_MS = 300;
const RENEW_TICKS = 60;
const MOST_START_TICKS = 4000; // a bootloader waits for a host at first
export const SPEED: Range = { minimum: 0.1, maximum: 10, value: 1, step: 0.1 };

const RENEW = encodeFrame(RenewRequest.type, 0, RenewRequest.pack({ lease_ms: LEASE_MS }));

export class BenchLoop {
  /** Simulated seconds a second. */
  speed = SPEED.value;
  private ticks = 0;
  private renewing = false; // while the page wants the motors on
  private starts: number;
  private motion: Motion | null; // null while a person leads
  private since = 0; // tick at which the motion began
  private readonly requests = new FrameDecoder();

  constructor(private readonly module: BenchModule, private readonly data: BenchData) {
    this.motion = data.motions[0]!;
    module.call("power", 1);
    this.starts = module.call("starts");
  }

  /** Lets the board start: until it says hello by itself, as it does where nobody has asked; what it said. */
  start(): Uint8Array {
    let said: Uint8Array;
    let left = MOST_START_TICKS;
    do said = this.tick();
    while (!said.length && --left);
    return said;
  }

  /** Lets a tick pass; what the board said, the callee's only until the next call. */
  tick(): Uint8Array {
    this.ticks++;
    if (this.renewing && this.ticks % RENEW_TICKS === 0) this.send(RENEW);
    if (this.motion) this.module.lead(placeIn(this.motion, (this.ticks - this.since) / 1000));
    return this.module.tick();
  }

  /** True if the board has started anew since this was asked last; then nobody renews a lease. */
  restarted(): boolean {
    const starts = this.module.call("starts");
    if (starts === this.starts) return false;
    this.starts = starts;
    this.renewing = false;
    return true;
  }

  /** What the page sends: words to a bootloader, or frames. A bootloader would take these for words, and wait for more. */
  send(data: Uint8Array, flashes = false): void {
    if (!flashes && this.module.call("in_bootloader")) return;
    this.requests.feed(data, ({ type }) => {
      if (type === EnableRequest.type) this.renewing = true;
      if (type === StopRequest.type || type === LeadRequest.type) this.renewing = false; // a lead is a pulse
    });
    this.module.send(data);
  }

  /** Does one thing to the bench, or fails with a sentence and changes nothing; the seconds that hands need for it. */
  change(wish: BenchWish | HandsWish): number {
    if ("turn" in wish || "pose" in wish || "hang" in wish) return this.hands(wish);
    if ("leader" in wish) this.leadTo(wish.leader);
    else if ("motion" in wish) this.move(wish.motion);
    else if ("fault" in wish) this.break(wish.fault);
    else if ("power" in wish) this.module.call("power", Number(wish.power));
    else if ("estop" in wish) this.module.call("press_estop", Number(wish.estop));
    else if ("clutch" in wish) this.module.call("press_clutch", Number(wish.clutch));
    else this.size(wish);
    return 0;
  }

  private hands(wish: HandsWish): number {
    const takes_s = "turn" in wish ? this.module.call("turn", wish.turn) : "pose" in wish ? this.module.pose(wish.pose) : this.module.call("hang");
    if (!takes_s) throw new Error("The hands are on the arms only while the motors are off, and do one thing after the other: stop the motors, or wait a second.");
    this.motion = null;
    return takes_s;
  }

  private leadTo(angles: readonly number[]): void {
    this.motion = null;
    this.module.lead(angles);
  }

  private move(motion: string): void {
    if (motion === "hold") return this.leadTo(this.module.leader());
    const { motions } = this.data;
    const wanted = motions.find(({ name }) => name === motion);
    if (!wanted) throw new Error(`This bench has no motion "${motion}"; it has ${motions.map(({ name }) => name).join(", ")} and hold.`);
    this.motion = wanted;
    this.since = this.ticks;
  }

  private break(fault: string | null): void {
    if (fault === null) {
      this.module.call("mend");
      return;
    }
    const [name, place = ""] = fault.split(":");
    const calls = this.data.faults.find((one) => one.name === name)?.places[place];
    if (!calls) throw new Error(`"${fault}" is no mistake of this bench; choose one of its list.`);
    for (const call of calls) this.module.call(...call);
  }

  private size({ supply, load, noise, play, speed }: { readonly [size in Size]?: number }): void {
    if (supply !== undefined) this.module.call("change_supply", within("supply", "V", supply, this.data.supply));
    if (load !== undefined) this.module.call("load_tip", within("load", "kg", load, this.data.load));
    if (noise !== undefined) this.module.call("scale_noise", within("noise", "times", noise, this.data.noise));
    if (play !== undefined) this.module.call("scale_play", within("play", "times", play, this.data.play));
    if (speed !== undefined) this.speed = within("speed", "times", speed, SPEED);
  }
}

/** The place of a person's hand in a motion that goes there and back again, for ever. */
function placeIn({ hz, rows }: Motion, seconds: number): number[] {
  const last = rows.length - 1;
  const along = (seconds * hz) % (2 * last);
  const at = along < last ? along : 2 * last - along;
  const row = Math.min(Math.floor(at), last - 1);
  const [from, to] = [rows[row]!, rows[row + 1]!];
  return from.map((angle, joint) => angle + (at - row) * (to[joint]! - angle));
}

function within(what: string, unit: string, value: number, { minimum, maximum }: Range): number {
  if (value >= minimum && value <= maximum) return value;
  throw new Error(`The ${what} is ${value} ${unit}; choose one from ${minimum} to ${maximum}.`);
}
