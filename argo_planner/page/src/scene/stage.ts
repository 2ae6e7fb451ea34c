/** The renderer. It draws only after changes, and on slow machines with fewer pixels during motion. */

import {
  BasicShadowMap,
  Color,
  DirectionalLight,
  HemisphereLight,
  type Material,
  Mesh,
  type Object3D,
  PCFShadowMap,
  PerspectiveCamera,
  Points,
  Scene,
  Vector3,
  WebGLRenderer,
} from "three";

import type { Colours } from "./colours";

const SLOW_MS = 45;
const FAST_MS = 22;
const COARSEST = 0.45;
/** ms without a frame after which nothing moves */
const REST_MS = 160;
const FINE_SLOW = 1.5;
/** Number of frames after which the resolution is adapted. */
const WINDOW = 5;
/** m below a surface at which shadows fall on it, as the shadow map is coarse */
const BIAS = 0.07;
const SHADOW_PX = 2048;
/** For rendering without a graphics card. */
const SHADOW_PX_SLOW = 1024;

/** An animation: it gets the time since the last frame (s), and returns whether it goes on. */
export type Moving = (dt: number) => boolean;

export class Stage {
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(38, 1, 0.1, 400);
  readonly moving = new Set<Moving>();
  /** Called after each frame. */
  readonly drawn = new Set<() => void>();
  readonly slow: boolean;
  private readonly renderer: WebGLRenderer;
  private readonly sun = new DirectionalLight();
  private readonly sky = new HemisphereLight();
  private asked = 0;
  private resting: ReturnType<typeof setTimeout> | undefined;
  private refining = false;
  private drawnAt = -Infinity;
  private last = 0;
  /** Rendered pixels per CSS pixel: during motion, its upper limit then, and at rest. */
  private ratio = 2;
  private most = 1;
  private finest = 1;
  private fitted = 0;
  private times: number[] = [];
  private width = 1;
  private height = 1;
  private over = false;

  constructor(readonly canvas: HTMLCanvasElement) {
    this.slow = isSoftware();
    this.renderer = new WebGLRenderer({ canvas, antialias: !this.slow, powerPreference: "high-performance" });
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = this.slow ? BasicShadowMap : PCFShadowMap;
    this.renderer.shadowMap.autoUpdate = false;
    this.renderer.info.autoReset = false;
    this.camera.up.set(0, 0, 1);
    this.sky.position.set(0, 0, 1);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.setScalar(this.slow ? SHADOW_PX_SLOW : SHADOW_PX);
    this.scene.add(this.sky, this.sun, this.sun.target);
    canvas.addEventListener("webglcontextrestored", this.restored);
  }

  /** Request a new frame. */
  readonly need = (): void => {
    if (this.asked === 0 && !this.over) this.asked = requestAnimationFrame(this.frame);
  };

  /** Render shadows again after solids have changed. */
  needShadows(): void {
    this.renderer.shadowMap.needsUpdate = true;
    this.need();
  }

  get idle(): boolean {
    return this.asked === 0 && this.resting === undefined;
  }

  /** Draw calls and triangles of the last frame. */
  get figures(): { readonly calls: number; readonly triangles: number } {
    const { calls, triangles } = this.renderer.info.render;
    return { calls, triangles };
  }

  resize(width: number, height: number): void {
    this.width = Math.max(1, width);
    this.height = Math.max(1, height);
    // Without a graphics card, a still picture gets a higher resolution in place of antialiasing.
    this.finest = this.slow ? FINE_SLOW * Math.min(1, devicePixelRatio) : Math.min(devicePixelRatio, 2);
    this.most = this.slow ? Math.min(1, this.finest) : this.finest;
    this.ratio = Math.min(this.ratio, this.most);
    this.camera.aspect = this.width / this.height;
    this.camera.updateProjectionMatrix();
    this.fitted = 0;
    this.need();
  }

  get size(): { readonly width: number; readonly height: number } {
    return { width: this.width, height: this.height };
  }

  /** Set the light of a theme. */
  light(colours: Colours): void {
    this.scene.background = new Color(colours.sky);
    this.sky.color.set(colours.skyLight);
    this.sky.groundColor.set(colours.groundLight);
    this.sky.intensity = colours.dark ? 1.5 : 2.1;
    this.sun.intensity = colours.dark ? 1.9 : 2.4;
    this.need();
  }

