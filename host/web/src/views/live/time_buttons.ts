// Zooms and moves a span of time, by buttons and by keys.

import { button } from "../../parts/dom";
import { ZOOM_STEP, type TimeWindow } from "./window";

const PAN_STEP = 0.2; // of the span

type Move = { readonly sign: string; readonly name: string; readonly key: string; readonly act: (window: TimeWindow) => void };

const MOVES: Readonly<Record<string, Move>> = {
  "-": { sign: "−", name: "Zoom out", key: "minus", act: (window) => window.zoom(ZOOM_STEP) },
  "+": { sign: "+", name: "Zoom in", key: "plus", act: (window) => window.zoom(1 / ZOOM_STEP) },
  ArrowLeft: { sign: "◀", name: "Earlier", key: "left arrow", act: (window) => window.pan(-PAN_STEP) },
  ArrowRight: { sign: "▶", name: "Later", key: "right arrow", act: (window) => window.pan(PAN_STEP) },
};

export function timeButtons(window: TimeWindow): HTMLElement[] {
  return Object.values(MOVES).map(({ sign, name, key, act }) =>
    button(sign, () => act(window), { title: `${name} (${key})`, attrs: { "aria-label": name } }));
}

/** Does what a key stands for; false where it stands for nothing. */
export function moveByKey(window: TimeWindow, key: string): boolean {
  MOVES[key]?.act(window);
  return key in MOVES;
}
