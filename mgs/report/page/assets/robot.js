// The robot as nested three.js objects, one per link, posed by its joint angles.
"use strict";

function shapeGeometry(shape, meshes) {
  const [a, b, c] = shape.size;
  if (shape.kind === "box") return new THREE.BoxGeometry(a, b, c);
  if (shape.kind === "sphere") return new THREE.SphereGeometry(a, 24, 16);
  if (shape.kind === "mesh") return meshes[shape.mesh].clone().scale(a, b, c);
  const round = shape.kind === "cylinder"
    ? new THREE.CylinderGeometry(a, a, b, 28)
    : new THREE.CapsuleGeometry(a, b, 8, 24);
  return round.rotateX(Math.PI / 2); // the axis is z in a URDF and y in three.js
}

function meshGeometry(entry) {
  const geometry = new THREE.BufferGeometry();
  const vertices = unpack(entry.vertices), triangles = unpack(entry.triangles);
  geometry.setAttribute("position", new THREE.BufferAttribute(vertices.values, 3));
  geometry.setIndex(new THREE.BufferAttribute(triangles.values, 1));
  const flat = geometry.toNonIndexed();
  flat.computeVertexNormals();
  return flat;
}

class RobotModel {
  /** `ghost` is a colour, or null for the robot itself. */
  constructor(motion, ghost = null) {
    this.motion = motion;
    this.links = { [motion.tree.root]: new THREE.Group() };
    this.root = this.links[motion.tree.root];
    this.materials = [];
    const children = [...motion.tree.moving, ...motion.tree.fixed];
    for (const child of children) this.links[child.link] = new THREE.Group();
    for (const child of children) {
      const group = this.links[child.link], parent = this.links[child.parent];
      if (child.pose) {
        group.position.fromArray(child.pose);
        group.quaternion.fromArray(child.pose, 3);
      } else {
        group.position.fromArray(child.position);
      }
      if (parent) parent.add(group);
    }
    const meshes = motion.meshes.map(meshGeometry);
    for (const shape of motion.shapes) this.addShape(shape, meshes, ghost);
  }

  addShape(shape, meshes, ghost) {
    const link = this.links[shape.link];
    if (!link) return;
    const [r, g, b, opacity] = shape.colour;
    const material = new THREE.MeshLambertMaterial({ side: THREE.DoubleSide });
    material.color.setRGB(r, g, b, THREE.SRGBColorSpace);
    if (ghost !== null) material.color.set(ghost);
    if (ghost !== null) { // behind the robot where both are in the same place
      Object.assign(material, { polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 8 });
    }
    material.opacity = ghost === null ? opacity : 0.5;
    material.transparent = material.opacity < 1;
    material.depthWrite = !material.transparent;
    const mesh = new THREE.Mesh(shapeGeometry(shape, meshes), material);
    mesh.position.fromArray(shape.pose);
    mesh.quaternion.fromArray(shape.pose, 3);
    mesh.castShadow = ghost === null;
    this.materials.push(material);
    link.add(mesh);
  }

  /** Place the robot; `arrays` has base, turn and q. */
  pose(arrays, place) {
    this.root.position.fromArray(between(arrays.base, place));
    this.root.quaternion.fromArray(turnBetween(arrays.turn, place));
    const q = between(arrays.q, place);
    for (const child of this.motion.tree.moving) {
      const half = 0.5 * q[child.joint], c = Math.cos(half), s = Math.sin(half);
      this.links[child.link].quaternion.fromArray(child.quat.map((x, i) => c * x + s * child.turn[i]));
    }
  }
}
