// A 3D view of one motion: robot, ground, what stands on it, points, forces and the replays.
"use strict";

// Directions from which the robot is seen, in multiples of the height of the CoM.
const CAMERAS = {
  Corner: [2.6, -3.4, 1.7],
  Front: [4.6, 0, 0.5],
  Side: [0, -4.6, 0.5],
  Top: [-0.01, 0, 5.2],
};
const GRID_CELLS = 40;

class View {
  constructor(motion) {
    this.motion = motion;
    this.arrays = motion.decoded;
    this.height = Math.max(motion.height, 0.05);
    this.follow = true;
    this.time = 0;
    this.shown = {};
    this.canvas = make("canvas", {
      role: "img", tabindex: 0,
      "aria-label": `3D view of ${motion.gait}; drag to turn, scroll or pinch to zoom`,
    });
    this.renderer = new THREE.WebGLRenderer({ canvas: this.canvas, antialias: true });
    this.renderer.shadowMap.enabled = true;
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(35, 1, 0.02 * this.height, 400 * this.height);
    this.camera.up.set(0, 0, 1);
    this.controls = new THREE.OrbitControls(this.camera, this.canvas);
    this.controls.maxPolarAngle = 0.52 * Math.PI;
    this.controls.minDistance = 0.5 * this.height;
    this.controls.maxDistance = 60 * this.height;
    this.controls.addEventListener("change", () => this.request());
    this.parts = makeParts(this);
    this.paint();
    this.centre = this.robotPlace();
    this.look("Corner");
    new ResizeObserver(() => this.resize()).observe(this.canvas);
  }

  robotPlace() {
    const [x, y] = between(this.arrays.base, locate(this.arrays.t, this.time));
    return new THREE.Vector3(x, y, 0.85 * this.height);
  }

  look(name) {
    const centre = this.robotPlace();
    this.centre = centre;
    this.controls.target.copy(centre);
    const offset = new THREE.Vector3(...CAMERAS[name]).multiplyScalar(this.height);
    this.camera.position.copy(centre).add(offset);
    this.controls.update();
    this.request();
  }

  setFollow(follow) {
    this.follow = follow;
    if (follow) this.centre = this.robotPlace();
    if (this.onFollow) this.onFollow(follow);
    this.request();
  }

  /** Take the camera of another view, relative to the robot. */
  copyCamera(other) {
    const offset = other.camera.position.clone().sub(other.controls.target);
    offset.multiplyScalar(this.height / other.height);
    this.camera.position.copy(this.controls.target).add(offset);
    this.camera.lookAt(this.controls.target);
    this.request();
  }

  show(name, visible) {
    this.shown[name] = visible;
    this.setTime(this.time);
  }

  setTime(t) {
    this.time = t;
    for (const part of this.parts) {
      part.object.visible = this.shown[part.name] !== false;
      if (part.object.visible && part.update) part.object.visible = part.update(t) !== false;
    }
    if (this.follow) {
      const place = this.robotPlace(), shift = place.clone().sub(this.centre);
      this.centre = place;
      this.controls.target.add(shift);
      this.camera.position.add(shift);
    }
    this.request();
  }

  /** Colours of the theme. */
  paint() {
    const sky = new THREE.Color(colourOf("sky"));
    this.scene.background = sky;
    this.scene.fog = new THREE.Fog(sky, 9 * this.height, 24 * this.height);
    for (const part of this.parts) if (part.paint) part.paint();
    this.request();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height) return;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.fov = width < height ? 48 : 35;
    this.camera.updateProjectionMatrix();
    this.request();
  }

  request() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.renderer.render(this.scene, this.camera);
      if (!window.mgsFirstFrame) window.mgsFirstFrame = performance.now();
    });
  }
}

