import {
  Box3, Color, DirectionalLight, Group, HemisphereLight, PerspectiveCamera, Raycaster, Scene, Spherical, Vector2, Vector3,
  WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';

import { distanceToSee } from '../core/placement.js';

const FIELD_OF_VIEW = 38;
/** From where the survey is seen first, and the pixels around what is framed that stay free for names and numbers. */
const FIRST_VIEW = Object.freeze(new Vector3(-0.52, 0.62, 0.78));
const FREE = Object.freeze({ across: 52, down: 24 });
const CLICK_PIXELS = 5;
/** The depths that are drawn, as shares of the distance to what is looked at and to the survey's far end. */
const NEAREST = 1 / 200;
const FARTHEST = 2;

/** Canvas, camera and light. Draws when something changed, never otherwise. */
export class Stage {
  /** Everything of the survey; its y scale is the vertical exaggeration. */
  world = new Group();
  #scene = new Scene();
  #camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 1, 1e6);
  #renderer;
  #controls;
  #points = [[-0.5, -0.5, -0.5], [0.5, 0.5, 0.5]];
  /** Shows again what was framed last; null once somebody has turned the view. */
  #reframe = null;
  #isFraming = false;
  #scheduled = false;
  #afterDraw = [];
  #overlays;

  /** overlays   elements over the canvas that hide nothing of what is framed. */
  constructor(canvas, overlays) {
    this.#overlays = overlays;
    this.#renderer = new WebGLRenderer({ canvas, antialias: true });
    this.#renderer.setPixelRatio(Math.min(2, globalThis.devicePixelRatio));
    this.#scene.add(this.world, this.#camera);
    this.#addLights();
    this.#controls = new OrbitControls(this.#camera, canvas);
    this.#controls.addEventListener('change', () => {
      if (!this.#isFraming) this.#reframe = null;
      this.draw();
    });
    canvas.addEventListener('keydown', (event) => this.#onKey(event));
    new ResizeObserver(() => this.#resize()).observe(canvas.parentElement);
  }

  set background(color) {
    this.#scene.background = new Color(color);
    this.draw();
  }

  get camera() {
    return this.#camera;
  }

  /** Calls action(camera, width, height) after each frame. */
  afterDraw(action) {
    this.#afterDraw.push(action);
  }

  /** Calls action(raycaster) for each click or tap that does not turn the view. */
  onClick(action) {
    const canvas = this.#renderer.domElement;
    let pressed = null;
    canvas.addEventListener('pointerdown', (event) => {
      pressed = event.isPrimary && event.button === 0 ? event : null;
    });
    canvas.addEventListener('pointerup', (event) => {
      const isClick = pressed && Math.hypot(event.clientX - pressed.clientX, event.clientY - pressed.clientY) < CLICK_PIXELS;
      if (isClick) action(this.#rayAt(event));
      pressed = null;
    });
  }

  #rayAt({ clientX, clientY }) {
    const { left, top, width, height } = this.#renderer.domElement.getBoundingClientRect();
    const raycaster = new Raycaster();
    raycaster.setFromCamera(new Vector2((2 * (clientX - left)) / width - 1, 1 - (2 * (clientY - top)) / height), this.#camera);
    return raycaster;
  }

  /** Looks from south-west, from above, at points of which all are to be seen; in the world's own scale. */
  frame(points) {
    this.#points = points;
    this.resetView();
  }

  resetView() {
    this.#reframe = () => this.#show(this.#points, FIRST_VIEW);
    this.#reframe();
  }

  /** Goes near points of the world, so that all are to be seen, from the side from which it is seen now. */
  lookAt(points) {
    const direction = new Vector3().subVectors(this.#camera.position, this.#controls.target);
    this.#reframe = () => this.#show(points, direction);
    this.#reframe();
  }

  /** Fills the view with points in the world's own scale, seen from a direction. */
  #show(points, direction) {
    this.world.updateMatrixWorld();
    const places = points.map((point) => this.world.localToWorld(new Vector3(...point)));
    const middle = new Box3().setFromPoints(places).getCenter(new Vector3());
    this.#camera.position.copy(middle).add(direction);
    this.#camera.lookAt(middle);
    const toCamera = this.#camera.quaternion.clone().invert();
    const seen = places.map((place) => place.sub(middle).applyQuaternion(toCamera).toArray());
    const distance = distanceToSee(seen, ...this.#makeRoom()) || 1;
    this.#camera.position.copy(middle).add(direction.clone().setLength(distance));
    this.#isFraming = true;
    this.#controls.target.copy(middle);
    this.#controls.update();
    this.#isFraming = false;
    this.draw();
  }

  /** Moves the middle to between what lies over the canvas; returns half of the width and of the height seen there at distance 1. */
  #makeRoom() {
    const { width, height, above, below } = this.#freeSpace();
    const shown = (pixels, hidden) => Math.max(0.4 * pixels, pixels - hidden);
    const pixel = Math.tan((FIELD_OF_VIEW * Math.PI) / 360) / height;
    this.#camera.setViewOffset(width, height, 0, Math.round((below - above) / 2), width, height);
    return [pixel * shown(width, 2 * FREE.across), pixel * shown(height, above + below)];
  }

  /** The canvas and how much of it is hidden at its upper and its lower end, in pixels. */
  #freeSpace() {
    const { top, bottom, width, height } = this.#renderer.domElement.getBoundingClientRect();
    const boxes = this.#overlays.map((overlay) => overlay.getBoundingClientRect()).filter((box) => box.height > 0);
    const isAbove = (box) => box.top + box.bottom < top + bottom;
    const above = Math.max(0, ...boxes.filter(isAbove).map((box) => box.bottom - top));
    const below = Math.max(0, ...boxes.filter((box) => !isAbove(box)).map((box) => bottom - box.top));
    return { width: Math.max(1, width), height: Math.max(1, height), above: above + FREE.down, below: below + FREE.down };
  }

  /** Draws from a little before what is looked at to behind the survey's far end: near enough to each other to tell depths apart. */
  #fitDepths() {
    const distance = this.#camera.position.distanceTo(this.#controls.target);
    const distances = this.#points.map((point) => this.world.localToWorld(new Vector3(...point)).distanceTo(this.#camera.position));
    const reach = Math.max(...distances);
    this.#camera.near = NEAREST * distance;
    this.#camera.far = FARTHEST * Math.max(reach, distance);
    this.#camera.updateProjectionMatrix();
  }

  draw() {
    if (this.#scheduled) return;
    this.#scheduled = true;
    requestAnimationFrame(() => {
      this.#scheduled = false;
      this.#fitDepths();
      this.#renderer.render(this.#scene, this.#camera);
      const { clientWidth, clientHeight } = this.#renderer.domElement;
      for (const action of this.#afterDraw) action(this.#camera, clientWidth, clientHeight);
    });
  }

  /** Sky and ground light for the slopes, and a lamp that goes with the eye for the rest. */
  #addLights() {
    const lamp = new DirectionalLight(0xffffff, 2.6);
    lamp.position.set(-0.9, 0.9, 0.4);
    this.#camera.add(lamp);
    this.#scene.add(new HemisphereLight(0xf4f7ff, 0x6f665c, 1.1));
  }

  #resize() {
    const { clientWidth, clientHeight } = this.#renderer.domElement.parentElement;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.#renderer.setSize(clientWidth, clientHeight, false);
    this.#camera.aspect = clientWidth / clientHeight;
    this.#camera.updateProjectionMatrix();
    if (this.#reframe) this.#reframe();
    else this.draw();
  }

  /** Arrows turn, + and - zoom, Home goes back. */
  #onKey(event) {
    const turns = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] };
    const zooms = { '+': 0.9, '=': 0.9, '-': 1 / 0.9 };
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (turns[event.key]) this.#turn(...turns[event.key], 1);
    else if (zooms[event.key]) this.#turn(0, 0, zooms[event.key]);
    else if (event.key === 'Home') this.resetView();
    else return;
    event.preventDefault();
  }

  #turn(around, down, zoom) {
    const offset = new Vector3().subVectors(this.#camera.position, this.#controls.target);
    const place = new Spherical().setFromVector3(offset);
    place.theta += around;
    place.phi += down;
    place.radius *= zoom;
    this.#camera.position.setFromSpherical(place.makeSafe()).add(this.#controls.target);
    this.#controls.update();
    this.draw();
  }
}
