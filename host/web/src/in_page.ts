// The page without a host: firmware, arm and a moving hand inside it. The arm follows as soon as the page is open.
// Its parts come as files beside it (site.ts) or within it (single.ts).

import "./page.css";
import { ArmView } from "./arm3d/view";
import { LeaderHand } from "./bench/hand";
import { BenchView } from "./bench/view";
import { ControllerView } from "./controller/view";
import { LiveView } from "./live/view";
import { State } from "./link/schema";
import { el } from "./parts/dom";
import { startTheme } from "./parts/theme";
import { Session } from "./session";
import { Shell } from "./shell";
import { PageBoard } from "./sources/in_page/board";
import type { BenchData } from "./sources/in_page/bench_data";
import { PageTuner, type TunerParts } from "./sources/in_page/tuner";

export type Parts = {
  readonly code: ArrayBuffer; readonly data: BenchData; readonly worker: Worker;
  readonly tuner: () => Promise<TunerParts>; // a new worker each time
};

/** Shows the page, or why its parts are not there. */
export function openPage(parts: Promise<Parts>): void {
  startTheme();
  parts.then(show).catch((error: unknown) => {
    document.body.append(el("main", {}, el("p", {}, `${error instanceof Error ? error.message : String(error)}; load it again.`)));
  });
}

function show({ code, data, worker, tuner }: Parts): void {
  const board = new PageBoard(worker, code, data, () => localStorage);
  const session = new Session(board);
  const hand = new LeaderHand(board, session.samples, (error) =>
    session.tell(error instanceof Error ? error.message : String(error)));
  const arm = new ArmView(session, { arm: async () => data.description });
  arm.leadBy(hand);
  const shell = new Shell(session, [arm], [
    "The firmware of a real board and a simulated arm run inside this page; they need a browser with WebAssembly.",
  ]);
  for (const view of [new LiveView(session), new ControllerView(session, null, new PageTuner(tuner)), new BenchView(session, board, hand, null)]) {
    shell.add(view);
  }
  enableOnce(session);
}

/** Nobody stands near a simulated arm, so it need not wait for a person; but one who has pressed Stop meant it. */
function enableOnce(session: Session): void {
  let begun = false;
  session.changed.on(() => {
    if (begun || session.status?.state !== State.is.disabled) return;
    begun = true;
    if (session.stopAsked) return;
    void session.attempt(() => session.enable());
  });
}
