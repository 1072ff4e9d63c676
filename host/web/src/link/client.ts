// Requests and their replies over frames: sequence numbers, repeats after silence, refusals as sentences.

import { LinkError, RefusedError, type Message, type Request } from "./declared";
import { encodeFrame, FrameDecoder, type Frame } from "./frames";
import { refusalSentence } from "./refusal";
import { HelloReply, Nack, Sample } from "./schema";

export const PATIENCE_MS = 500; // until a request is sent again
const ATTEMPTS = 4;

type Waiting = {
  readonly request: Message<object>;
  readonly arrived: (payload: Uint8Array) => void;
  readonly failed: (error: LinkError) => void;
  timer?: ReturnType<typeof setTimeout>; // of the next attempt
};

/** Messages that come without being asked for: samples, and the hello of a board that restarted. */
export type Unasked = {
  sample(payload: Uint8Array): void;
  hello(reply: HelloReply): void;
};

export class LinkClient {
  private readonly decoder = new FrameDecoder();
  private readonly waiting = new Map<number, Waiting>();
  private last = 0; // 0 itself is for frames that nobody asked for

  constructor(private readonly send: (frame: Uint8Array) => void, private readonly unasked: Unasked) {}

  /** Frames that were damaged on their way here. */
  get bad(): number {
    return this.decoder.bad;
  }

  /** Sends a request, again after silence, and gives its reply; fails with one sentence. */
  ask<Values extends object, Reply extends object>(request: Request<Values, Reply>, values: Values): Promise<Reply> {
    const payload = request.pack(values);
    return new Promise((resolve, reject) => {
      const seq = this.freeSeq();
      if (seq === null) {
        reject(new LinkError("255 requests wait for this board already; wait for their replies."));
        return;
      }
      const settle = (act: () => void): void => {
        clearTimeout(this.waiting.get(seq)?.timer);
        this.waiting.delete(seq);
        act();
      };
      this.waiting.set(seq, {
        request,
        arrived: (bytes) => settle(() => {
          try {
            resolve(request.reply().unpack(bytes));
          } catch (error) {
            reject(error);
          }
        }),
        failed: (error) => settle(() => reject(error)),
      });
      this.attempt(seq, encodeFrame(request.type, seq, payload), ATTEMPTS);
    });
  }

  private attempt(seq: number, frame: Uint8Array, left: number): void {
    const waiting = this.waiting.get(seq);
    if (!waiting) return;
    if (left === 0) {
      waiting.failed(new LinkError(
        `The board does not answer ${waiting.request.name}; check that it is connected and has power.`,
      ));
      return;
    }
    waiting.timer = setTimeout(() => this.attempt(seq, frame, left - 1), PATIENCE_MS);
    this.send(frame);
  }

  private freeSeq(): number | null {
    for (let tries = 0; tries < 255; tries++) {
      this.last = (this.last % 255) + 1;
      if (!this.waiting.has(this.last)) return this.last;
    }
    return null;
  }

  /** Takes bytes as they come. */
  receive(bytes: Uint8Array): void {
    this.decoder.feed(bytes, (frame) => this.dispatch(frame));
  }

  private dispatch({ type, seq, payload }: Frame): void {
    if (type === Sample.type) {
      if (payload.length === Sample.size) this.unasked.sample(payload);
      return;
    }
    const waiting = this.waiting.get(seq);
    if (type === Nack.type && payload.length === Nack.size) {
      const nack = Nack.unpack(payload);
      if (waiting?.request.type === nack.request) {
        waiting.failed(new RefusedError(refusalSentence(waiting.request.name, nack), nack.code));
      }
    } else if (waiting && (waiting.request as Request<object, object>).reply().type === type) {
      waiting.arrived(payload);
    } else if (type === HelloReply.type && seq === 0 && payload.length === HelloReply.size) {
      this.unasked.hello(HelloReply.unpack(payload));
    }
  }

  /** Ends one request that was refused on its way, before it reached the board. */
  refuse(seq: number, type: number, sentence: string): void {
    const waiting = this.waiting.get(seq);
    if (waiting?.request.type === type) waiting.failed(new LinkError(sentence));
  }

  /** Ends every request: the board went. */
  abandon(sentence: string): void {
    for (const waiting of [...this.waiting.values()]) waiting.failed(new LinkError(sentence));
    this.decoder.reset();
  }
}
