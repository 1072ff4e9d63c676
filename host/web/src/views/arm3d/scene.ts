// The arm in three dimensions: follower solid, leader a ghost, stops as arcs, voltage as rings, a fault in red.

import {
  DirectionalLight, HemisphereLight, Light, Mesh, MeshLambertMaterial, PerspectiveCamera, Raycaster, Scene, Vector2, Vector3, WebGLRenderer,
  type Object3D,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import type { LeaderControl } from "../bench/leader_control";
import type { ArmDescription } from "../../session/services";
import type { Colours } from "../../parts/theme";
import { Floor } from "./floor";
import { Gauges } from "./gauges";
import { contextOf, finished, pause } from "./graphics";
import { Ghost } from "./leader";
import { ArmModel, makeParts, type Parts } from "./model";
import { cameraPlace, extentOf, type Extent, type Point } from "./reach";

const DRAG_RAD = 0.008; // a pixel
const ACROSS = new Set([0, 3]); // joints that turn by a drag to the side; the others by one up or down
export const FIELD = (30 * Math.PI) / 180;
const FIRST_PIXELS = 64; // a side, of the picture with which the graphics processor learns what to draw
const RATIOS = [0.5, 0.75, 1, 2]; // pixels a pixel of the page: more and more, as long as pictures are quick
const QUICK_MS = 25; // of a picture
const SLOW_MS = 60;
const ALIKE = 4; // pictures one after the other, until there are more pixels, or fewer for good

/** Where from the middle of all that the arm reaches one looks at it. */
export const PRESETS: Readonly<Record<"corner" | "front" | "side" | "top", Point>> = {
  corner: [0.25, -0.95, 0.36], front: [1, 0, 0.12], side: [0, -1, 0.1], top: [0, -0.012, 1],
};
export type Preset = keyof typeof PRESETS;

export type Pose = {
  readonly leader: readonly number[]; // rad
  readonly follower: readonly number[];
  readonly voltage: readonly number[]; // as a share of the supply
  readonly faulty: number | null; // the joint of a fault
};

export class ArmScene {
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera((FIELD * 180) / Math.PI, 1, 0.05, 40);
  private readonly controls: OrbitControls;
  private readonly follower: ArmModel;
  private readonly ghost: Ghost;
  private readonly floor: Floor;
  private readonly gauges: Gauges;
  private preset: Preset | null = "corner"; // null once a person has turned it
  private ratio = 0; // place in RATIOS
  private most = RATIOS.length - 1; // the place beyond which pictures were slow
  private quick = 0; // pictures one after the other
  private slow = 0;
  private size: readonly [width: number, height: number] = [FIRST_PIXELS, FIRST_PIXELS];
  private shades: Colours | null = null;
  private moved = true;
  private last = "";

  /**
   * Makes it in steps, between which the page does all else: while an arm follows, its page must not fall silent. Fails where
   * the browser has no WebGL.
   */
  static async on(canvas: HTMLCanvasElement, arm: ArmDescription): Promise<ArmScene> {
    const context = contextOf(canvas);
    if (!context) throw new Error("This browser cannot draw in three dimensions; turn WebGL on. Lines show the arm from its side until then, and all else works.");
    await pause();
    const renderer = new WebGLRenderer({ canvas, context });
    renderer.debug.checkShaderErrors = false; // to ask is to wait
    await pause();
    const extent = extentOf(arm);
    await pause();
    const parts = await makeParts(arm, extent.floor, pause);
    return new ArmScene(renderer, arm, extent, parts);
  }

  private constructor(
    private readonly renderer: WebGLRenderer, private readonly arm: ArmDescription, private readonly extent: Extent, parts: Parts,
  ) {
    const solid = new MeshLambertMaterial({ vertexColors: true });
    this.follower = new ArmModel(arm, parts, () => [solid]);
    this.gauges = new Gauges(this.follower, arm, parts.radii);
    this.ghost = new Ghost(arm, parts);
    this.floor = new Floor(arm, parts, this.extent.floor);
    const sun = new DirectionalLight(0xffffff, 2);
    sun.position.set(0.5, -0.9, 1.3);
    const sky = new HemisphereLight(0xffffff, 0x8c9aa4, 1.5);
    sky.position.set(0, 0, 1);
    this.scene.add(sky, sun, this.floor.group, new Mesh(parts.stand, solid), this.follower.root, this.ghost.model.root);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, renderer.domElement);
    this.controls.addEventListener("change", () => { this.moved = true; });
    this.controls.addEventListener("start", () => { this.preset = null; });
    this.look("corner");
  }

  /**
   * Lets the graphics processor compile and draw all once, which takes one made of software seconds. Who shows the canvas
   * before waits for it, and so does the page. This first picture is small.
   */
  async warm(): Promise<void> {
    const context = this.renderer.getContext() as WebGL2RenderingContext;
    this.renderer.setPixelRatio(1);
    this.renderer.setSize(FIRST_PIXELS, FIRST_PIXELS, false);
    this.ghost.show([1, 1, 1, 1], [0, 0, 0, 0]); // so that it is compiled as well
    await this.renderer.compileAsync(this.scene, this.camera);
    for (const program of this.renderer.info.programs ?? []) { // to ask what each has is to wait for it
      await finished(context);
      program.getUniforms();
      program.getAttributes();
    }
    const parts = this.scene.children.filter((part) => !(part instanceof Light));
    for (const part of parts) part.visible = false;
    for (const part of parts) {
      part.visible = true;
      this.renderer.render(this.scene, this.camera);
      await finished(context);
    }
    this.fit();
  }

  /** True if the browser has taken the graphics away. */
  get lost(): boolean {
    return this.renderer.getContext().isContextLost();
  }

  paint(shades: Colours, dark: boolean): void {
    this.shades = shades;
    this.ghost.paint(shades.accent);
    this.floor.paint(shades, dark);
    this.moved = true;
  }

  /** Looks from there, as far away as all is seen that the arm reaches. */
  look(preset: Preset): void {
    this.controls.target.set(...this.extent.middle);
    this.camera.position.set(...cameraPlace(this.extent, PRESETS[preset], FIELD, this.camera.aspect));
    this.controls.update();
    this.preset = preset;
    this.moved = true;
  }

  resize(width: number, height: number): void {
    this.size = [width, height];
    this.fit();
  }

  private fit(): void {
    const [width, height] = this.size;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, RATIOS[this.ratio]!));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (this.preset) this.look(this.preset);
    this.renderer.render(this.scene, this.camera); // a canvas of another size is empty
  }

  /** Hears how long a picture took; by that the next ones have more pixels or fewer. */
  took(ms: number): void {
    this.quick = ms < QUICK_MS ? this.quick + 1 : 0;
    this.slow = ms > SLOW_MS ? this.slow + 1 : 0;
    const up = this.quick === ALIKE && this.ratio < this.most && RATIOS[this.ratio]! < devicePixelRatio;
    const down = this.slow === ALIKE && this.ratio > 0;
    if (this.quick === ALIKE) this.quick = 0;
    if (this.slow === ALIKE) this.slow = 0;
    if (!up && !down) return;
    this.ratio += up ? 1 : -1;
    if (down) this.most = this.ratio;
    this.fit();
  }

  /** Lets a person drag the links of both arms; where none is hit, the view turns. */
  leadBy(leaderControl: LeaderControl | null): void {
    if (!leaderControl) return;
    const canvas = this.renderer.domElement;
    let joint: number | null = null;
    let [x, y] = [0, 0];
    canvas.addEventListener("pointerdown", (event) => {
      joint = this.jointAt(event);
      this.controls.enabled = joint === null;
      [x, y] = [event.clientX, event.clientY];
      if (joint !== null) canvas.setPointerCapture(event.pointerId);
    }, { capture: true });
    canvas.addEventListener("pointermove", (event) => {
      if (joint === null) return;
      const { min, max } = this.arm.joints[joint]!;
      const moved = ACROSS.has(joint) ? event.clientX - x : y - event.clientY;
      [x, y] = [event.clientX, event.clientY];
      leaderControl.take(joint, Math.max(min, Math.min(max, leaderControl.angles[joint]! + DRAG_RAD * moved)));
    });
    for (const end of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(end, () => {
        joint = null;
        this.controls.enabled = true;
      });
    }
  }

  /** The joint that moves the link under the pointer. */
  private jointAt(event: PointerEvent): number | null {
    const { left, top, width, height } = this.renderer.domElement.getBoundingClientRect();
    const at = new Vector2(((event.clientX - left) / width) * 2 - 1, 1 - ((event.clientY - top) / height) * 2);
    const ray = new Raycaster();
    ray.setFromCamera(at, this.camera);
    const links = [this.follower, this.ghost.model].flatMap((model) => model.links.map(([link]) => link!));
    const [hit] = ray.intersectObjects(links.filter(({ visible }) => visible), false);
    const frames = [this.follower.frames, this.ghost.model.frames];
    for (let part: Object3D | null = hit?.object ?? null; part; part = part.parent) {
      const joint = this.arm.joints.findIndex((_, place) => frames.some((one) => one[place] === part));
      if (joint >= 0 && !this.arm.joints[joint]!.fixed) return joint;
    }
    return null;
  }

  /** Where a joint of the follower is in the picture, as shares from its left and its top. */
  placeOf(joint: number): readonly [x: number, y: number] {
    const { x, y } = this.follower.frames[joint]!.getWorldPosition(new Vector3()).project(this.camera);
    return [(x + 1) / 2, (1 - y) / 2];
  }

  /** Draws a pose, unless it looks as the last one did; whether it did. */
  draw(pose: Pose): boolean {
    const key = [...pose.leader, ...pose.follower, ...pose.voltage].map((value) => value.toFixed(3)).join() + pose.faulty;
    if (!this.shades || (!this.moved && key === this.last)) return false;
    this.last = key;
    this.moved = false;
    this.follower.pose(pose.follower);
    this.floor.pose(pose.follower);
    this.ghost.show(pose.leader, pose.follower);
    this.gauges.show(this.shades, pose.follower, pose.voltage, pose.faulty);
    this.renderer.render(this.scene, this.camera);
    return true;
  }
}
