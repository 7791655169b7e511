import { BufferAttribute, BufferGeometry, Group, Mesh } from 'three';

import { palenessOf, vertexColours } from '../core/colours.js';
import { bodyLast } from '../core/mesh.js';
import { ghostMaterial, LevelMaterial } from './level_material.js';

/** The level on the screen. Parts share their lattice: drawn together they are one surface. */
export class LevelView extends Group {
  #solid = new LevelMaterial();
  #ghost = ghostMaterial();
  #look = { colouring: 'plain', plain: '', pale: '', top: 0, bottom: 0 };
  #selected = null;

  get parts() {
    return this.children.map(({ userData }) => userData.part);
  }

  set wireframe(on) {
    for (const material of [this.#solid, this.#ghost]) material.wireframe = on;
  }

  /** {colouring, plain, pale, top, bottom}, as core/colours.js has them; what is not named stays. */
  set look(changed) {
    if (Object.entries(changed).every(([name, value]) => this.#look[name] === value)) return;
    this.#look = { ...this.#look, ...changed };
    for (const material of [this.#solid, this.#ghost]) {
      material.vertexColors = this.#look.colouring !== 'plain';
      material.plain = this.#look.plain;
      material.needsUpdate = true;
    }
    this.#refresh();
  }

  /** The body that is singled out, or null: the others become ghosts. */
  set selected(body) {
    this.#selected = body;
    this.#refresh();
  }

  /** Draws these parts instead of what was drawn, and gives the old ones' memory back. */
  replace(parts) {
    const old = [...this.children];
    for (const part of parts) this.add(this.#meshOf(part));
    for (const mesh of old) {
      this.remove(mesh);
      mesh.geometry.dispose();
    }
  }

  /** The body under a ray, or null. A triangle's vertices are of one body. */
  bodyAt(raycaster) {
    const [hit] = raycaster.intersectObject(this);
    return hit?.object.userData.part.body?.[hit.face.a] ?? null;
  }

  #refresh() {
    this.replace(this.parts);
  }

  #meshOf(part) {
    const geometry = geometryOf(part, this.#look);
    if (this.#selected === null || !part.body) {
      geometry.setIndex(new BufferAttribute(part.triangles, 1));
      return withPart(new Mesh(geometry, this.#solid), part);
    }
    const { triangles, others } = bodyLast(part.triangles, part.body, this.#selected);
    geometry.setIndex(new BufferAttribute(triangles, 1));
    geometry.addGroup(0, others, 0);
    geometry.addGroup(others, triangles.length - others, 1);
    return withPart(new Mesh(geometry, [this.#ghost, this.#solid]), part);
  }
}

function withPart(mesh, part) {
  mesh.userData.part = part;
  return mesh;
}

function geometryOf(part, look) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(part.positions, 3));
  geometry.setAttribute('normal', new BufferAttribute(part.normals, 3));
  const colours = vertexColours(part, look);
  if (colours) geometry.setAttribute('color', new BufferAttribute(colours, 3));
  const paleness = palenessOf(part, look.colouring);
  if (paleness) geometry.setAttribute('paleness', new BufferAttribute(paleness, 1, true));
  geometry.computeBoundingSphere();
  return geometry;
}
