import {
  Box3, Color, DirectionalLight, Group, HemisphereLight, PerspectiveCamera, Raycaster, Scene, Sphere,
  Spherical, Vector2, Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';

import { distanceToSee } from '../core/placement.js';

const FIELD_OF_VIEW = 38;
/** From where the survey is seen first, and the share of the view that it fills; names and numbers lie around it. */
const FIRST_VIEW = Object.freeze(new Vector3(-0.52, 0.62, 0.78));
const FILLED = 0.84;
const CLICK_PIXELS = 5;
/** Distance of a close-up in radii of what is looked at. */
const CLOSE_UP = 6;

/** Canvas, camera and light. Draws when something changed, never otherwise. */
export class Stage {
  /** Everything of the survey; its y scale is the vertical exaggeration. */
  world = new Group();
  #scene = new Scene();
  #camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 1, 1e6);
  #renderer;
  #controls;
  #points = [[-0.5, -0.5, -0.5], [0.5, 0.5, 0.5]];
  #scheduled = false;
  #afterDraw = [];

  constructor(canvas) {
    this.#renderer = new WebGLRenderer({ canvas, antialias: true });
    this.#renderer.setPixelRatio(Math.min(2, globalThis.devicePixelRatio));
    this.#scene.add(this.world, this.#camera);
    this.#addLights();
    this.#controls = new OrbitControls(this.#camera, canvas);
    this.#controls.addEventListener('change', () => this.draw());
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

  /** Looks from south-west, from above, at points around the origin of which all are to be seen; in the world's own scale. */
  frame(points) {
    this.#points = points;
    this.resetView();
  }

  resetView() {
    this.world.updateMatrixWorld();
    const half = Math.tan((FIELD_OF_VIEW * Math.PI) / 360);
    this.#controls.target.set(0, 0, 0);
    this.#camera.position.copy(FIRST_VIEW);
    this.#camera.lookAt(this.#controls.target);
    const toCamera = this.#camera.quaternion.clone().invert();
    const seen = this.#points.map((point) => this.world.localToWorld(new Vector3(...point)).applyQuaternion(toCamera).toArray());
    const distance = distanceToSee(seen, FILLED * half * this.#camera.aspect, FILLED * half);
    this.#camera.near = distance / 200;
    this.#camera.far = distance * 20;
    this.#camera.position.copy(FIRST_VIEW).setLength(distance);
    this.#camera.updateProjectionMatrix();
    this.#controls.update();
    this.draw();
  }

  /** Goes near an object of the world, from the side from which it is seen now. */
  lookAt(object) {
    const { center, radius } = new Box3().setFromObject(object).getBoundingSphere(new Sphere());
    const direction = new Vector3().subVectors(this.#camera.position, this.#controls.target).normalize();
    this.#controls.target.copy(center);
    this.#camera.position.copy(center).addScaledVector(direction, Math.max(CLOSE_UP * radius, 3 * this.#camera.near));
    this.#controls.update();
    this.draw();
  }

  draw() {
    if (this.#scheduled) return;
    this.#scheduled = true;
    requestAnimationFrame(() => {
      this.#scheduled = false;
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
    this.draw();
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
