// The tuner of the host: the verb `tune` on a model of the folder, whose file becomes the edited controllers.

import { inFile, rawOf } from "../files/raw_value";
import { TABLE } from "../link/schema";
import { freeName } from "../parts/file_words";
import { SETTING_NAMES } from "../session/law";
import type { Job, Json, Model, Searched, Services, Tuned, Tuner } from "../session/services";

const COST = /^(?:cost|J) (\d+(?:\.\d+)?)$/; // in what the verb notes beside its progress
const REACHES = "human-like reaches"; // the motion whose error is told
const OUT = "controller.toml";

type Rows = readonly (readonly number[])[];
type Named = Readonly<Record<string, number>>; // a parameter's value or raw value
type Evaluated = { readonly joints: readonly { readonly mse_rad2: number }[] };
/** The parts of the verb's result that are read here. */
type Result = {
  readonly before: Named;
  readonly notes: readonly string[];
  readonly held_out: readonly { readonly motion: string; readonly before: Evaluated; readonly after: Evaluated }[];
  readonly curves: readonly { readonly evaluations: readonly number[]; readonly cost: readonly number[] }[];
};

export class HostTuner implements Tuner {
  readonly promise = "greywhale tune searches controllers for the model that the prediction has, and writes them into a new file of the "
    + "folder. It begins with what the board ran in the model's logs, or with the firmware's defaults.";
  readonly limits = "It takes from 20 seconds to a minute, and judges each controller on arms as likely as the model. A model that "
    + "greywhale identify has not found sound is refused with the reason. The form of tune in Do has every option.";
  private readonly jobs = new Map<string, Job>();
  private changed = (): void => undefined;
  private listens = false;
  private id = "";

  constructor(private readonly services: Pick<Services, "jobs" | "state" | "controller">) {}

  async tune(edited: Rows, model: Model, heard: (searched: Searched) => void): Promise<Tuned> {
    const { jobs } = this.services;
    if (!this.listens) jobs.listen((job) => this.hear(job));
    this.listens = true;
    const out = freeName(OUT, (await this.services.state()).files);
    this.id = await jobs.start("tune", { model_file: model.name, out, ...(model.identified ? {} : { force: true }) });
    const course = new Course();
    const job = await this.end((running) => heard(course.of(running)));
    if (job.state === "done") return this.tuned(edited, out, job.result as Json & Result, heard);
    if (job.state !== "stopped") throw new Error(job.error ?? "tune has failed.");
    const after = await this.rows(edited, out, job.error ?? "tune was stopped.");
    return { ...NO_PICTURE, before: edited, after, notes: [job.error ?? ""], mse: [] };
  }

  stop(): void {
    if (this.id) void this.services.jobs.stop(this.id);
  }

  private hear(job: Job): void {
    if (job.verb !== "tune") return;
    this.jobs.set(job.id, job);
    this.changed();
  }

  /** The job once it has ended; `heard` gets it after every change. */
  private end(heard: (job: Job) => void): Promise<Job> {
    return new Promise((settle) => {
      this.changed = () => {
        const job = this.jobs.get(this.id);
        if (!job) return;
        heard(job);
        if (job.state !== "running") settle(job);
      };
      this.changed();
    });
  }

  private async tuned(edited: Rows, out: string, result: Result, heard: (searched: Searched) => void): Promise<Tuned> {
    const { before, notes, held_out, curves } = result;
    const shown = held_out.find(({ motion }) => motion === REACHES);
    const { evaluations = [] } = curves[0] ?? {};
    heard({ share: 1, words: "", curve: { unit: "sets", x: evaluations, y: curves.map(({ cost }) => cost) } });
    return {
      ...NO_PICTURE,
      before: inFile("tune", () => filled(edited, (name) => {
        const value = before[name];
        return value === undefined ? undefined : rawOf(TABLE.named(name), value);
      })),
      after: await this.rows(edited, out, ""),
      notes: [`Written: ${out}.`, ...notes],
      mse: shown ? [shown.before, shown.after].map(({ joints }) => joints.map(({ mse_rad2 }) => mse_rad2)) : [],
    };
  }

  /** The controllers of a file; `why` tells of one that is not there. */
  private async rows(edited: Rows, file: string, why: string): Promise<Rows> {
    try {
      const raw = await this.services.controller(file);
      return filled(edited, (name) => raw[name]);
    } catch (error) {
      throw why ? new Error(why) : error;
    }
  }
}

const NO_PICTURE = { time_s: [], leader: [], followers: [] } as const;

/** Rows of settings by their names; what is not named is as it was. */
function filled(rows: Rows, value: (name: string) => number | undefined): Rows {
  return rows.map((row, joint) => row.map((was, place) => value(`joint${joint}.${SETTING_NAMES[place]}`) ?? was));
}

/** The course of the search as the verb tells it. */
class Course {
  private readonly x: number[] = [];
  private readonly cost: number[] = [];

  of({ progress }: Job): Searched {
    const share = progress ? progress.done / (progress.total || 1) : 0;
    const cost = COST.exec(progress?.note ?? "")?.[1];
    if (cost !== undefined && share > (this.x.at(-1) ?? -1) / 100) {
      this.x.push(100 * share);
      this.cost.push(Number(cost));
    }
    const words = progress ? `${progress.text}: ${Math.round(100 * share)} %${cost === undefined ? "" : `; the best cost together ${cost}`}.` : "greywhale tune begins.";
    return { share, words, curve: { unit: "% of the search", x: [...this.x], y: [[...this.cost]] } };
  }
}
