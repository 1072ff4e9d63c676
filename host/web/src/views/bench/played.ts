// A recording of a person's own, such as a log that this page has saved: the leader goes through it as the hand did.

import { button, el, fileField, setText } from "../../parts/dom";
import { poseIn, readRecording, type Recording } from "../../files/recording";
import { sentenceOf } from "../../parts/sentence";
import type { Session } from "../../session/session";
import type { LeaderControl } from "./leader_control";
import type { Limits } from "./limits";
import { seldom } from "./seldom";

export class Played {
  readonly element: HTMLElement;
  private readonly play = button("Play the recording", () => this.toggle(), { disabled: true });
  private recording: Recording | null = null;
  private begunMs: number | null = null;

  constructor(private readonly session: Session, private readonly leaderControl: LeaderControl, private readonly limits: Limits) {
    this.element = seldom("Play a recording", el("div", { class: "row" }, fileField("A recording (CSV)", ".csv", (file) => {
      this.recording = null;
      this.stop();
      void file?.then(async (given) => {
        this.recording = await readRecording(given, () => new Promise((resolve) => setTimeout(resolve)));
        this.show();
      }).catch((error: unknown) => session.tell(sentenceOf(error)));
    }), this.play));
  }

  /** Another motion leads now. */
  stop(): void {
    this.begunMs = null;
    this.show();
  }

  private toggle(): void {
    const { whyNotBench } = this.session;
    if (whyNotBench) return this.session.tell(whyNotBench);
    this.begunMs = this.begunMs === null ? performance.now() : null;
    this.show();
  }

  private show(): void {
    this.play.disabled = this.recording === null;
    setText(this.play, this.begunMs === null ? "Play the recording" : "Stop playing it");
  }

  /** Leads where the recording is now; to be called for each picture. */
  frame(): void {
    if (this.begunMs === null || !this.recording) return;
    const pose = poseIn(this.recording, (performance.now() - this.begunMs) / 1000);
    if (!pose) return this.stop();
    const { minimum, maximum } = this.limits;
    pose.forEach((angle, joint) => this.leaderControl.take(joint, Math.max(minimum[joint]!, Math.min(maximum[joint]!, angle))));
  }
}
