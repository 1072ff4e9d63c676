// The few shapes that an arm is made of, each in one colour, and put together to one geometry.

import { BoxGeometry, BufferAttribute, Color, CylinderGeometry, ExtrudeGeometry, RingGeometry, Shape, type BufferGeometry } from "three";
import { mergeGeometries } from "three/examples/jsm/utils/BufferGeometryUtils.js";

const SIDES = 28; // of what is round
const BEVEL = 0.007;

export type Axis = "up" | "side" | "along"; // z, y, x

/** A cylinder about an axis from one place on it to another; its end may be thinner or thicker. */
export function tube(colour: string, axis: Axis, from: number, to: number, radius: number, end = radius): BufferGeometry {
  const made = new CylinderGeometry(end, radius, to - from, SIDES);
  made.translate(0, (from + to) / 2, 0); // it lies along y
  if (axis === "up") made.rotateX(Math.PI / 2);
  if (axis === "along") made.rotateZ(-Math.PI / 2);
  return painted(made, colour);
}

/** A bar with round ends from the origin along x, flat to the sides, as thick as that. */
export function bar(colour: string, length: number, radius: number, end: number, thick: number): BufferGeometry {
  const outline = new Shape();
  const tangent = Math.acos(Math.max(-1, Math.min(1, (radius - end) / Math.max(length, 1e-6))));
  outline.absarc(0, 0, radius, tangent, 2 * Math.PI - tangent, false);
  outline.absarc(length, 0, end, -tangent, tangent, false);
  const depth = Math.max(thick - 2 * BEVEL, BEVEL);
  const made = new ExtrudeGeometry(outline, {
    depth, curveSegments: SIDES / 2, bevelSize: BEVEL, bevelThickness: BEVEL, bevelOffset: -BEVEL, bevelSegments: 2,
  });
  made.translate(0, 0, -depth / 2);
  made.rotateX(Math.PI / 2);
  return painted(made, colour);
}

/** A box about this middle. */
export function box(colour: string, size: readonly [number, number, number], [x, y, z]: readonly [number, number, number]): BufferGeometry {
  return painted(new BoxGeometry(...size).translate(x, y, z), colour);
}

/** A flat piece of a ring about an axis, from one angle to another. */
export function arc(axis: Axis, from: number, to: number, inner: number, outer: number): BufferGeometry {
  return turned(new RingGeometry(inner, outer, 48, 1, from, to - from), axis);
}

/** Turns what lies about z so that it lies about an axis, with the angle's zero forward (to the side for a roll). */
export function turned<Geometry extends BufferGeometry>(geometry: Geometry, axis: Axis): Geometry {
  if (axis !== "up") geometry.rotateX(Math.PI / 2);
  if (axis === "along") geometry.rotateZ(Math.PI / 2);
  return geometry;
}

export function together(...parts: readonly BufferGeometry[]): BufferGeometry {
  return mergeGeometries([...parts]);
}

function painted(geometry: BufferGeometry, colour: string): BufferGeometry {
  const plain = geometry.index ? geometry.toNonIndexed() : geometry;
  plain.deleteAttribute("uv");
  const { r, g, b } = new Color(colour);
  const count = plain.getAttribute("position").count;
  const colours = new Float32Array(3 * count);
  for (let at = 0; at < count; at++) {
    colours[3 * at] = r;
    colours[3 * at + 1] = g;
    colours[3 * at + 2] = b;
  }
  plain.setAttribute("color", new BufferAttribute(colours, 3));
  return plain;
}
