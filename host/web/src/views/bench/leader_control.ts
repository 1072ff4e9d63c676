// Leads the bench's leader arm as the person at this page wants: one for all views, and the newest wish wins.

import type { Bench } from "../../session/services";
import { JOINTS } from "../../session/samples";
import type { Session } from "../../session/session";

export class LeaderControl {
  /** The joint that was led last. */
  joint = 0;
  private readonly wanted: number[] = new Array<number>(JOINTS).fill(0);
  private held = false;
  private sending = false;
  private waiting = false;

  constructor(private readonly bench: Bench, private readonly session: Session) {}

  /** True once a person at this page leads; until then the leader moves by itself. */
  get leads(): boolean {
    return this.held;
  }

  /** The angles wanted while a person at this page leads, else those of the leader; rad. */
  get angles(): readonly number[] {
    return this.held ? this.wanted : this.session.samples.newest("leader");
  }

  /** Brings one joint to an angle in rad; who may not is told why. */
  take(joint: number, angle: number): void {
    const { whyNotBench } = this.session;
    if (whyNotBench) {
      this.session.tell(whyNotBench);
      return;
    }
    if (!this.held) this.wanted.splice(0, JOINTS, ...this.session.samples.newest("leader"));
    this.held = true;
    this.joint = joint;
    this.wanted[joint] = angle;
    this.waiting = true;
    void this.send();
  }

  /** Another motion leads now. */
  letGo(): void {
    this.held = false;
  }

  private async send(): Promise<void> {
    if (this.sending) return;
    this.sending = true;
    while (this.waiting) {
      this.waiting = false;
      await this.session.attempt(() => this.bench.change({ leader: this.wanted }));
    }
    this.sending = false;
  }
}