  lightOver(lowest: Vector3, highest: Vector3): void {
    const middle = lowest.clone().add(highest).multiplyScalar(0.5);
    const radius = lowest.distanceTo(highest) / 2 + 1;
    this.sun.target.position.copy(middle);
    this.sun.position.copy(middle).add(new Vector3(-0.45, -0.7, 1.15).multiplyScalar(2 * radius));
    this.sun.target.updateMatrixWorld();
    const seen = this.sun.shadow.camera;
    seen.left = seen.bottom = -radius;
    seen.right = seen.top = radius;
    seen.near = radius / 2;
    seen.far = 5 * radius;
    seen.updateProjectionMatrix();
    this.sun.shadow.bias = -BIAS / (seen.far - seen.near);
    this.needShadows();
  }

  /** Return the position of a point (m) in the view (px) and its depth; null: it is behind the camera. */
  project(point: Vector3): { readonly x: number; readonly y: number; readonly depth: number } | null {
    SEEN.copy(point).applyMatrix4(this.camera.matrixWorldInverse);
    const depth = -SEEN.z;
    if (depth < this.camera.near) return null;
    SEEN.applyMatrix4(this.camera.projectionMatrix);
    return { x: ((SEEN.x + 1) / 2) * this.width, y: ((1 - SEEN.y) / 2) * this.height, depth };
  }

  dispose(): void {
    this.over = true;
    cancelAnimationFrame(this.asked);
    clearTimeout(this.resting);
    this.canvas.removeEventListener("webglcontextrestored", this.restored);
    dispose(this.scene);
    this.sun.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }

  private readonly frame = (time: number): void => {
    this.asked = 0;
    const running = this.last > 0;
    const ms = running ? time - this.last : 16;
    const dt = Math.min(0.1, ms / 1000);
    let on = false;
    for (const move of [...this.moving]) on = move(dt) || on;
    if (running && on) this.adapt(ms);
    // Frames in quick succession, as when the pointer moves the ghost, have a low resolution as well.
    const coarse = !this.refining && (on || time - this.drawnAt < REST_MS);
    this.fit(coarse ? this.ratio : this.finest);
    clearTimeout(this.resting);
    this.resting = undefined;
    this.refining = false;
    if (!on && coarse && this.ratio < this.finest)
      this.resting = setTimeout(() => {
        this.resting = undefined;
        this.refining = true;
        this.need();
      }, REST_MS);
    this.renderer.info.reset();
    this.renderer.render(this.scene, this.camera);
    this.last = on ? time : 0;
    this.drawnAt = time;
    if (on) this.need();
    for (const listener of this.drawn) listener();
  };

  /** Lower the resolution if frames take long, raise it if they don't. */
  private adapt(ms: number): void {
    this.times.push(ms);
    if (this.times.length < WINDOW) return;
    const middle = [...this.times].sort((a, b) => a - b)[WINDOW >> 1] as number;
    this.times = [];
    const factor = middle > SLOW_MS ? 0.75 : middle < FAST_MS ? 1.25 : 1;
    this.ratio = Math.min(this.most, Math.max(COARSEST, this.ratio * factor));
  }

  private fit(ratio: number): void {
    if (ratio === this.fitted) return;
    this.fitted = ratio;
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(this.width, this.height, false);
  }

  private readonly restored = (): void => this.needShadows();
}

const SEEN = new Vector3();

/** Free the graphics memory of an object. */
export function dispose(object: Object3D): void {
  object.traverse((one) => {
    if (!(one instanceof Mesh || one instanceof Points)) return;
    const drawn = one as unknown as { geometry: { dispose(): void }; material: Material | Material[] };
    drawn.geometry.dispose();
    for (const material of [drawn.material].flat()) material.dispose();
  });
  object.removeFromParent();
}

/** Return whether the browser renders without a graphics card. */
function isSoftware(): boolean {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (gl === null) return true;
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const name = info ? String(gl.getParameter(info.UNMASKED_RENDERER_WEBGL)) : "";
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}
