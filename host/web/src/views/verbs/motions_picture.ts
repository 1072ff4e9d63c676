// The leader and its followers in logs, a picture for each joint. A log is read when somebody comes to see it.

import { curvesPicture, type Curve } from "../../parts/curves";
import { el } from "../../parts/dom";
import { sentenceOf } from "../../parts/sentence";
import { JOINTS, JOINT_NAMES, samplesIn, TICKS_A_SECOND, type Quantity, type Samples } from "../../session/samples";
import type { Motions } from "../../session/host_types";

/** The samples of a log, as `Services.log` gives them. */
export type ReadLog = (file: string) => Promise<Uint8Array>;

const POINTS = 300; // of a curve: what is closer together shows no more in a small picture
const WIDTH = 300; // so that its letters stay as large as the page's
const LEAST_RAD = 0.1; // of a picture's height: an arm at rest looks at rest
const LEADER = "leader";
const FOLLOWERS = ["accent", "second"]; // shades

export function motionsPicture({ logs, title }: Motions, read: ReadLog): HTMLElement {
  const names = Object.keys(logs);
  const figure = el("figure", { class: "motions" }, el("figcaption", { class: "quiet" }, ...key(names)));
  const watch = new IntersectionObserver((seen) => {
    if (!seen.some((one) => one.isIntersecting)) return;
    watch.disconnect();
    Promise.all(Object.values(logs).map(read)).then(
      (payloads) => figure.append(...jointPictures(payloads.map(samplesIn))),
      (error: unknown) => figure.replaceChildren(el("p", { class: "quiet" }, sentenceOf(error))));
  });
  watch.observe(figure);
  return title ? el("div", {}, el("h3", {}, title), figure) : figure;
}

/** The names beside samples of their lines; the second one is drawn last, over the first. */
function key(names: readonly string[]): (Node | string)[] {
  return [LEADER, ...names].flatMap((name, number) => [
    el("span", { class: `key key-${number ? FOLLOWERS[number - 1] : LEADER}` }), ` ${name}  `,
  ]);
}

function jointPictures(logs: readonly Samples[]): SVGSVGElement[] {
  return Array.from({ length: JOINTS }, (_, joint) => {
    const leader = curve(logs.at(-1)!, "leader", joint, LEADER);
    const followers = logs.map((log, number) => curve(log, "follower", joint, FOLLOWERS[number]!));
    const name = `joint ${joint}, ${JOINT_NAMES[joint]}`;
    return curvesPicture(`Leader and follower of ${name}`, "s", [leader, ...followers], {
      width: WIDTH, title: `${name}, rad`, least: LEAST_RAD,
    });
  });
}

function curve(log: Samples, quantity: Quantity, joint: number, shade: string): Curve {
  const step = Math.max(1, Math.ceil((log.end - log.first) / POINTS));
  const numbers = Array.from({ length: Math.ceil((log.end - log.first) / step) }, (_, point) => log.first + point * step);
  return {
    x: numbers.map((number) => (log.timeOf(number) - log.firstTime) / TICKS_A_SECOND),
    y: numbers.map((number) => log.value(number, quantity, joint)),
    shade,
  };
}
