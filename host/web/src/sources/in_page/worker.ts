// The worker in which the bench lives: by the wall clock, and never far ahead of what the page has worked off.

import { sentenceOf } from "../../parts/sentence";
import { Clock } from "./clock";
import { BenchLoop } from "./bench_loop";
import type { FromBench, ToBench } from "./messages";
import { BenchModule } from "./module";

const TURN_MS = 4;
const MOST_TURN_MS = 30; // so that a stop is heard in time, however fast time shall be
const MOST_UNREAD = 65_536; // bytes, about 1.5 s of samples

const page = globalThis as unknown as {
  postMessage(message: FromBench, transfer?: Transferable[]): void;
  addEventListener(kind: "message", heard: (event: MessageEvent<ToBench>) => void): void;
};

class Bench {
  private readonly loop: BenchLoop;
  private readonly clock = new Clock();
  private visible = true;
  private unread = 0;
  private kept: Uint8Array; // of the EEPROM
  private restarted = false; // and has said nothing since
  private readonly timer = setInterval(() => this.guard(() => this.turn()), TURN_MS);

  constructor(private readonly module: BenchModule, { data, eeprom }: Extract<ToBench, { kind: "start" }>) {
    if (eeprom) module.setEeprom(eeprom);
    this.loop = new BenchLoop(module, data);
    this.pass(this.loop.start().slice()); // by its hello, the page learns what the board stores
    this.kept = module.eeprom();
  }

  hear(message: ToBench): void {
    switch (message.kind) {
      case "start":
        break;
      case "send":
        this.guard(() => this.loop.send(message.data, message.flashes));
        break;
      case "reset":
        this.guard(() => this.module.call("reset"));
        break;
      case "wish":
        this.change(message);
        break;
      case "visible":
        this.visible = message.on;
        break;
      case "taken":
        this.unread -= message.count;
        break;
    }
  }

  private change({ id, wish }: Extract<ToBench, { kind: "wish" }>): void {
    let error: string | null = null;
    let takes_s = 0;
    try {
      takes_s = this.loop.change(wish);
    } catch (problem) {
      if (problem instanceof WebAssembly.RuntimeError) return this.fail(problem);
      error = sentenceOf(problem);
    }
    page.postMessage({ kind: "done", id, error, takes_s });
  }

  private turn(): void {
    if (!this.visible || this.unread > MOST_UNREAD) {
      this.clock.hold();
      return;
    }
    const said: Uint8Array[] = [];
    const now = performance.now();
    let left = this.clock.due(now, this.loop.speed);
    for (; left && performance.now() < now + MOST_TURN_MS; left--) said.push(this.loop.tick().slice());
    this.clock.owe(left);
    if (this.module.call("crashed")) throw new Error("the program on its board has crashed");
    const size = said.reduce((sum, piece) => sum + piece.length, 0);
    this.keepEeprom(); // before the board can say that it has stored something
    this.restarted ||= this.loop.restarted();
    if (size) {
      if (this.restarted) page.postMessage({ kind: "restarted" });
      this.restarted = false;
      const data = new Uint8Array(size);
      said.reduce((at, piece) => (data.set(piece, at), at + piece.length), 0);
      this.pass(data);
    }
  }

  private pass(data: Uint8Array<ArrayBuffer>): void {
    this.unread += data.length;
    page.postMessage({ kind: "bytes", data }, [data.buffer]);
  }

  private keepEeprom(): void {
    const content = this.module.eeprom(); // not a count of writes, which is ahead of a busy cell
    if (content.every((byte, i) => byte === this.kept[i])) return;
    this.kept = content;
    page.postMessage({ kind: "eeprom", content });
  }

  private guard(act: () => void): void {
    try {
      act();
    } catch (problem) {
      this.fail(problem);
    }
  }

  private fail(problem: unknown): void {
    clearInterval(this.timer);
    const why = sentenceOf(problem);
    page.postMessage({ kind: "failed", sentence: `The simulated bench has ended (${why}); reload the page.` });
  }
}

let bench: Bench | null = null;

page.addEventListener("message", ({ data: message }) => {
  if (message.kind !== "start") return bench?.hear(message);
  const { code, data, firmware } = message;
  BenchModule.load(code, data.numbers, data.bootloader, firmware).then(
    (module) => {
      bench = new Bench(module, message);
      page.postMessage({ kind: "ready" });
    },
    (error: unknown) => page.postMessage({ kind: "failed", sentence: sentenceOf(error) }),
  );
});
