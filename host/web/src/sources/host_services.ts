// The host behind the dashboard's server, over HTTP: every request carries the token, every error is a sentence.

import type {
  ArmAnswers, ArmDescription, Bench, Calibrations, Files, Heading, HostState, Job, Jobs, KeptCalibration, Model, Prediction, Predictor,
  OutsideTorque, Services, Torques, Tuner, Verb,
} from "../session/services";
import { HostTuner } from "./host_tuner";

type Method = "GET" | "POST" | "PUT" | "DELETE";
type Listener = { readonly heard: (job: Job) => void; readonly gone: (id: string) => void };

const AGAIN_MS = 1000; // until a server that went is tried again

export class HostServices implements Services {
  readonly bench: Bench = {
    controls: () => this.ask("GET", "/bench"),
    change: (wish) => this.ask<unknown>("POST", "/bench", wish).then(() => undefined),
    hands: async (wish) => (await this.ask<{ takes_s: number }>("POST", "/bench", wish)).takes_s,
  };

  readonly jobs: Jobs = {
    verbs: async () => (await this.ask<{ verbs: Verb[] }>("GET", "/jobs")).verbs,
    start: async (verb, given) => (await this.ask<Job>("POST", "/jobs", { verb, arguments: given })).id,
    stop: (id) => this.ask<unknown>("DELETE", `/jobs/${encodeURIComponent(id)}`).then(() => undefined),
    putAway: (id) => this.ask<unknown>("DELETE", `/jobs/${encodeURIComponent(id)}/card`).then(() => undefined),
    listen: (heard, gone = () => undefined) => {
      this.listeners.push({ heard, gone });
      if (this.listeners.length === 1) this.hear();
    },
  };
  readonly files: Files = {
    fetch: async (name) => (await this.request("GET", fileAddress(name))).blob(),
    bring: async (name, content, ifThere) => {
      const answer = await this.request("PUT", `${fileAddress(name)}&if_there=${ifThere}`, content);
      return (await answer.json() as { name: string }).name;
    },
    rename: (name, to) => this.ask<unknown>("POST", "/file", { name, to }).then(() => undefined),
    remove: (name) => this.ask<unknown>("DELETE", fileAddress(name)).then(() => undefined),
  };

  readonly calibrations: Calibrations = {
    list: async () => (await this.ask<{ calibrations: KeptCalibration[] }>("GET", "/calibrations")).calibrations,
    keep: (raw, board, why) => this.ask<unknown>("POST", "/calibrations", { raw, board, why }).then(() => undefined),
  };

  readonly predictor: Predictor = {
    models: async () => modelsIn(await this.state()),
    predict: (raw, board, { name }) => this.ask<Prediction>("POST", "/predict", { raw, board, file: name }),
  };

  readonly torques: Torques = {
    listen: (model, filterShift, heard, refused) => {
      const path = `/torque?${new URLSearchParams({ file: model, filter_shift: String(filterShift) })}`;
      let socket: WebSocket;
      let over = false;
      const open = (): void => {
        if (over) return;
        socket = this.open(path, (told: OutsideTorque | { readonly error: string }) => {
          if (over) return;
          over = "error" in told;
          "error" in told ? refused(told.error) : heard(told);
        }, open);
      };
      open();
      return () => {
        over = true;
        socket.close();
      };
    },
  };

  readonly tuner: Tuner = new HostTuner(this);
  private readonly listeners: Listener[] = [];

  constructor(private readonly token: string, private readonly page: () => string) {}

  private hear(): void {
    this.open("/host", (job: Job) => {
      for (const { heard, gone } of this.listeners) job.kind === "gone" ? gone(job.id) : heard(job);
    }, () => this.hear());
  }

  /** Opens a WebSocket that tells objects; a while after it has closed, `again` is called. */
  private open<Told>(path: string, heard: (told: Told) => void, again: () => void): WebSocket {
    const socket = new WebSocket(`ws://${location.host}${path}`, ["greywhale", `token.${this.token}`]);
    socket.addEventListener("message", ({ data }: MessageEvent<string>) => heard(JSON.parse(data) as Told));
    socket.addEventListener("close", () => setTimeout(again, AGAIN_MS));
    return socket;
  }

  state(): Promise<HostState> {
    return this.ask("GET", "/state");
  }

  async log(file: string): Promise<Uint8Array> {
    return new Uint8Array(await (await this.request("GET", `/log?file=${encodeURIComponent(file)}`)).arrayBuffer());
  }

  async controller(file: string): Promise<Readonly<Record<string, number>>> {
    const answer = await this.ask<{ raw: Record<string, number> }>("GET", `/controller?file=${encodeURIComponent(file)}`);
    return answer.raw;
  }

  arm(): Promise<ArmDescription> {
    return this.ask("GET", "/arm");
  }

  async questions(answers: ArmAnswers): Promise<readonly Heading[]> {
    return (await this.ask<{ headings: readonly Heading[] }>("POST", "/questions", { answers })).headings;
  }

  private async ask<Answer>(method: Method, path: string, body?: object): Promise<Answer> {
    const text = await (await this.request(method, path, body)).text();
    return (text ? JSON.parse(text) : {}) as Answer;
  }

  /** The server's answer; one that refuses is an error with its sentence. */
  private async request(method: Method, path: string, body?: object | Blob): Promise<Response> {
    const answer = await fetch(path, {
      method,
      headers: {
        "X-Greywhale-Token": this.token, "X-Greywhale-Page": this.page(),
        "Content-Type": body instanceof Blob ? "application/octet-stream" : "application/json",
      },
      ...(body ? { body: body instanceof Blob ? body : JSON.stringify(body) } : {}),
    });
    if (answer.ok) return answer;
    throw new Error(sentenceIn(await answer.text()) ?? `The server answers ${answer.status} to ${path}; reload the page.`);
  }
}

function fileAddress(name: string): string {
  return `/file?name=${encodeURIComponent(name)}`;
}

/** What was identified comes first, then the dashboard's own arm and what else the folder has. */
function modelsIn({ files, arm, identified }: HostState): Model[] {
  const of = (wanted: string): readonly string[] => files.filter(({ kind, name }) => kind === wanted && name !== arm).map(({ name }) => name);
  return [
    ...[...of("model"), ...(identified ? [arm] : [])].map((name) => ({ name, identified: true, says: `${name} is the arm as greywhale identify has found it.` })),
    ...[...(identified ? [] : [arm]), ...of("arm")].map((name) => ({ name, identified: false, says: `The arm ${name} as it is described; greywhale identify makes a model.toml of the arm itself.` })),
  ];
}

function sentenceIn(text: string): string | null {
  try {
    const { error } = JSON.parse(text) as { error?: string };
    return error ?? null;
  } catch {
    return text.length < 300 && text ? text : null;
  }
}
