// The page's entry: gets the server's token, opens the board, and shows the views.

import "./page.css";
import { ArmView } from "./arm3d/view";
import { LeaderHand } from "./bench/hand";
import { BenchView } from "./bench/view";
import { ControllerView } from "./controller/view";
import { Countdown } from "./do/countdown";
import { DoView } from "./do/view";
import type { Host } from "./host";
import { LiveView } from "./live/view";
import { LogsView } from "./logs/view";
import { el } from "./parts/dom";
import { startTheme } from "./parts/theme";
import { Session } from "./session";
import { Shell } from "./shell";
import { findAccess, type Access } from "./sources/access";
import { ServerBoard } from "./sources/server";
import { ServerHost } from "./sources/server_host";

startTheme();
void findAccess().then(begin);

function begin({ token, sentence }: Access): void {
  const board = new ServerBoard(token, sentence);
  const session = new Session(board);
  const remedy = [
    "Plug the board in by USB: this page takes it by itself. Without a board, start ", el("code", {}, "greywhale dashboard --sim"),
    ": it brings a simulated arm with the real firmware.",
  ];
  const shell = new Shell(session, [new LiveView(session)], token ? remedy : []); // without a token no board would help
  if (token) addHost(shell, session, new ServerHost(token, () => board.page));
}

/** Adds what needs a host beside the board. */
function addHost(shell: Shell, session: Session, host: Host): void {
  document.body.append(new Countdown(session, host.jobs).element);
  const arm = new ArmView(session, host);
  for (const view of [arm, new ControllerView(session, host), new DoView(session, host), new LogsView(session, host)]) {
    shell.add(view);
  }
  void session.attempt(async () => {
    if (!(await host.state()).sim) return;
    const hand = new LeaderHand(host.bench, session);
    arm.leadBy(hand);
    shell.add(new BenchView(session, host.bench, hand, host));
  });
}
