// The views of every page, whatever its board comes from: a source that is not there leaves its own view out, and no other.

import { ArmPicture } from "../views/arm3d/picture";
import { LeaderControl } from "../views/bench/leader_control";
import { BenchView } from "../views/bench/view";
import { CalibrateView } from "../views/calibrate/view";
import { FirmwareCard } from "../views/connect/firmware_card";
import { ConnectView } from "../views/connect/view";
import { ControllerView } from "../views/controller/view";
import { FilesView } from "../views/files/view";
import { inFolder } from "../views/live/keep";
import { TorquePanel } from "../views/live/torque_panel";
import { LiveView } from "../views/live/view";
import { ParametersView } from "../views/parameters/view";
import { PotBars } from "../views/pots/bars";
import { Shell } from "../views/shell";
import type { Paths } from "../views/start/steps";
import { TryCards } from "../views/start/try_cards";
import { StartView } from "../views/start/view";
import { Way } from "../views/start/way";
import { Countdown } from "../views/verbs/countdown";
import { DoView } from "../views/verbs/view";
import type { View } from "../views/view";
import { browserStore, tabStore } from "../parts/storage";
import type { BoardPort } from "../session/port";
import type { Bench, Predictor, Services, Tuner } from "../session/services";
import type { Session } from "../session/session";
import { BrowserCalibrations } from "../sources/browser_calibrations";

const SHOWN = "greywhale-view"; // the key of the view that this tab shows
const BENCH_FIRMWARE = "The board runs the very image that a real Mega gets. Write it anew through its bootloader, or one of your own.";

/** Those that this browser keeps, of boards at a port or of the simulated one. */
function ownCalibrations(atPort: boolean): BrowserCalibrations {
  return new BrowserCalibrations(browserStore, atPort ? "greywhale-calibrations" : "greywhale-calibrations-bench");
}

/** The sources of a page; null is one that it has not. */
export type Sources = {
  readonly session: Session;
  readonly arm: Pick<Services, "arm">;
  /** The host's verbs and files. */
  readonly services: Services | null;
  readonly bench: Bench | null;
  /** A bench whose board this page flashes by itself. */
  readonly flashed: Pick<BoardPort, "flash"> | null;
  /** A board that a person connects by hand. */
  readonly port: BoardPort | null;
  readonly predictor: Predictor;
  readonly tuner: Tuner;
  readonly calibration: () => Promise<ArrayBuffer>;
  /** The folder of the documentation. */
  readonly docs: string | null;
  /** A sentence or two on what to do where no board is there. */
  readonly remedy: string;
};

/** All views of a page; `show` brings one of them to the front, once there is a frame around them. */
export class Views {
  readonly all: readonly View[];
  readonly controller: ControllerView;
  private shell: Shell | null = null;

  private readonly verbs: DoView | null;
  private readonly countdown: Countdown;

  constructor(private readonly sources: Sources) {
    const { session, services, bench, port, predictor, tuner, calibration } = sources;
    this.countdown = new Countdown(session, services?.jobs);
    this.controller = new ControllerView(session, predictor, tuner, services);
    this.verbs = services && new DoView(session, services, (verb, given) => this.openVerb(verb, given));
    const arm = new ArmPicture(session, sources.arm);
    const leaderControl = bench && new LeaderControl(bench, session);
    if (leaderControl) arm.leadBy(leaderControl);
    const calibrations = services?.calibrations ?? ownCalibrations(port !== null);
    const beside = [new PotBars(session), ...this.tryCards(leaderControl)];
    this.all = [
      new StartView(arm, beside, new Way(session, services, this.paths(), sources.docs)),
      ...(port ? [new ConnectView(session, port)] : []),
      new LiveView(session, services ? inFolder(services) : undefined, services && new TorquePanel(session, services)), this.controller, new ParametersView(session, calibrations),
      new CalibrateView(session, calibration, this.countdown, calibrations, bench),
      ...(this.verbs ? [this.verbs] : []),
      ...(services ? [new FilesView(session, services, (verb, given) => this.openVerb(verb, given))] : []),
      ...(bench && leaderControl ? [new BenchView(session, bench, leaderControl, arm, services, this.benchFirmware())] : []),
    ];
  }

  /** Puts the frame around the views: the view `front` first, else the one that this tab showed last. */
  open(front: string | null): Shell {
    const { session } = this.sources;
    document.body.append(this.countdown.element);
    const wanted = front ?? tabStore.read(SHOWN);
    this.shell = new Shell(session, this.all, this.sources.remedy, this.named(wanted), (view) => tabStore.write(SHOWN, view.name));
    return this.shell;
  }

  private named(name: string | null): View {
    return this.all.find((view) => view.name.toLowerCase() === name?.toLowerCase()) ?? this.all[0]!;
  }

  private show(name: string): void {
    this.shell?.show(this.named(name));
    document.getElementById("view")!.focus(); // the button is gone
  }

  /** Opens the form of a verb; a calibration has a view of its own. */
  private openVerb(verb: string, given: Readonly<Record<string, unknown>>): void {
    if (verb === "calibrate") this.show("Calibrate");
    if (!this.verbs || verb === "calibrate") return;
    this.show(this.verbs.name);
    void this.verbs.open(verb, given);
  }

  private paths(): Paths {
    const { services, port, bench, flashed } = this.sources;
    return {
      show: (view) => this.show(view),
      open: services && ((verb, given) => this.openVerb(verb, given)),
      connectIn: port ? "Port" : "", flashIn: port ? "Port" : flashed ? "Bench" : "", practice: bench !== null,
      remedy: this.sources.remedy,
    };
  }

  private tryCards(leaderControl: LeaderControl | null): readonly TryCards[] {
    const { session, bench, docs } = this.sources;
    if (!bench || !leaderControl) return [];
    return [new TryCards(session, bench, leaderControl, docs, () => {
      this.show(this.controller.name);
      return this.controller.letTune();
    })];
  }

  private benchFirmware(): FirmwareCard | null {
    const { session, flashed } = this.sources;
    return flashed && new FirmwareCard(session, flashed, BENCH_FIRMWARE, (act) => void session.attempt(act));
  }
}
