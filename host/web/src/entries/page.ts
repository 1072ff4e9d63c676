// The page's entry: gets the server's token, opens the board, and shows the views.

import "../page.css";
import { ArmPicture } from "../views/arm3d/picture";
import { ArmView } from "../views/arm3d/view";
import { LeaderControl } from "../views/bench/leader_control";
import { BenchView } from "../views/bench/view";
import { CalibrateView } from "../views/calibrate/view";
import { ControllerView } from "../views/controller/view";
import { ParametersView } from "../views/parameters/view";
import { Countdown } from "../views/verbs/countdown";
import { FilesView } from "../views/files/view";
import { DoView } from "../views/verbs/view";
import type { Services } from "../session/services";
import { LiveView } from "../views/live/view";
import { inFolder } from "../views/live/keep";
import { el } from "../parts/dom";
import { startTheme } from "../parts/theme";
import { Session } from "../session/session";
import { Shell } from "../views/shell";
import { findAccess, type Access } from "../sources/access";
import { ServerBoard } from "../sources/server";
import { HostServices } from "../sources/host_services";

startTheme();
void findAccess().then(begin);

function begin({ token, sentence }: Access): void {
  const board = new ServerBoard(token, sentence);
  const session = new Session(board);
  const remedy = [
    "Plug the board in by USB: this page takes it by itself. Without a board, start ", el("code", {}, "greywhale dashboard --sim"),
    ": it brings a simulated arm with the real firmware.",
  ];
  const services = new HostServices(token, () => board.page);
  const live = new LiveView(session, token ? inFolder(services) : undefined);
  const shell = new Shell(session, [live], token ? remedy : []); // without a token no board would help
  if (token) addServices(shell, session, services);
}

/** Adds what needs a host beside the board. */
function addServices(shell: Shell, session: Session, services: Services): void {
  const countdown = new Countdown(session, services.jobs);
  document.body.append(countdown.element);
  const arm = new ArmPicture(session, services);
  const verbs = new DoView(session, services);
  const files = new FilesView(session, services, (verb, given) => {
    shell.show(verbs);
    void verbs.open(verb, given);
  });
  for (const view of [new ArmView(arm), new ControllerView(session, services.predictor, services.tuner, services), verbs, files]) {
    shell.add(view);
  }
  void session.attempt(async () => {
    const { sim } = await services.state();
    shell.add(new CalibrateView(session, calibration, countdown, sim ? services.bench : null));
    shell.add(new ParametersView(session));
    if (!sim) return;
    const leaderControl = new LeaderControl(services.bench, session);
    arm.leadBy(leaderControl);
    shell.add(new BenchView(session, services.bench, leaderControl, arm, services));
  });
}

/** The rules of a calibration, a file beside the page. */
async function calibration(): Promise<ArrayBuffer> {
  const answer = await fetch(new URL("calibration.wasm", import.meta.url));
  if (!answer.ok) throw new Error(`calibration.wasm is missing beside this page (${answer.status})`);
  return answer.arrayBuffer();
}