/** Everything in the scene: an object each, with what changes over time and with the theme. */
function makeParts(view) {
  const parts = [
    lightPart(view), groundPart(view), robotPart(view), ...scenePieces(view), ...footstepParts(view),
    pathPart(view, "CoM", view.arrays.com, "com", (i) => view.arrays.com.values[3 * i + 2]),
    pointPart(view, "CoM", "com", (place) => between(view.arrays.com, place)),
  ];
  if (view.arrays.zmp) {
    const height = (i) => groundHeight(view.motion, view.arrays.t.values[i]);
    parts.push(
      polygonPart(view),
      pathPart(view, "ZMP", view.arrays.zmp, "zmp", height),
      pointPart(view, "ZMP", "zmp", (place, t) =>
        [...between(view.arrays.zmp, place), groundHeight(view.motion, t) + 0.004 * view.height]),
      forcePart(view, "Contact force", "force", view.arrays.t, (place, t) => [
        [...between(view.arrays.zmp, place), groundHeight(view.motion, t)],
        between(view.arrays.force, place),
      ]));
  }
  view.motion.replays.forEach((replay) => parts.push(...replayParts(view, replay)));
  for (const part of parts) view.scene.add(part.object);
  return parts;
}

function lightPart(view) {
  const group = new THREE.Group(), h = view.height;
  const sun = new THREE.DirectionalLight(0xffffff, 2.2);
  sun.castShadow = true;
  sun.shadow.mapSize.set(1024, 1024);
  Object.assign(sun.shadow.camera, { left: -2 * h, right: 2 * h, top: 2 * h, bottom: -2 * h, near: 0.1 * h, far: 12 * h });
  sun.shadow.bias = -0.002;
  group.add(new THREE.HemisphereLight(0xffffff, 0x667080, 1.7), sun, sun.target);
  const update = () => {
    const place = view.robotPlace();
    sun.target.position.copy(place);
    sun.position.copy(place).add(new THREE.Vector3(1.5 * h, -2.5 * h, 5 * h));
  };
  return { name: "light", object: group, update };
}

function groundPart(view) {
  const group = new THREE.Group();
  const cell = view.height > 0.35 ? 0.25 : 0.1, half = 0.5 * GRID_CELLS * cell;
  const plane = new THREE.Mesh(new THREE.PlaneGeometry(4 * half, 4 * half),
    new THREE.MeshLambertMaterial());
  plane.receiveShadow = true;
  plane.position.z = -0.004 * view.height;
  const points = [];
  for (let i = 0; i <= GRID_CELLS; i++) {
    const at = i * cell - half;
    points.push(at, -half, 0, at, half, 0, -half, at, 0, half, at, 0);
  }
  const grid = new THREE.LineSegments(lineGeometry(points), new THREE.LineBasicMaterial());
  grid.position.z = -0.002 * view.height;
  group.add(plane, grid);
  return {
    name: "ground", object: group,
    update: () => { // the grid goes with the robot, cell by cell
      const place = view.robotPlace();
      group.position.set(cell * Math.round(place.x / cell), cell * Math.round(place.y / cell), 0);
    },
    paint: () => {
      plane.material.color.set(colourOf("ground"));
      grid.material.color.set(colourOf("grid"));
    },
  };
}

function robotPart(view) {
  const robot = new RobotModel(view.motion);
  return {
    name: "Robot", object: robot.root, model: robot,
    update: (t) => robot.pose(view.arrays, locate(view.arrays.t, t)),
  };
}

function lineGeometry(points) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(points), 3));
  return geometry;
}

function pathPart(view, name, array, colour, height) {
  const points = new Float32Array(3 * array.rows);
  for (let i = 0; i < array.rows; i++) {
    points[3 * i] = array.values[array.columns * i];
    points[3 * i + 1] = array.values[array.columns * i + 1];
    points[3 * i + 2] = height(i) + 0.002 * view.height;
  }
  const line = new THREE.Line(lineGeometry(points), new THREE.LineBasicMaterial());
  line.frustumCulled = false;
  return { name: "Paths", object: line, paint: () => line.material.color.set(colourOf(colour)), of: name };
}

function pointPart(view, name, colour, where) {
  const ball = new THREE.Mesh(new THREE.SphereGeometry(0.035 * view.height, 20, 14),
    new THREE.MeshBasicMaterial({ depthTest: false, transparent: true }));
  ball.renderOrder = 3;
  return {
    name, object: ball,
    update: (t) => ball.position.fromArray(where(locate(view.arrays.t, t), t)),
    paint: () => ball.material.color.set(colourOf(colour)),
  };
}
