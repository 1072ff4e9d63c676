// What Start knows of a board, a folder and the verbs that ran: read anew from them each time, and kept nowhere.

import { SCHEMA_HASH, TABLE } from "../../link/schema";
import type { HostState, Job, Services } from "../../session/services";
import type { Session } from "../../session/session";

/** The files of some kind, by name. */
export type FilesOf = (kind: string) => readonly string[];

export class Facts {
  /** The newest job of each verb. */
  readonly jobs = new Map<string, Job>();
  /** A controller file whose numbers the board runs, null where none is known. */
  running: string | null = null;
  private moved = false;
  private host: HostState | null = null;
  private readonly numbers = new Map<string, Readonly<Record<string, number>>>(); // of controller files

  /** `services` are those of a host, null without one; `heard` is called whenever a job has changed. */
  constructor(readonly session: Session, private readonly services: Services | null, heard: (job: Job) => void) {
    session.changed.on(() => { this.moved ||= session.motorsOn; });
    services?.jobs.listen((job) => {
      this.jobs.delete(job.verb);
      this.jobs.set(job.verb, job);
      heard(job);
    });
  }

  readonly files: FilesOf = (kind) => (this.host?.files ?? []).filter((file) => file.kind === kind).map(({ name }) => name);

  /** True once the folder was read. */
  get hasFolder(): boolean {
    return this.host !== null;
  }

  /** True if the motors were on while this page, or a verb that left a log, looked. */
  get hasMoved(): boolean {
    return this.moved || this.files("log").length > 0;
  }

  /** Reads the folder anew. */
  async readFolder(): Promise<void> {
    if (!this.services) return;
    this.host = await this.services.state();
    this.numbers.clear();
    for (const name of this.files("controller")) this.numbers.set(name, await this.services.controller(name));
    this.compare();
  }

  /** Looks which of the folder's controllers the board runs. */
  compare(): void {
    const { parameters } = this.session;
    const runs = ([name, value]: [string, number]): boolean => parameters?.[TABLE.named(name).index] === value;
    this.running = [...this.numbers].find(([, raw]) => Object.entries(raw).every(runs))?.[0] ?? null;
  }

  /** True if something is at the port that does not answer, as a board without this firmware. */
  get isUnflashed(): boolean {
    return this.session.link.unflashed ?? false;
  }

  /** True if the board speaks this page's words; null while none has said hello. */
  get speaks(): boolean | null {
    const { link, hello } = this.session;
    return link.open && hello ? hello.schema_hash === SCHEMA_HASH : null;
  }

  /** Those of these parameters that differ from the shipped ones, or null while the set is not read. */
  changed(names: readonly string[]): readonly string[] | null {
    const { parameters } = this.session;
    return parameters && names.filter((name) => {
      const { index, initial } = TABLE.named(name);
      return parameters[index] !== initial;
    });
  }

  /** A parameter of the running set in its unit. */
  value(name: string): number {
    const { index, lsb } = TABLE.named(name);
    return (this.session.parameters?.[index] ?? NaN) * lsb;
  }
}
