// Keeps the lease of enabled motors while the page is visible and the board says each tick that it lives, by the board's own
// time. A lease with which the page leads is not renewed: it ends a pulse.

import { encodeFrame, FrameDecoder } from "../../link/frames";
import { EnableRequest, HelloReply, LeadRequest, RenewRequest, Sample, State, StopRequest } from "../../link/schema";

const LEASE_MS = 300;
const RENEW_TICKS = 60;
const RENEW = encodeFrame(RenewRequest.type, 0, RenewRequest.pack({ lease_ms: LEASE_MS }));
const AT = { tick: Sample.place("tick").at, state: Sample.place("state").at };

export class Lease {
  /** True if the board sends samples since it started, as far as was seen. */
  samples = false;
  private wanted = false; // by the page, until the motors go off
  private moved = false; // whether they have been seen on since
  private renewed = 0; // tick
  private readonly sent = new FrameDecoder();
  private readonly heard = new FrameDecoder();

  constructor(private readonly send: (frame: Uint8Array) => void, private readonly visible: () => boolean) {}

  /** Looks at what the page sends; whether it stops the motors. */
  onSent(data: Uint8Array): boolean {
    let stops = false;
    this.sent.feed(data, ({ type }) => {
      if (type === EnableRequest.type) {
        this.wanted = true;
        this.moved = false;
      }
      if (type === StopRequest.type || type === LeadRequest.type) this.wanted = false;
      stops ||= type === StopRequest.type;
    });
    return stops;
  }

  /** Looks at what the board says; `restarted` is told with its greeting after a start. */
  onHeard(data: Uint8Array, restarted: (hello: HelloReply) => void): void {
    this.heard.feed(data, ({ type, seq, payload }) => {
      if (type === Sample.type && payload.length === Sample.size) this.look(payload);
      if (type === HelloReply.type && seq === 0 && payload.length === HelloReply.size) {
        this.wanted = this.samples = false;
        restarted(HelloReply.unpack(payload));
      }
    });
  }

  private look(sample: Uint8Array): void {
    this.samples = true;
    if (!this.wanted) return;
    const tick = new DataView(sample.buffer, sample.byteOffset).getUint32(AT.tick, true);
    const on = sample[AT.state] === State.is.soft_start || sample[AT.state] === State.is.following;
    if (this.moved && !on) this.wanted = false;
    this.moved ||= on;
    if (!this.visible() || Math.abs(tick - this.renewed) < RENEW_TICKS) return;
    this.renewed = tick;
    this.send(RENEW);
  }
}
