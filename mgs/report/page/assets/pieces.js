// Pieces of a 3D view: footsteps, support polygon, boxes, balls, forces and replays.
"use strict";

/** Phase of a time: the last one that has begun. */
function phaseAt(polygons, t) {
  let low = 0, high = polygons.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (polygons[middle].t <= t + 1e-9) low = middle; else high = middle - 1;
  }
  return polygons[low];
}

function groundHeight(motion, t) {
  return motion.ground.polygons.length ? phaseAt(motion.ground.polygons, t).z : 0;
}

/** Corners of a rectangle on the ground. */
function rectangle(x, y, yaw, length, width) {
  const c = Math.cos(yaw), s = Math.sin(yaw);
  return [[1, 1], [-1, 1], [-1, -1], [1, -1]].map(([a, b]) => {
    const u = 0.5 * a * length, v = 0.5 * b * width;
    return [x + c * u - s * v, y + s * u + c * v];
  });
}

/** All footsteps of a side in two objects, since a long walk has thousands of them. */
function footstepParts(view) {
  const { footsteps, soles } = view.motion.ground;
  const lift = 0.003 * view.height;
  return [0, 1].map((side) => {
    const lines = [], faces = [];
    for (const [which, x, y, z, yaw] of footsteps) {
      if (which !== side) continue;
      const corners = rectangle(x, y, yaw, ...soles[side]).map((p) => [...p, z + lift]);
      corners.forEach((p, i) => lines.push(...p, ...corners[(i + 1) % 4]));
      for (const i of [0, 1, 2, 0, 2, 3]) faces.push(...corners[i]);
    }
    const edge = new THREE.LineSegments(lineGeometry(lines), new THREE.LineBasicMaterial());
    const fill = new THREE.Mesh(lineGeometry(faces), new THREE.MeshBasicMaterial({
      transparent: true, opacity: 0.25, side: THREE.DoubleSide, depthWrite: false,
    }));
    edge.frustumCulled = fill.frustumCulled = false;
    const group = new THREE.Group();
    group.add(fill, edge);
    const paint = () => {
      const colour = colourOf(side === 0 ? "left" : "right");
      edge.material.color.set(colour);
      fill.material.color.set(colour);
    };
    return { name: "Footsteps", object: group, paint };
  });
}

function polygonPart(view) {
  const polygons = view.motion.ground.polygons;
  const most = Math.max(...polygons.map((polygon) => polygon.points.length));
  const fill = new THREE.Mesh(lineGeometry(new Array(9 * most).fill(0)),
    new THREE.MeshBasicMaterial({ transparent: true, opacity: 0.4, side: THREE.DoubleSide, depthWrite: false }));
  fill.frustumCulled = false;
  let drawn = null;
  const update = (t) => {
    const polygon = phaseAt(polygons, t);
    if (polygon === drawn) return;
    drawn = polygon;
    const z = polygon.z + 0.004 * view.height, points = polygon.points;
    const attribute = fill.geometry.getAttribute("position");
    for (let i = 0; i < most; i++) {
      const triangle = [points[0], points[Math.min(i, points.length - 1)], points[Math.min(i + 1, points.length - 1)]];
      triangle.forEach(([x, y], j) => attribute.setXYZ(3 * i + j, x, y, z));
    }
    attribute.needsUpdate = true;
  };
  return {
    name: "Support polygon", object: fill, update,
    paint: () => fill.material.color.set(colourOf("zmp")),
  };
}

function scenePieces(view) {
  const { boxes, balls } = view.motion.ground;
  const parts = boxes.map(([x, y, yaw, length, width, height]) => {
    const box = new THREE.Mesh(new THREE.BoxGeometry(length, width, height),
      new THREE.MeshLambertMaterial());
    box.position.set(x, y, 0.5 * height);
    box.rotation.z = yaw;
    box.receiveShadow = true;
    const edges = new THREE.LineSegments(new THREE.EdgesGeometry(box.geometry),
      new THREE.LineBasicMaterial());
    box.add(edges);
    const paint = () => {
      box.material.color.set(colourOf("box"));
      edges.material.color.set(colourOf("faint"));
    };
    return { name: "Boxes", object: box, paint };
  });
  balls.forEach(([x, y, radius, time]) => {
    const ball = ballMesh(radius, 1);
    ball.position.set(x, y, radius);
    // where a ball rolls after it was struck is not planned
    parts.push({ name: "Balls", object: ball, update: (t) => t <= time, paint: () => ball.material.color.set(colourOf("ghost")) });
  });
  return parts;
}

function ballMesh(radius, opacity) {
  const ball = new THREE.Mesh(new THREE.SphereGeometry(radius, 28, 18),
    new THREE.MeshLambertMaterial({ transparent: opacity < 1, opacity }));
  ball.castShadow = opacity === 1;
  return ball;
}

/** Arrow whose length is the force, one weight being 0.9 times the height of the CoM. */
function forcePart(view, name, colour, times, forceAt) {
  const group = new THREE.Group(), thick = 0.012 * view.height;
  // in front of the robot, which would hide it
  const material = new THREE.MeshBasicMaterial({ transparent: true, opacity: 0.85, depthTest: false });
  const shaft = new THREE.Mesh(new THREE.CylinderGeometry(thick, thick, 1, 10).translate(0, 0.5, 0), material);
  const head = new THREE.Mesh(new THREE.CylinderGeometry(0, 3 * thick, 8 * thick, 12).translate(0, -4 * thick, 0), material);
  shaft.renderOrder = head.renderOrder = 2;
  group.add(shaft, head);
  const up = new THREE.Vector3(0, 1, 0);
  const update = (t) => {
    const [origin, force] = forceAt(locate(times, t), t);
    const vector = new THREE.Vector3(...force), size = vector.length();
    const length = 0.9 * view.height * size / view.motion.weight;
    if (!(length > 8 * thick) || origin.some(Number.isNaN)) return false;
    group.position.fromArray(origin);
    group.quaternion.setFromUnitVectors(up, vector.divideScalar(size));
    shaft.scale.set(1, length - 6 * thick, 1);
    head.position.set(0, length, 0);
    return true;
  };
  return { name, object: group, update, paint: () => material.color.set(colourOf(colour)) };
}

function replayParts(view, replay) {
  const arrays = replay.decoded, colour = replay.colour;
  const ghost = new RobotModel(view.motion, 0xffffff);
  const parts = [{
    name: replay.engine, object: ghost.root,
    update: (t) => ghost.pose(arrays, locate(arrays.t, t)),
    paint: () => ghost.materials.forEach((material) => material.color.set(colourOf(colour))),
  }];
  for (const side of [0, 1]) {
    parts.push(forcePart(view, replay.engine, colour, arrays.t, ([sample]) => [
      between(arrays.pressure, [sample, 0], 3 * side, 3),
      between(arrays.force, [sample, 0], 3 * side, 3),
    ]));
  }
  view.motion.ground.balls.forEach(([, , radius], i) => {
    if (!arrays.balls) return;
    const ball = ballMesh(radius, 0.6);
    parts.push({
      name: replay.engine, object: ball,
      update: (t) => { ball.position.fromArray(between(arrays.balls, locate(arrays.t, t), 3 * i, 3)); },
      paint: () => ball.material.color.set(colourOf(colour)),
    });
  });
  return parts;
}
