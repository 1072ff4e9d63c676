// The plot beside the moving arm: how the joint that is led follows, or the one at which a fault sits, in the last seconds.

import { faultPlace } from "../../link/refusal";
import { el, setText } from "../../parts/dom";
import { themeChanged } from "../../parts/theme";
import { JOINT_NAMES, TICKS_A_SECOND } from "../../session/samples";
import type { Session } from "../../session/session";
import { ANGLE_ALONE, Charts } from "../live/charts";
import { TimeWindow } from "../live/window";
import type { LeaderControl } from "./leader_control";

const SPAN_S = 6;

export class Following {
  readonly element: HTMLElement;
  private readonly title = el("h2");
  private readonly charts: Charts;
  private joint = -1;

  constructor(private readonly session: Session, private readonly leaderControl: LeaderControl) {
    const window = new TimeWindow(session.samples);
    window.setSpan(SPAN_S * TICKS_A_SECOND);
    this.charts = new Charts([{ samples: session.samples, shade: (shades, joint) => shades.joints[joint]! }], window, ANGLE_ALONE);
    this.element = el("section", { class: "card following" }, this.title, this.charts.element);
    themeChanged.on(() => this.charts.rebuild());
  }

  enter(): void {
    this.charts.rebuild();
  }

  frame(): void {
    const { faulty, status } = this.session;
    const fault = faulty && status ? faultPlace(status) : null;
    const joint = fault?.joint ?? this.leaderControl.joint;
    if (joint !== this.joint) {
      this.joint = joint;
      this.charts.showOnly(joint);
      setText(this.title, `Joint ${joint}, ${JOINT_NAMES[joint]}: leader dashed, follower solid`);
    }
    this.charts.draw();
  }
}
