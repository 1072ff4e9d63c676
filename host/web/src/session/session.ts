// Everything that views share of one board: its samples, its words, its parameters, and the right to change them.

import type { Board, DriverState, LinkState } from "./board";
import { LinkClient } from "../link/client";
import { LinkError, RefusedError } from "../link/declared";
import {
  ClearFaultRequest, ClutchRequest, EnableRequest, Fault, HelloReply, HelloRequest, LeadPointRequest, LeadReply, LeadRequest, NackCode,
  ParamApplyRequest, ParamGetRequest, ParamSaveRequest, ParamSetRequest, SaveState, SCHEMA_HASH, State, StatusReply, StatusRequest, StopReason, StopRequest, TABLE, TelemetryRequest,
} from "../link/schema";
import { sentenceOf } from "../parts/sentence";
import { Signal } from "../parts/signal";
import { Intake } from "./intake";
import { Samples } from "./samples";

export const LEASE_MS = 300;
const STATUS_EVERY_MS = 500;
const AT_ONCE = 3; // requests on their way to a board, whose receiver is small and has other pages too
const GREETINGS = 10; // until a person is told

const LEASE_RAN_OUT = "The motors are off: nobody renewed their lease in time. This computer was too busy, the cable was off, or the page was hidden; enable them again.";

export type Notice = { readonly sentence: string; readonly kind: "error" | "info" };

export class Session {
  readonly samples = new Samples();
  readonly changed = new Signal(); // link, driver, hello, status
  readonly parametersChanged = new Signal();
  readonly noticed = new Signal();
  link: LinkState = { open: false, port: "", sentence: "" };
  driver: DriverState = { you: false, free: true, verb: null };
  hello: HelloReply | null = null;
  status: StatusReply | null = null;
  /** The running parameter set in raw values, null until it is read. */
  parameters: readonly number[] | null = null;
  /** CRC of the set that the board stores, null while nobody saw it start or store. */
  storedCrc: number | null = null;
  private readonly known = new Map<number, readonly number[]>(); // sets by their CRC
  notice: Notice | null = null;
  /** True while a verb counts down before it moves the arm. */
  counting = false;
  /** The number of times that a stop was asked for since the page was opened, here or elsewhere. */
  stopsAsked = 0;
  private readonly client: LinkClient;
  private asking = false;
  /** The motors that this page has enabled: asked for, seen on, or none. */
  private own: "asked" | "on" | "" = "";
  private toldOff = ""; // the sentence that told that the motors are off
  private refused = ""; // the sentence of the last request that the board refused
  private reading: Promise<readonly number[]> | null = null;
  private readonly intake: Intake;

  constructor(private readonly board: Board) {
    this.intake = new Intake(this.samples, (from) => board.history(from), (act) => this.attempt(act));
    this.client = new LinkClient((frame) => board.send(frame), {
      sample: (payload) => this.intake.add(payload),
      hello: (reply) => this.restarted(reply),
    });
    board.listen({
      bytes: (data) => this.client.receive(data),
      link: (state) => this.linked(state),
      driver: (state) => {
        this.driver = state;
        this.changed.emit();
      },
      stored: (crc) => this.learnStored(crc),
      refused: (seq, type, sentence) => {
        this.client.refuse(seq, type, sentence);
        if (!type) this.tellOff(sentence);
      },
      stopped: (sentence) => {
        this.stopsAsked++;
        this.tellOff(sentence, "info");
      },
    });
    setInterval(() => void this.askStatus(), STATUS_EVERY_MS);
  }

  /** State by the newest sample, which is ahead of the last status. */
  get state(): number {
    const { samples } = this;
    return samples.end ? samples.state[(samples.end - 1) % samples.capacity]! : (this.status?.state ?? State.is.boot);
  }

  get motorsOn(): boolean {
    return this.link.open && (this.state === State.is.soft_start || this.state === State.is.following);
  }

  /** True if the board has never stored a set, so that it starts with its defaults. */
  get storesNothing(): boolean {
    return this.status?.saves === 0;
  }

  /** The set that the board starts with; null where it is not known. */
  get stored(): readonly number[] | null {
    if (this.storesNothing) return TABLE.parameters.map(({ initial }) => initial);
    return this.storedCrc === null ? null : this.known.get(this.storedCrc) ?? null;
  }

  private learnStored(crc: number | null): void {
    this.storedCrc = crc;
    this.parametersChanged.emit();
  }

  private runs(raw: readonly number[]): void {
    this.parameters = raw;
    this.known.set(TABLE.crc(raw), raw);
    this.parametersChanged.emit();
  }

  /** Frames that were damaged between the board and this page. */
  get damaged(): number {
    return this.client.bad;
  }

