// A board behind the dashboard's server: a WebSocket that carries the link's frames unchanged, and words beside them.

import type { Board, BoardListener } from "../session/board";

const HERE_EVERY_MS = 100; // the server's patience is 500 ms
const AGAIN_MS = 500; // until a server that went is tried again

type Told =
  | { kind: "link"; open: boolean; port: string; sentence: string; unflashed: boolean }
  | { kind: "driver"; you: boolean; free: boolean; verb: string | null }
  | { kind: "stored"; crc: number | null }
  | { kind: "refused"; sentence: string; seq?: number; type?: number }
  | { kind: "stopped"; sentence: string }
  | { kind: "page"; id: string };

export class ServerBoard implements Board {
  /** The server's name for this page, which the requests that start jobs carry. */
  page = "";
  private socket: WebSocket | null = null;
  private listener: BoardListener | null = null;
  private driving = false;
  private met = false;

  /** Without a token it says why, in a sentence. */
  constructor(private readonly token: string, private readonly sentence: string) {
    setInterval(() => {
      if (this.driving && document.visibilityState === "visible") this.say("here");
    }, HERE_EVERY_MS);
  }

  listen(listener: BoardListener): void {
    this.listener = listener;
    if (this.token) {
      this.open();
      return;
    }
    listener.link({ open: false, port: "", sentence: this.sentence });
  }

  private open(): void {
    const address = `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/board`;
    const socket = new WebSocket(address, ["greywhale", `token.${this.token}`]);
    socket.binaryType = "arraybuffer";
    socket.addEventListener("message", ({ data }: MessageEvent<ArrayBuffer | string>) => {
      if (typeof data === "string") this.told(JSON.parse(data) as Told);
      else this.listener?.bytes(new Uint8Array(data));
    });
    socket.addEventListener("close", () => void this.closed());
    this.socket = socket;
  }

  private async closed(): Promise<void> {
    this.socket = null;
    this.driving = false;
    this.listener?.driver({ you: false, free: false, verb: null });
    this.listener?.link({ open: false, port: "", sentence: await this.whyClosed() });
    setTimeout(() => this.open(), AGAIN_MS);
  }

  /** A socket does not say why it was refused; a request does. */
  private async whyClosed(): Promise<string> {
    try {
      const answer = await fetch("/state", { headers: { "X-Greywhale-Token": this.token } });
      if (!answer.ok) return await answer.text();
    } catch {
      // nobody answers
    }
    return "The dashboard's server does not answer; start `greywhale dashboard` again.";
  }

  private told(message: Told): void {
    switch (message.kind) {
      case "page":
        this.page = message.id;
        break;
      case "link":
        this.listener?.link({ open: message.open, port: message.port, sentence: message.sentence, unflashed: message.unflashed });
        break;
      case "driver":
        this.driving = message.you;
        this.listener?.driver({ you: message.you, free: message.free, verb: message.verb });
        if (!this.met && message.free) this.drive(); // the first page drives; later it is a person's wish
        this.met = true;
        break;
      case "stored":
        this.listener?.stored(message.crc);
        break;
      case "refused":
        this.listener?.refused(message.seq ?? 0, message.type ?? 0, message.sentence);
        break;
      case "stopped":
        this.listener?.stopped(message.sentence);
        break;
    }
  }

  send(frame: Uint8Array): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(frame as Uint8Array<ArrayBuffer>);
  }

  drive(): void {
    this.say("drive");
  }

  release(): void {
    this.say("release");
  }

  private say(kind: string): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify({ kind }));
  }

  async history(from: number | null): Promise<Uint8Array> {
    const answer = await fetch(from === null ? "/history" : `/history?from=${from}`, { headers: { "X-Greywhale-Token": this.token } });
    if (!answer.ok) throw new Error(`The server keeps no history (${answer.status}); reload the page.`);
    return new Uint8Array(await answer.arrayBuffer());
  }
}
