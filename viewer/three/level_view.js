import { BufferAttribute, BufferGeometry, DoubleSide, Group, Mesh, MeshStandardMaterial } from 'three';

/** The level on the screen. Parts share their lattice: drawn together they are one surface. */
export class LevelView extends Group {
  #material = new MeshStandardMaterial({ color: 0xc98a3c, roughness: 0.62, metalness: 0, side: DoubleSide });

  set color(color) {
    this.#material.color.set(color);
  }

  set wireframe(on) {
    this.#material.wireframe = on;
  }

  /** Draws these parts instead of what was drawn, and gives the old ones' memory back. */
  replace(parts) {
    const old = [...this.children];
    for (const part of parts) this.add(new Mesh(geometryOf(part), this.#material));
    for (const mesh of old) {
      this.remove(mesh);
      mesh.geometry.dispose();
    }
  }
}

function geometryOf({ positions, triangles, normals }) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(positions, 3));
  geometry.setAttribute('normal', new BufferAttribute(normals, 3));
  geometry.setIndex(new BufferAttribute(triangles, 1));
  geometry.computeBoundingSphere();
  return geometry;
}
