// The floor below an arm: a soft disc, a grid that fades out, and the arm's shadow, straight below it.

import {
  BufferAttribute, BufferGeometry, CircleGeometry, Color, Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, NotEqualStencilFunc, ReplaceStencilOp,
} from "three";
import type { ArmDescription } from "../../session/services";
import type { Colours } from "../../parts/theme";
import { ArmModel, type Parts } from "./model";

const RADIUS = 1.15;
const APART = 0.115; // of the grid's lines
const PIECES = 16; // of a line, each of one strength
const FLAT = 1e-4;

export class Floor {
  readonly group = new Group();
  private readonly lines = new LineSegments(grid(), new LineBasicMaterial({ vertexColors: true, transparent: true, depthWrite: false }));
  private readonly disc = new Mesh(disc(), new MeshBasicMaterial({ vertexColors: true, transparent: true, depthWrite: false }));
  // Each pixel of the shadow once, however many parts are above it.
  private readonly dark = new MeshBasicMaterial({
    transparent: true, depthWrite: false, stencilWrite: true, stencilRef: 1, stencilFunc: NotEqualStencilFunc, stencilZPass: ReplaceStencilOp,
  });
  private readonly shadow: ArmModel;

  constructor(arm: ArmDescription, parts: Parts, height: number) {
    this.shadow = new ArmModel(arm, parts, () => [this.dark]);
    this.shadow.root.scale.z = FLAT;
    this.shadow.root.position.z = 0.004;
    this.lines.position.z = 0.002;
    this.group.position.z = height;
    this.group.add(this.disc, this.lines, this.shadow.root);
    this.disc.renderOrder = -3;
    this.lines.renderOrder = -2;
    for (const [mesh] of this.shadow.links) mesh!.renderOrder = -1;
  }

  pose(angles: readonly number[]): void {
    this.shadow.pose(angles);
  }

  paint(shades: Colours, dark: boolean): void {
    this.lines.material.color.set(shades.quiet);
    this.lines.material.opacity = dark ? 0.5 : 0.4;
    this.disc.material.color.set(dark ? "#5f7f92" : "#8fa6b3");
    this.disc.material.opacity = dark ? 0.2 : 0.3;
    this.dark.color.set(new Color(dark ? "#000000" : "#1b2a36"));
    this.dark.opacity = dark ? 0.4 : 0.2;
  }
}

/** White with a strength: 1 in the middle, 0 at the rim. */
function faded(geometry: BufferGeometry): BufferGeometry {
  const place = geometry.getAttribute("position");
  const colours = new Float32Array(place.count * 4).fill(1);
  for (let at = 0; at < place.count; at++) {
    colours[4 * at + 3] = Math.max(0, 1 - Math.hypot(place.getX(at), place.getY(at)) / RADIUS);
  }
  geometry.setAttribute("color", new BufferAttribute(colours, 4));
  return geometry;
}

function disc(): BufferGeometry {
  return faded(new CircleGeometry(RADIUS, 48));
}

function grid(): BufferGeometry {
  const points: number[] = [];
  for (let line = Math.ceil(-RADIUS / APART); line * APART < RADIUS; line++) {
    const across = line * APART;
    const half = Math.sqrt(RADIUS * RADIUS - across * across);
    for (let piece = 0; piece < PIECES; piece++) {
      const [from, to] = [piece, piece + 1].map((end) => half * ((2 * end) / PIECES - 1)) as [number, number];
      points.push(across, from, 0, across, to, 0, from, across, 0, to, across, 0);
    }
  }
  return faded(new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(points), 3)));
}
