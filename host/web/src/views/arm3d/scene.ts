// The arm in three dimensions from its URDF: follower solid, leader a ghost, stops as arcs, voltage as rings.

import {
  AmbientLight, BufferGeometry, Color, DirectionalLight, GridHelper, Group, Line, LineBasicMaterial, Mesh,
  MeshBasicMaterial, MeshStandardMaterial, PerspectiveCamera, Quaternion, Raycaster, Scene, TorusGeometry, Vector2,
  Vector3, WebGLRenderer,
  type Object3D,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import URDFLoader, { type URDFRobot } from "urdf-loader";
import type { LeaderControl } from "../bench/leader_control";
import type { ArmDescription } from "../../session/services";
import type { Colours } from "../../parts/theme";
import { finished, pause } from "./graphics";

const AT_STOP_RAD = 0.03;
const RING_RADIUS = 0.034;
const ARC_RADIUS = 0.05;
const ARC_POINTS = 48;
const DRAG_RAD = 0.008; // a pixel
const ACROSS = new Set([0, 3]); // joints that turn by a drag to the side; the others by one up or down
const FIELD_DEG = 42;
const WIDE = 1.3; // a narrower picture shows as much to the sides, and more above and below
const SOLID = "#a9b8c4"; // told apart from light and dark ground alike
const CENTRE = new Vector3(0.09, 0, 0.11);

export const PRESETS = { corner: [0.5, -0.5, 0.42], front: [0.8, 0, 0.16], side: [0.09, -0.7, 0.16], top: [0.09, -0.01, 0.85] } as const;
export type Preset = keyof typeof PRESETS;

export type Pose = {
  readonly leader: readonly number[]; // rad
  readonly follower: readonly number[];
  readonly voltage: readonly number[]; // as a share of the supply
};

export class ArmScene {
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(FIELD_DEG, 1, 0.01, 10);
  private readonly controls: OrbitControls;
  private readonly rings: Mesh<TorusGeometry, MeshBasicMaterial>[] = [];
  private readonly arcs: Line<BufferGeometry, LineBasicMaterial>[] = [];
  private readonly grid = new GridHelper(0.8, 16);
  private shades: Colours | null = null;
  private moved = true;
  private last = "";

  /**
   * Makes it in steps, between which the page does all else: while an arm follows, its page must not fall silent. Fails where
   * the browser has no WebGL.
   */
  static async on(canvas: HTMLCanvasElement, arm: ArmDescription): Promise<ArmScene> {
    const context = contextOf(canvas);
    if (!context) throw new Error("This browser cannot draw in three dimensions; turn WebGL on. All other views work without it.");
    await pause();
    const renderer = new WebGLRenderer({ canvas, context });
    renderer.debug.checkShaderErrors = false; // to ask is to wait
    await pause();
    const follower = robot(arm);
    await pause();
    const ghost = robot(arm);
    await pause();
    return new ArmScene(renderer, arm, follower, ghost);
  }

  private constructor(
    private readonly renderer: WebGLRenderer, private readonly arm: ArmDescription,
    private readonly follower: URDFRobot, private readonly ghost: URDFRobot,
  ) {
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, renderer.domElement);
    this.controls.target.copy(CENTRE);
    this.controls.addEventListener("change", () => { this.moved = true; });
    this.grid.rotation.x = Math.PI / 2;
    const sun = new DirectionalLight(0xffffff, 2.2);
    sun.position.set(0.6, -0.8, 1.4);
    this.scene.add(new AmbientLight(0xffffff, 1.1), sun, this.grid, this.follower, this.ghost);
    this.arm.joints.forEach(({ id, min, max }) => this.mark(id, min, max));
    this.look("corner");
  }

  /**
   * Lets the graphics processor compile and draw all once, which takes one made of software seconds. Who shows the canvas
   * before waits for it, and so does the page.
   */
  async warm(): Promise<void> {
    const context = this.renderer.getContext() as WebGL2RenderingContext;
    await this.renderer.compileAsync(this.scene, this.camera);
    await finished(context);
    this.renderer.render(this.scene, this.camera);
    await finished(context);
  }

  /** A ring about a joint for its voltage, and an arc in the link before for where its stops are. */
  private mark(id: string, min: number, max: number): void {
    const joint = this.follower.joints[id]!;
    const turn = new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), joint.axis);
    const ring = new Mesh(new TorusGeometry(RING_RADIUS, 0.004, 10, 40), new MeshBasicMaterial());
    ring.quaternion.copy(turn);
    joint.add(ring);
    this.rings.push(ring);
    const points = Array.from({ length: ARC_POINTS + 1 }, (_, i) => {
      const angle = min + ((max - min) * i) / ARC_POINTS;
      return new Vector3(ARC_RADIUS * Math.cos(angle), ARC_RADIUS * Math.sin(angle), 0);
    });
    const arc = new Line(new BufferGeometry().setFromPoints(points), new LineBasicMaterial());
    const still = new Group();
    still.position.copy(joint.position);
    still.quaternion.copy(joint.quaternion);
    arc.quaternion.copy(turn);
    still.add(arc);
    joint.parent?.add(still);
    this.arcs.push(arc);
  }

  /** True if the browser has taken the graphics away. */
  get lost(): boolean {
    return this.renderer.getContext().isContextLost();
  }

  paint(shades: Colours): void {
    this.shades = shades;
    const solid = new MeshStandardMaterial({ color: SOLID, roughness: 0.6, metalness: 0.1 });
    const pale = new MeshStandardMaterial({
      color: shades.accent, transparent: true, opacity: 0.26, depthWrite: false, roughness: 1,
      polygonOffset: true, polygonOffsetFactor: 4, polygonOffsetUnits: 4, // behind the follower where both are alike
    });
    paintLinks(this.follower, solid, this.rings);
    paintLinks(this.ghost, pale, []);
    for (const arc of this.arcs) arc.material.color.set(shades.line);
    const lines = this.grid.material as LineBasicMaterial;
    lines.vertexColors = false;
    lines.color.set(shades.line);
    lines.needsUpdate = true;
    this.moved = true;
  }

  look(preset: Preset): void {
    const [x, y, z] = PRESETS[preset];
    this.camera.position.set(x, y, z);
    this.controls.target.copy(CENTRE);
    this.controls.update();
    this.moved = true;
  }

  resize(width: number, height: number): void {
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    const stretch = Math.max(1, WIDE / this.camera.aspect);
    this.camera.fov = (360 / Math.PI) * Math.atan(stretch * Math.tan((FIELD_DEG * Math.PI) / 360));
    this.camera.updateProjectionMatrix();
    this.moved = true;
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
    canvas.addEventListener("pointerup", () => {
      joint = null;
      this.controls.enabled = true;
    });
  }

  /** The joint that moves the link under the pointer. */
  private jointAt(event: PointerEvent): number | null {
    const { left, top, width, height } = this.renderer.domElement.getBoundingClientRect();
    const at = new Vector2(((event.clientX - left) / width) * 2 - 1, 1 - ((event.clientY - top) / height) * 2);
    const ray = new Raycaster();
    ray.setFromCamera(at, this.camera);
    const [hit] = ray.intersectObjects([this.follower, this.ghost], true).filter(({ object }) => object instanceof Mesh);
    for (let part: Object3D | null = hit?.object ?? null; part; part = part.parent) {
      const joint = this.arm.joints.findIndex(({ id }) => part === this.follower.joints[id] || part === this.ghost.joints[id]);
      if (joint >= 0 && !this.arm.joints[joint]!.fixed) return joint;
    }
    return null;
  }

  /** Draws a pose, unless it looks as the last one did. */
  draw(pose: Pose): void {
    const key = [...pose.leader, ...pose.follower, ...pose.voltage].map((value) => value.toFixed(3)).join();
    if (!this.moved && key === this.last) return;
    this.last = key;
    this.moved = false;
    this.arm.joints.forEach(({ id, min, max, fixed }, joint) => {
      if (fixed) return;
      const angle = pose.follower[joint]!;
      this.follower.setJointValue(id, angle);
      this.ghost.setJointValue(id, pose.leader[joint]!);
      const atStop = angle < min + AT_STOP_RAD || angle > max - AT_STOP_RAD;
      this.showVoltage(joint, pose.voltage[joint]!, atStop);
    });
    this.renderer.render(this.scene, this.camera);
  }

  private showVoltage(joint: number, share: number, atStop: boolean): void {
    if (!this.shades) return;
    const { material, scale } = this.rings[joint]!;
    material.color.set(this.shades.line).lerp(new Color(this.shades.joints[joint]), Math.min(1, 0.25 + Math.abs(share)));
    scale.setScalar(1 + 0.35 * Math.min(1, Math.abs(share)));
    this.arcs[joint]!.material.color.set(atStop ? "#d12f3e" : this.shades.quiet);
  }
}

function paintLinks(robot: Object3D, material: MeshStandardMaterial, others: readonly Object3D[]): void {
  robot.traverse((part) => {
    if (part instanceof Mesh && !others.includes(part)) part.material = material;
  });
}

/** The renderer of a canvas, null where the browser lacks or forbids it. */
function contextOf(canvas: HTMLCanvasElement): WebGL2RenderingContext | null {
  try {
    return canvas.getContext("webgl2", { antialias: true, alpha: true });
  } catch {
    return null;
  }
}

function robot(arm: ArmDescription): URDFRobot {
  const loader = new URDFLoader();
  loader.parseCollision = false;
  const made = loader.parse(arm.urdf);
  for (const joint of Object.values(made.joints)) joint.ignoreLimits = true;
  return made;
}
