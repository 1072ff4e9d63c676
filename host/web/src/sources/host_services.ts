// The host behind the dashboard's server, over HTTP: every request carries the token, every error is a sentence.

import type { ArmDescription, Bench, Services, HostState, Job, Jobs, Prediction, Verb } from "../session/services";

type Method = "GET" | "POST" | "DELETE";

const AGAIN_MS = 1000; // until a server that went is tried again

export class HostServices implements Services {
  readonly bench: Bench = {
    controls: () => this.ask("GET", "/bench"),
    change: (wish) => this.ask<unknown>("POST", "/bench", wish).then(() => undefined),
  };

  readonly jobs: Jobs = {
    verbs: async () => (await this.ask<{ verbs: Verb[] }>("GET", "/jobs")).verbs,
    start: async (verb, given) => (await this.ask<Job>("POST", "/jobs", { verb, arguments: given })).id,
    stop: (id) => this.ask<unknown>("DELETE", `/jobs/${encodeURIComponent(id)}`).then(() => undefined),
    answer: (id, line) => this.ask<unknown>("POST", `/jobs/${encodeURIComponent(id)}`, { line }).then(() => undefined),
    listen: (heard) => {
      this.listeners.push(heard);
      if (this.listeners.length === 1) this.hear();
    },
  };
  private readonly listeners: ((job: Job) => void)[] = [];

  constructor(private readonly token: string, private readonly page: () => string) {}

  private hear(): void {
    const socket = new WebSocket(`ws://${location.host}/host`, ["greywhale", `token.${this.token}`]);
    socket.addEventListener("message", ({ data }: MessageEvent<string>) => {
      const job = JSON.parse(data) as Job;
      for (const heard of this.listeners) heard(job);
    });
    socket.addEventListener("close", () => setTimeout(() => this.hear(), AGAIN_MS));
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

  predict(raw: readonly number[], board: number): Promise<Prediction> {
    return this.ask("POST", "/predict", { raw, board });
  }

  arm(): Promise<ArmDescription> {
    return this.ask("GET", "/arm");
  }

  private async ask<Answer>(method: Method, path: string, body?: object): Promise<Answer> {
    const text = await (await this.request(method, path, body)).text();
    return (text ? JSON.parse(text) : {}) as Answer;
  }

  /** The server's answer; one that refuses is an error with its sentence. */
  private async request(method: Method, path: string, body?: object): Promise<Response> {
    const answer = await fetch(path, {
      method,
      headers: { "X-Greywhale-Token": this.token, "X-Greywhale-Page": this.page(), "Content-Type": "application/json" },
      ...(body ? { body: JSON.stringify(body) } : {}),
    });
    if (answer.ok) return answer;
    throw new Error(sentenceIn(await answer.text()) ?? `The server answers ${answer.status} to ${path}; reload the page.`);
  }
}

function sentenceIn(text: string): string | null {
  try {
    const { error } = JSON.parse(text) as { error?: string };
    return error ?? null;
  } catch {
    return text.length < 300 && text ? text : null;
  }
}
