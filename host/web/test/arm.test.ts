// The arm in three dimensions: all of it is in the picture in every pose, nothing dips into the floor, and a leader where its
// follower is draws nothing.
import assert from "node:assert/strict";
import { test } from "node:test";
import { Box3, Mesh, PerspectiveCamera, Vector3, type Object3D } from "three";
import type { ArmDescription } from "../src/session/services";
import { Gauges } from "../src/views/arm3d/gauges";
import { Ghost } from "../src/views/arm3d/leader";
import { ArmModel, makeParts } from "../src/views/arm3d/model";
import { cameraPlace, extentOf } from "../src/views/arm3d/reach";
import { FIELD, PRESETS } from "../src/views/arm3d/scene";

const STOPS = { min: -2.55, max: 2.55, fixed: false };
const FIXED = { ...STOPS, fixed: true };

function arm(lengths: readonly number[], joints: ArmDescription["joints"] = [STOPS, STOPS, STOPS, STOPS]): ArmDescription {
  return { name: "an arm", lengths, joints };
}

const ARMS: readonly ArmDescription[] = [
  arm([0.086, 0.14, 0.049, 0.172]), // the default one
  arm([0.4, 0.02, 0.5, 0.01]),
  arm([0.01, 0.1, 0.01, 0.01], [FIXED, STOPS, FIXED, FIXED]), // a lever
  arm([0.1, 0.2, 0.2, 0.1], [STOPS, { min: 0.3, max: 1.2, fixed: false }, { min: -0.2, max: 0.2, fixed: false }, STOPS]),
];

/** Every pose with each joint at one of its stops, or in the middle. */
function extremes({ joints }: ArmDescription): number[][] {
  return joints.reduce<number[][]>((poses, { min, max }) => poses.flatMap((pose) => [min, (min + max) / 2, max].map((angle) => [...pose, angle])), [[]]);
}

/** The corners of the boxes about all that is drawn. */
function corners(root: Object3D): Vector3[] {
  root.updateMatrixWorld(true);
  const found: Vector3[] = [];
  root.traverse((part) => {
    if (!(part instanceof Mesh)) return;
    part.geometry.computeBoundingBox();
    const { min, max } = part.geometry.boundingBox as Box3;
    for (let corner = 0; corner < 8; corner++) {
      found.push(new Vector3(corner & 1 ? max.x : min.x, corner & 2 ? max.y : min.y, corner & 4 ? max.z : min.z).applyMatrix4(part.matrixWorld));
    }
  });
  return found;
}

const atOnce = async (): Promise<void> => undefined;

test("the whole arm is in the picture in every pose, from every side, however wide it is", async () => {
  for (const one of ARMS) {
    const extent = extentOf(one);
    const parts = await makeParts(one, extent.floor, atOnce);
    const model = new ArmModel(one, parts, () => []);
    parts.links.forEach((geometry, joint) => model.frames[joint]!.add(new Mesh(geometry)));
    for (const pose of extremes(one)) {
      model.pose(pose);
      const drawn = corners(model.root);
      assert.ok(drawn.every(({ z }) => z > extent.floor), `${one.lengths}: ${pose} is in the floor`);
      for (const [side, from] of Object.entries(PRESETS)) {
        for (const aspect of [0.6, 1, 2.2]) {
          const camera = new PerspectiveCamera((FIELD * 180) / Math.PI, aspect, 0.05, 40);
          camera.up.set(0, 0, 1);
          camera.position.set(...cameraPlace(extent, from, FIELD, aspect));
          camera.lookAt(...extent.middle);
          camera.updateMatrixWorld(true);
          for (const corner of drawn) {
            const { x, y } = corner.clone().project(camera);
            assert.ok(Math.max(Math.abs(x), Math.abs(y)) <= 1, `${one.lengths}: ${pose} from the ${side} at ${aspect}`);
          }
        }
      }
    }
  }
});

test("a leader where its follower is draws nothing, whatever noise is on both; one that is apart shows what is", async () => {
  const ghost = new Ghost(ARMS[0]!, await makeParts(ARMS[0]!, -1, atOnce));
  const shown = (): boolean[] => ghost.model.links.map((meshes) => meshes.every(({ visible }) => visible));
  for (const noise of [0, 0.004, -0.02]) {
    ghost.show([0.3, 0.7 + noise, -0.4, noise], [0.3, 0.7, -0.4, 0]);
    assert.deepEqual(shown(), [false, false, false, false]);
  }
  ghost.show([0, 0, 0.5, 0], [0, 0, 0, 0]);
  assert.deepEqual(shown(), [false, false, true, true]);
  ghost.show([0.5, 0, 0, 0], [0, 0, 0, 0]);
  assert.deepEqual(shown(), [true, true, true, true]);
});

test("a joint that is fixed has no ring and no arc", async () => {
  const parts = await makeParts(ARMS[2]!, -1, atOnce);
  const model = new ArmModel(ARMS[2]!, parts, () => []);
  new Gauges(model, ARMS[2]!, parts.radii);
  assert.deepEqual(model.frames.map(({ children }) => children.filter((part) => part instanceof Mesh).length), [1, 1, 0, 0]);
});
