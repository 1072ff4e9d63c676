// The leader as a ghost about the follower. Only what is apart from the follower is drawn: two bodies in one place would flicker.

import { MeshBasicMaterial, MeshLambertMaterial } from "three";
import type { ArmDescription } from "../../session/services";
import { ArmModel, type Parts } from "./model";

const HIDDEN_RAD = 0.03; // apart by less, which the noise of potentiometers is
const WHOLE_RAD = 0.15; // apart by more
const STRONGEST = 0.42;

export class Ghost {
  readonly model: ArmModel;
  private readonly pale: readonly MeshLambertMaterial[];

  constructor(arm: ArmDescription, parts: Parts) {
    // First its depth alone, so that none of its own parts shines through another.
    const depth = new MeshBasicMaterial({ colorWrite: false, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 2 });
    this.pale = parts.links.map(() => new MeshLambertMaterial({
      transparent: true, depthWrite: false, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    }));
    this.model = new ArmModel(arm, parts, (joint) => [depth, this.pale[joint]!]);
    for (const link of this.model.links) link.forEach((mesh, pass) => { mesh.renderOrder = 1 + pass; }); // behind all that is solid
  }

  paint(colour: string): void {
    for (const material of this.pale) material.color.set(colour);
  }

  /** Takes the leader's pose, and shows the links that are apart from the follower's. */
  show(leader: readonly number[], follower: readonly number[]): void {
    this.model.pose(leader);
    let apart = 0; // of this link or one that carries it, rad
    this.model.links.forEach((meshes, joint) => {
      apart = Math.max(apart, Math.abs(leader[joint]! - follower[joint]!));
      const share = Math.max(0, Math.min(1, (apart - HIDDEN_RAD) / (WHOLE_RAD - HIDDEN_RAD)));
      this.pale[joint]!.opacity = STRONGEST * share;
      for (const mesh of meshes) mesh.visible = share > 0;
    });
  }
}