  tell(sentence: string, kind: Notice["kind"] = "error"): void {
    this.notice = { sentence, kind };
    this.noticed.emit();
  }

  /** Tells that the motors are off, until this page enables them. */
  private tellOff(sentence: string, kind: Notice["kind"] = "error"): void {
    this.toldOff = sentence;
    this.tell(sentence, kind);
  }

  /** Takes back what held until now: that the motors are off, or why the board refused something. */
  private mended(): void {
    if (this.notice && [this.toldOff, this.refused].includes(this.notice.sentence)) this.withdraw();
  }

  /** Takes a notice back that holds no more. */
  private withdraw(): void {
    this.notice = null;
    this.noticed.emit();
  }

  /** Runs what a person asked for; an error becomes a notice. */
  async attempt(act: () => Promise<void>): Promise<boolean> {
    try {
      await act();
      return true;
    } catch (error) {
      const sentence = sentenceOf(error);
      if (error instanceof RefusedError) this.refused = sentence;
      this.tell(sentence);
      return false;
    }
  }

  drive(): void {
    this.board.drive();
  }

  /** The reason why this page leaves a simulated bench alone, in a sentence: another one drives its arm. Else empty. */
  get whyNotBench(): string {
    return this.link.open && !this.driver.free ? this.whyNotDrive : "";
  }

  /** The reason why this page may not change what the board does, in a sentence; empty where it may. */
  get whyNotDrive(): string {
    if (this.driver.you) return "";
    return this.driver.free
      ? "This page only watches; choose `Take control` first."
      : "Another page drives this arm; let go there first.";
  }

  /** That reason, or what of the host uses the board in the place of any page. */
  get whyNotChange(): string {
    const { verb } = this.driver;
    return verb === null ? this.whyNotDrive : `\`greywhale ${verb}\` uses the board; stop it first, or wait for its end.`;
  }

  /** The reason why this page cannot enable the motors now, in a sentence; empty where it can. */
  get whyNotEnable(): string {
    if (!this.link.open) return "No board is there.";
    if (this.faulty) return "A fault keeps the motors off; do what it says, and clear it.";
    return this.whyNotChange || (this.motorsOn ? "The motors are on." : "");
  }

  get faulty(): boolean {
    return this.link.open && this.status !== null && this.status.fault !== Fault.is.none;
  }

  private mustDrive(): void {
    if (this.whyNotDrive) throw new LinkError(this.whyNotDrive);
  }

  release(): void {
    this.board.release();
  }

  async enable(): Promise<void> {
    this.mustDrive();
    await this.client.ask(EnableRequest, { lease_ms: LEASE_MS });
    this.own = "asked";
    this.mended();
    await this.askStatus();
  }

  async stop(): Promise<void> {
    this.stopsAsked++;
    await this.client.ask(StopRequest, {});
    await this.askStatus();
  }

  /** Does something with the motors off. Those that ran start again, unless a person stops them meanwhile. */
  async withMotorsOff(act: () => Promise<void>): Promise<void> {
    const running = this.motorsOn;
    const stops = this.stopsAsked + Number(running);
    if (running) await this.stop();
    await act();
    if (running && this.stopsAsked === stops) await this.enable();
  }

  /** Starts the motors with the page in the leader's place, for so long at most, and sends one point: where it begins, and the step. */
  async lead(lease_ms: number, step: readonly number[]): Promise<LeadReply> {
    this.mustDrive();
    this.own = ""; // its lease ends what it moves
    const begun = await this.client.ask(LeadRequest, { lease_ms });
    await this.client.ask(LeadPointRequest, { number: begun.next, step });
    return begun;
  }

  /** Moves the leader without the follower, or takes it up again from there. */
  async clutch(action: number): Promise<void> {
    this.mustDrive();
    await this.client.ask(ClutchRequest, { action });
    await this.askStatus();
  }

  /** The board's tick by its own word; samples of it may still be on their way. */
  async tick(): Promise<number> {
    return (await this.client.ask(StatusRequest, {})).tick;
  }

  async clearFault(): Promise<void> {
    await this.client.ask(ClearFaultRequest, {});
    this.mended();
    await this.askStatus();
  }

  // --- parameters -----------------------------------------------------------------------------------------------------

  /** The running set: as it is known while the board says that nobody has changed it, else read from the board. */
  async readParameters(): Promise<readonly number[]> {
    const { parameters } = this;
    if (parameters) {
      this.hello = await this.client.ask(HelloRequest, {});
      if (this.hello.param_crc === TABLE.crc(parameters)) return parameters;
    }
    this.reading ??= this.fetchParameters().finally(() => { this.reading = null; });
    return this.reading;
  }

