// The host behind the dashboard's server, over HTTP: every request carries the token, every error is a sentence.

import type { ArmDescription, Bench, Host, HostState, Job, Jobs, Prediction, Verb } from "../host";

const AGAIN_MS = 1000; // until a server that went is tried again

export class ServerHost implements Host {
  readonly bench: Bench = {
    controls: () => this.ask("GET", "/bench"),
    change: (wish) => this.ask<unknown>("POST", "/bench", wish).then(() => undefined),
  };

  readonly jobs: Jobs = {
    verbs: async () => (await this.ask<{ verbs: Verb[] }>("GET", "/jobs")).verbs,
    start: (verb, given) => this.ask<unknown>("POST", "/jobs", { verb, arguments: given }).then(() => undefined),
    stop: (id) => this.ask<unknown>("DELETE", `/jobs/${encodeURIComponent(id)}`).then(() => undefined),
    answer: (id, line) => this.ask<unknown>("POST", `/jobs/${encodeURIComponent(id)}`, { line }).then(() => undefined),
    listen: (heard) => this.hear(heard),
  };

  constructor(private readonly token: string, private readonly page: () => string) {}

  private hear(heard: (job: Job) => void): void {
    const socket = new WebSocket(`ws://${location.host}/host`, ["greywhale", `token.${this.token}`]);
    socket.addEventListener("message", ({ data }: MessageEvent<string>) => heard(JSON.parse(data) as Job));
    socket.addEventListener("close", () => setTimeout(() => this.hear(heard), AGAIN_MS));
  }

  state(): Promise<HostState> {
    return this.ask("GET", "/state");
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

  private async ask<Answer>(method: "GET" | "POST" | "DELETE", path: string, body?: object): Promise<Answer> {
    const answer = await fetch(path, {
      method,
      headers: { "X-Greywhale-Token": this.token, "X-Greywhale-Page": this.page(), "Content-Type": "application/json" },
      ...(body ? { body: JSON.stringify(body) } : {}),
    });
    const told = await answer.text();
    if (answer.ok) return (told ? JSON.parse(told) : {}) as Answer;
    throw new Error(sentenceIn(told) ?? `The server answers ${answer.status} to ${path}; reload the page.`);
  }
}

function sentenceIn(told: string): string | null {
  try {
    const { error } = JSON.parse(told) as { error?: string };
    return error ?? null;
  } catch {
    return told.length < 300 && told ? told : null;
  }
}