  private async fetchParameters(): Promise<readonly number[]> {
    const raw = new Array<number>(TABLE.parameters.length);
    const left = TABLE.parameters.map(({ index }) => index);
    const read = async (): Promise<void> => {
      for (let index = left.shift(); index !== undefined; index = left.shift()) {
        raw[index] = (await this.client.ask(ParamGetRequest, { index })).value;
      }
    };
    await Promise.all(Array.from({ length: AT_ONCE }, read));
    this.runs(raw);
    return raw;
  }

  /** Makes a whole set the running one; nothing is stored. The motors must be off. */
  async apply(raw: readonly number[]): Promise<void> {
    const before = await this.readParameters();
    const changed = TABLE.parameters.filter(({ index }) => raw[index] !== before[index]);
    try {
      await this.stageAndApply(changed.map(({ index }) => index), raw);
    } catch (error) {
      if (!(error instanceof RefusedError) || error.code !== NackCode.is.crc_mismatch) throw error;
      // Another host has left values in the staged set: all of them, then.
      await this.stageAndApply(TABLE.parameters.map(({ index }) => index), raw);
    }
    this.runs([...raw]);
  }

  private async stageAndApply(indices: readonly number[], raw: readonly number[]): Promise<void> {
    for (const index of indices) await this.client.ask(ParamSetRequest, { index, value: raw[index]! });
    await this.client.ask(ParamApplyRequest, { crc: TABLE.crc(raw) });
  }

  /** Writes the running set to the board's EEPROM; returns when it is written. */
  async store(): Promise<void> {
    const raw = await this.readParameters();
    await this.client.ask(ParamSaveRequest, {});
    do {
      this.status = await this.client.ask(StatusRequest, {});
    } while (this.status.save_state === SaveState.is.saving);
    if (this.status.save_state === SaveState.is.failed) {
      throw new LinkError("The board could not store the set, and keeps the one before; check its supply and store again.");
    }
    this.learnStored(TABLE.crc(raw));
  }

  // --- what comes -------------------------------------------------------------------------------------------------------

  private restarted(reply: HelloReply): void {
    this.hello = reply;
    this.intake.startTold = true;
    this.parameters = null;
    this.learnStored(reply.param_crc);
    void this.greet();
  }

  private linked(state: LinkState): void {
    const opened = state.open && !this.link.open;
    const holdsNoMore = this.link.sentence !== state.sentence && this.notice?.sentence === this.link.sentence;
    this.link = state;
    if (!state.open) {
      this.client.abandon(state.sentence || "The board went away.");
      this.status = null;
      this.parameters = null;
      this.storedCrc = null;
    }
    if (opened || holdsNoMore) this.withdraw();
    if (state.sentence && this.hello) this.tell(state.sentence, state.open ? "info" : "error");
    this.changed.emit();
    if (opened) void this.greet();
  }

  /** Learns who is there, again while a board that has just started is still silent. */
  private async greet(): Promise<void> {
    for (let left = GREETINGS; this.link.open; left--) {
      try {
        await this.meet();
        break;
      } catch (error) {
        if (left <= 0) {
          this.tell(sentenceOf(error));
          break;
        }
        await new Promise((resolve) => setTimeout(resolve, STATUS_EVERY_MS));
      }
    }
    this.changed.emit();
  }

  private async meet(): Promise<void> {
    this.hello = await this.client.ask(HelloRequest, {});
    if (this.hello.schema_hash !== SCHEMA_HASH) {
      throw new LinkError("The board's firmware is another version than this page; flash it with `greywhale flash`.");
    }
    const status = await this.client.ask(StatusRequest, {});
    this.intake.startTold = status.tick < this.samples.lastTick;
    this.status = status;
    this.changed.emit();
    await this.client.ask(TelemetryRequest, { every: 1 });
    await this.intake.begin();
    await this.readParameters();
  }

  /** Motors that this page enabled went off by their lease: nobody has asked for that, so a person is told. */
  private noteOwn({ state, stop_reason }: StatusReply): void {
    const on = state === State.is.soft_start || state === State.is.following;
    if (on && this.own) this.own = "on";
    if (on || this.own !== "on") return;
    this.own = "";
    if (stop_reason === StopReason.is.lease) this.tellOff(LEASE_RAN_OUT);
  }

  private async askStatus(): Promise<void> {
    if (!this.link.open || this.asking) return;
    this.asking = true;
    const { storesNothing } = this;
    try {
      this.status = await this.client.ask(StatusRequest, {});
      this.noteOwn(this.status);
      if (this.storesNothing !== storesNothing) this.parametersChanged.emit(); // its CRC may have been here before
      if (this.parameters) await this.readParameters(); // a verb, another page or another host may have changed it
    } catch {
      this.status = null; // a board that stays silent is told by its source
    } finally {
      this.asking = false;
    }
    this.changed.emit();
  }
}
