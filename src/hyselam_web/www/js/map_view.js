// The map on a canvas: what the robot knows, in metres, moved and zoomed by fingers, mouse and keys.
import {unpack} from "./model.js";
import {TilePictures} from "./tiles.js";
import {MapLabels} from "./map_labels.js";
import {drawThings, thingsOn} from "./map_things.js";
import {plainWalls, shutBy} from "./building.js";

const TAP = 9; // [pixels] that a finger may move within a tap
const GLIDE = 250; // [ms] in which the robot's picture follows its pose

export class MapView {
  // events: onTap(x, y, place id or null, object id or null), onLine(a, b), onUserMove()
  constructor(canvas, model, events) {
    Object.assign(this, {canvas, model, events});
    this.context = canvas.getContext("2d");
    this.center = [0, 0];
    this.scale = 20; // pixels a metre
    this.fitted = false;
    this.fittedToMap = false; // what was known before the map is only a corner of it
    this.follows = false;
    this.selected = null;
    this.hovered = null; // the place under the mouse
    this.names = new MapLabels(this);
    this.tool = null; // {kind, from, to}
    this.pointers = new Map();
    this.shown = null; // pose that is drawn
    this.keys = false; // the canvas is used by keys: a cross marks its middle
    this.tiles = new TilePictures(model, () => this.invalidate());
    this.listen();
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.resize();
    const dark = matchMedia("(prefers-color-scheme: dark)");
    dark.addEventListener("change", () => this.themeChanged());
    this.themeChanged();
    model.on(["map", "places", "doors", "walls", "told", "objects", "pose", "spread", "scan", "particles", "way", "here", "asked", "status", "camera", "marked"], (names) => {
      if (names.includes("scan")) this.scanPoints = null;
      if (names.includes("particles")) this.particlePoints = null;
      if (names.includes("map") && !this.fittedToMap && (!this.fitted || this.untouched)) this.fit();
      this.invalidate();
    });
  }

  tilesChanged() {
    this.tiles.update(this.dark);
  }

  themeChanged() {
    const theme = document.documentElement.dataset.theme;
    this.dark = theme ? theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
    this.colors = this.dark
      ? {text: "#f2f5f7", halo: "#10161b", soft: "#b4c0ca", way: "#58d68d", robot: "#7db4ff", edge: "#0b1a2b", scan: "#ff8f7a", particle: "#ff7bb0", glass: "#66d9ff", asked: "#ffab5e", lit: "rgba(125, 180, 255, .45)", door: "#e0a85c", shut: "#ff8080", object: "#d9a6ff", line: "#98a6b2"}
      : {text: "#10202c", halo: "#ffffff", soft: "#52616e", way: "#15803d", robot: "#1459b3", edge: "#ffffff", scan: "#d4351c", particle: "#c2185b", glass: "#0797c4", asked: "#c25700", lit: "rgba(20, 89, 179, .35)", door: "#9a6200", shut: "#c4101b", object: "#7b2fbf", line: "#6d7a86"};
    this.tiles.update(this.dark);
    this.invalidate();
  }

  resize() {
    const ratio = Math.min(2, devicePixelRatio || 1);
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    if (!width || !height) return;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.ratio = ratio;
    if (!this.fitted || this.untouched) this.fit();
    this.invalidate();
  }

  // ---- Where things are on the screen ----

  toScreen(x, y) {
    return [(x - this.center[0]) * this.scale + this.canvas.clientWidth / 2, (this.center[1] - y) * this.scale + this.canvas.clientHeight / 2];
  }

  toMap(px, py) {
    return [(px - this.canvas.clientWidth / 2) / this.scale + this.center[0], this.center[1] - (py - this.canvas.clientHeight / 2) / this.scale];
  }

  mapCorners() {
    const map = this.model.values.map;
    if (!map) return [];
    const [r, c, s] = [map.resolution, Math.cos(map.yaw), Math.sin(map.yaw)];
    return [[0, 1], [2, 1], [2, 3], [0, 3]].map(([u, v]) => {
      const [x, y] = [map.box[u] * r + map.rest[0], map.box[v] * r + map.rest[1]];
      return [c * x - s * y, s * x + c * y];
    });
  }

  bounds() {
    const xs = [];
    const ys = [];
    for (const place of Object.values(this.model.tables.places)) {
      for (let i = 0; i < (place.o?.length ?? 0); i += 2) {
        xs.push(place.o[i]);
        ys.push(place.o[i + 1]);
      }
    }
    if (xs.length < 3) {
      for (const [x, y] of this.mapCorners()) {
        xs.push(x);
        ys.push(y);
      }
    }
    const pose = this.model.values.pose;
    if (!xs.length && pose) return [pose.x - 5, pose.y - 5, pose.x + 5, pose.y + 5];
    return xs.length ? [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)] : null;
  }

  // All of it: the robot is not followed any more.
  fit() {
    if (this.follows) {
      this.follows = false;
      this.events.onUserMove();
    }
    const box = this.bounds();
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    if (!box || !width || !height) return;
    const top = width < 600 ? 60 : 12; // the buttons
    this.scale = this.limited(Math.min((width - 16) / Math.max(1, box[2] - box[0]), (height - top - 12) / Math.max(1, box[3] - box[1])));
    this.center = [(box[0] + box[2]) / 2, (box[1] + box[3]) / 2 + (top - 12) / 2 / this.scale];
    this.fitted = this.untouched = true;
    this.fittedToMap ||= Boolean(this.model.values.map);
    this.invalidate();
  }

  limited(scale) {
    return Math.max(0.5, Math.min(300, scale));
  }

  zoom(factor, px = this.canvas.clientWidth / 2, py = this.canvas.clientHeight / 2) {
    const [x, y] = this.toMap(px, py);
    this.scale = this.limited(this.scale * factor);
    const [nx, ny] = this.toMap(px, py);
    this.center = [this.center[0] + x - nx, this.center[1] + y - ny];
    this.touched();
  }

  // The middle of the screen stays where something is: nobody drags the building out of sight.
  keepInSight() {
    const box = this.bounds();
    if (!box) return;
    const pose = this.model.values.pose;
    const points = [[box[0], box[1]], [box[2], box[3]], ...this.mapCorners(), ...(pose ? [[pose.x, pose.y]] : [])];
    this.center = this.center.map((at, k) => {
      const all = points.map((point) => point[k]);
      return Math.max(Math.min(...all), Math.min(Math.max(...all), at));
    });
  }

  touched() {
    this.untouched = false;
    this.keepInSight();
    this.invalidate();
  }

  setFollow(on) {
    this.follows = on;
    const pose = this.model.values.pose;
    if (on && pose) {
      this.center = [pose.x, pose.y];
      this.scale = Math.max(this.scale, 25);
    }
    this.touched();
  }

  // Into view, where it is not.
  show(x, y) {
    const [px, py] = this.toScreen(x, y);
    if (px < 30 || py < 60 || px > this.canvas.clientWidth - 30 || py > this.canvas.clientHeight - 30) {
      this.center = [x, y];
      this.touched();
    }
  }

  // ---- Fingers, mouse, keys ----

  setTool(kind) {
    this.tool = kind ? {kind, from: null, to: null} : null;
    this.canvas.classList.toggle("drawing", Boolean(kind));
    this.invalidate();
  }

  listen() {
    const at = (event) => {
      const box = this.canvas.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    };
    this.canvas.addEventListener("pointerdown", (event) => {
      this.canvas.setPointerCapture(event.pointerId);
      this.keys = false;
      const p = at(event);
      this.pointers.set(event.pointerId, {start: p, last: p, moved: false});
      if (this.pointers.size > 1) {
        for (const each of this.pointers.values()) each.moved = true; // no tap
        if (this.tool) this.tool.from = this.tool.to = null;
      } else if (this.tool) {
        this.tool.from = this.tool.to = this.toMap(...p);
      }
      this.invalidate();
    });
    this.canvas.addEventListener("pointermove", (event) => {
      const pointer = this.pointers.get(event.pointerId);
      const p = at(event);
      if (!pointer) {
        this.hover(p);
        return;
      }
      if (Math.hypot(p[0] - pointer.start[0], p[1] - pointer.start[1]) > TAP) pointer.moved = true;
      if (this.pointers.size === 2) this.pinch(event.pointerId, p);
      else if (this.tool && this.tool.from) this.tool.to = this.toMap(...p);
      else if (pointer.moved) this.pan(p[0] - pointer.last[0], p[1] - pointer.last[1]);
      pointer.last = p;
      this.invalidate();
    });
    // A tap opens a card; the click that browsers make of it must not press what has come under the finger.
    this.canvas.addEventListener("touchend", (event) => { if (event.cancelable) event.preventDefault(); }, {passive: false});
    const end = (event) => {
      const pointer = this.pointers.get(event.pointerId);
      this.pointers.delete(event.pointerId);
      if (!pointer || event.type === "pointercancel") return;
      if (this.tool && this.tool.from) {
        const {from, to} = this.tool;
        this.tool.from = this.tool.to = null;
        if (pointer.moved) this.events.onLine(from, to);
      } else if (!pointer.moved) {
        this.tap(...pointer.start);
      }
      this.invalidate();
    };
    this.canvas.addEventListener("pointerleave", () => this.hover(null));
    this.canvas.addEventListener("pointerup", end);
    this.canvas.addEventListener("pointercancel", end);
    this.canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0016)), ...at(event));
    }, {passive: false});
    this.canvas.addEventListener("keydown", (event) => this.key(event));
    this.canvas.addEventListener("blur", () => {
      this.keys = false;
      this.invalidate();
    });
  }

  // The mouse over a place, or over none.
  hover(p) {
    const id = p && !this.tool ? this.names.placeAt(...p) : null;
    if (id === this.hovered) return;
    this.hovered = id;
    this.canvas.title = id === null ? "" : this.model.titleOf(id);
    this.invalidate();
  }

  pan(dx, dy) {
    this.center = [this.center[0] - dx / this.scale, this.center[1] + dy / this.scale];
    if (this.follows) {
      this.follows = false;
      this.events.onUserMove();
    }
    this.touched();
  }

  pinch(id, p) {
    const [, other] = [...this.pointers].find(([key]) => key !== id);
    const before = this.pointers.get(id).last;
    const [ox, oy] = other.last;
    const grown = Math.hypot(p[0] - ox, p[1] - oy) / Math.max(10, Math.hypot(before[0] - ox, before[1] - oy));
    this.pan((p[0] - before[0]) / 2, (p[1] - before[1]) / 2);
    this.zoom(grown, (p[0] + ox) / 2, (p[1] + oy) / 2);
  }

  tap(px, py) {
    const [x, y] = this.toMap(px, py);
    let object = null;
    let nearest = 22;
    for (const {id, x: ox, y: oy} of thingsOn(this)) {
      const distance = Math.hypot(ox - px, oy - py);
      if (distance < nearest) [nearest, object] = [distance, id];
    }
    this.events.onTap(x, y, this.names.placeAt(px, py), object);
  }

  key(event) {
    const step = 60;
    const moves = {ArrowLeft: [step, 0], ArrowRight: [-step, 0], ArrowUp: [0, step], ArrowDown: [0, -step]};
    this.keys = true;
    if (moves[event.key]) this.pan(...moves[event.key]);
    else if (event.key === "+" || event.key === "=") this.zoom(1.4);
    else if (event.key === "-") this.zoom(1 / 1.4);
    else if (event.key === "0") this.fit();
    else if (event.key === "r" && this.model.values.pose) this.center = [this.model.values.pose.x, this.model.values.pose.y];
    else if (event.key === "Enter") this.enter();
    else if (event.key === "Escape") this.events.onEscape();
    else return;
    if (this.tool?.from) this.tool.to = [...this.center];
    event.preventDefault();
    this.invalidate();
  }

  enter() {
    if (!this.tool) {
      this.tap(this.canvas.clientWidth / 2, this.canvas.clientHeight / 2);
    } else if (!this.tool.from) {
      this.tool.from = this.tool.to = [...this.center];
      this.events.onFirstEnd();
    } else {
      const {from} = this.tool;
      this.tool.from = this.tool.to = null;
      this.events.onLine(from, [...this.center]);
    }
  }

  // ---- Drawing ----

  invalidate() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame((now) => {
      this.asked = false;
      this.draw(now);
    });
  }

  // The robot's picture glides to its pose.
  glide(now) {
    const pose = this.model.values.pose;
    if (!pose) {
      this.shown = null;
      return;
    }
    if (!this.shown || Math.hypot(pose.x - this.shown.x, pose.y - this.shown.y) > 1.5) this.shown = {...pose};
    const share = Math.min(1, (now - (this.glided ?? now)) / GLIDE * 2.5);
    this.glided = now;
    const turn = Math.atan2(Math.sin(pose.a - this.shown.a), Math.cos(pose.a - this.shown.a));
    if (Math.hypot(pose.x - this.shown.x, pose.y - this.shown.y) < 0.01 && Math.abs(turn) < 0.01) {
      this.shown = {...pose};
    } else {
      this.shown.x += share * (pose.x - this.shown.x);
      this.shown.y += share * (pose.y - this.shown.y);
      this.shown.a += share * turn;
      this.invalidate();
    }
    if (this.follows) this.center = [this.shown.x, this.shown.y];
  }

  draw(now) {
    const {context: c, model} = this;
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    if (!width || !height) return;
    this.glide(now);
    c.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    c.clearRect(0, 0, width, height);
    c.save();
    c.translate(width / 2, height / 2);
    c.scale(this.scale, -this.scale);
    c.translate(-this.center[0], -this.center[1]);
    const map = model.values.map;
    if (map) {
      const [left, top] = this.toMap(0, 0);
      const [right, bottom] = this.toMap(width, height);
      this.tiles.draw(c, map, this.scale * map.resolution * this.ratio, {left, right, top, bottom});
    }
    this.drawPlaces(c);
    this.drawWalls(c);
    this.drawWay(c);
    this.drawSenses(c);
    c.restore();
    drawThings(c, this);
    this.names.draw(c);
    this.drawRobot(c);
    this.drawTool(c);
    this.drawnTiles = this.tiles.drawn.size;
    this.labels = this.names.shown.size;
    // When all of the map was seen first, and when in all its cells [ms after the address was given].
    if (this.tiles.isWhole()) this.seen ??= performance.now();
    if (this.tiles.isFine()) this.fine ??= performance.now();
  }

  outline(c, place) {
    c.beginPath();
    for (let i = 0; i < place.o.length; i += 2) c.lineTo(place.o[i], place.o[i + 1]);
    c.closePath();
  }

  drawPlaces(c) {
    const asked = this.model.values.asked?.place;
    for (const [id, place] of Object.entries(this.model.tables.places)) {
      if (!place.o) continue;
      this.outline(c, place);
      c.fillStyle = `hsla(${Math.round(id * 222.492) % 360}, 70%, ${this.dark ? 60 : 50}%, ${this.dark ? 0.2 : 0.16})`;
      c.fill();
      const open = Number(id) === asked || (this.model.marked?.ids.includes(Number(id)) ?? false);
      const lit = Number(id) === this.model.lit;
      if (lit) {
        c.fillStyle = this.colors.lit;
        c.fill();
      }
      if (String(id) === String(this.selected) || open || lit) {
        c.lineWidth = (lit ? 5 : 3) / this.scale;
        c.strokeStyle = open ? this.colors.asked : this.colors.robot;
        c.setLineDash(open ? [8 / this.scale, 5 / this.scale] : []);
        c.stroke();
        c.setLineDash([]);
      }
    }
  }

  segment(c, x, y, nx, ny, length) {
    c.beginPath();
    c.moveTo(x + (ny * length) / 2, y - (nx * length) / 2);
    c.lineTo(x - (ny * length) / 2, y + (nx * length) / 2);
    c.stroke();
  }

  drawWalls(c) {
    for (const door of Object.values(this.model.tables.doors)) {
      if (!door.r) continue;
      if (shutBy(this.model, door)) {
        this.drawShut(c, door);
        continue;
      }
      c.lineWidth = (door.st === 2 ? 4 : 2.5) / this.scale;
      c.strokeStyle = door.st === 2 ? this.colors.shut : this.colors.door;
      c.setLineDash(door.st === 2 || this.scale < 25 ? [] : [3 / this.scale, 3 / this.scale]);
      this.segment(c, door.x, door.y, door.nx, door.ny, door.w);
    }
    c.setLineDash([]);
    for (const wall of Object.values(this.model.tables.walls)) {
      if (wall.k === 1) this.bar(c, this.colors.glass, () => this.segment(c, wall.x, wall.y, wall.nx, wall.ny, wall.l));
    }
    for (const wall of plainWalls(this.model)) {
      this.bar(c, wall.v ? this.colors.shut : this.colors.glass, () => {
        c.beginPath();
        c.moveTo(wall.ax, wall.ay);
        c.lineTo(wall.bx, wall.by);
        c.stroke();
      });
    }
  }

  bar(c, color, stroke) {
    c.lineWidth = 7 / this.scale;
    c.strokeStyle = this.colors.halo;
    stroke();
    c.lineWidth = 4 / this.scale;
    c.strokeStyle = color;
    stroke();
  }

  // A door that somebody has shut: a bar with a cross.
  drawShut(c, door) {
    this.bar(c, this.colors.shut, () => this.segment(c, door.x, door.y, door.nx, door.ny, door.w));
    const arm = 6 / this.scale;
    this.bar(c, this.colors.shut, () => {
      c.beginPath();
      for (const sign of [1, -1]) {
        c.moveTo(door.x - arm, door.y - sign * arm);
        c.lineTo(door.x + arm, door.y + sign * arm);
      }
      c.stroke();
    });
  }

  drawWay(c) {
    const way = this.model.values.way ?? [];
    if (way.length < 2) return;
    const path = () => {
      c.beginPath();
      for (const [x, y] of way) c.lineTo(x, y);
      c.stroke();
    };
    c.lineJoin = c.lineCap = "round";
    c.strokeStyle = this.colors.halo;
    c.lineWidth = 8 / this.scale;
    path();
    c.strokeStyle = this.colors.way;
    c.lineWidth = 4.5 / this.scale;
    path();
    const [x, y] = way[way.length - 1];
    c.beginPath();
    c.arc(x, y, 8 / this.scale, 0, 2 * Math.PI);
    c.fillStyle = this.colors.way;
    c.fill();
    c.lineWidth = 2 / this.scale;
    c.strokeStyle = this.colors.halo;
    c.stroke();
  }

  dots(c, points, color, size) {
    c.fillStyle = color;
    c.beginPath();
    for (let i = 0; i + 1 < points.length; i += 2) c.rect(points[i] - size / 2, points[i + 1] - size / 2, size, size);
    c.fill();
  }

  drawSenses(c) {
    const {values} = this.model;
    if (values.particles) {
      this.particlePoints ??= unpack(values.particles, 4);
      this.dots(c, this.particlePoints, this.colors.particle, 4 / this.scale);
    }
    if (values.scan) {
      this.scanPoints ??= unpack(values.scan.p, 2);
      c.save();
      c.translate(values.scan.x, values.scan.y);
      c.rotate(values.scan.a);
      this.dots(c, this.scanPoints, this.colors.scan, 3 / this.scale);
      c.restore();
    }
  }

  drawRobot(c) {
    const pose = this.shown;
    if (!pose) return;
    const [x, y] = this.toScreen(pose.x, pose.y);
    const {spread, status} = this.model.values;
    const lost = status && status.phase !== "sure";
    c.save();
    c.translate(x, y);
    if (spread && spread.l * this.scale > 6) {
      c.save();
      c.rotate(-spread.a);
      c.beginPath();
      c.ellipse(0, 0, Math.min(4000, 2 * spread.l * this.scale), Math.min(4000, Math.max(4, 2 * spread.s * this.scale)), 0, 0, 2 * Math.PI);
      c.globalAlpha = 0.18;
      c.fillStyle = this.colors.robot;
      c.fill();
      c.globalAlpha = 0.8;
      c.strokeStyle = this.colors.robot;
      c.lineWidth = 1.2;
      c.stroke();
      c.restore();
    }
    c.rotate(-pose.a);
    const r = Math.max(10, 0.25 * this.scale);
    c.beginPath();
    c.moveTo(r * 1.75, 0);
    c.lineTo(r * 0.6, r * 0.85);
    c.lineTo(r * 0.6, -r * 0.85);
    c.closePath();
    c.fillStyle = this.colors.robot;
    c.strokeStyle = this.colors.edge;
    c.lineWidth = 2;
    c.stroke();
    c.fill();
    c.beginPath();
    c.arc(0, 0, r, 0, 2 * Math.PI);
    c.stroke();
    c.fill();
    c.rotate(pose.a);
    if (lost) {
      c.font = `700 ${Math.round(r * 1.3)}px system-ui, sans-serif`;
      c.textAlign = "center";
      c.textBaseline = "middle";
      c.fillStyle = this.colors.edge;
      c.fillText("?", 0, 1);
    }
    c.restore();
  }

  drawTool(c) {
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    if (this.keys) {
      c.strokeStyle = this.colors.text;
      c.lineWidth = 2;
      c.beginPath();
      c.moveTo(width / 2 - 12, height / 2);
      c.lineTo(width / 2 + 12, height / 2);
      c.moveTo(width / 2, height / 2 - 12);
      c.lineTo(width / 2, height / 2 + 12);
      c.stroke();
    }
    if (!this.tool?.from) return;
    const [ax, ay] = this.toScreen(...this.tool.from);
    const [bx, by] = this.toScreen(...this.tool.to);
    c.strokeStyle = c.fillStyle = this.tool.kind === "wall" ? this.colors.glass : this.colors.robot;
    c.lineWidth = 5;
    c.lineCap = "round";
    c.beginPath();
    c.moveTo(ax, ay);
    c.lineTo(bx, by);
    c.stroke();
    if (this.tool.kind === "pose") {
      const angle = Math.atan2(by - ay, bx - ax);
      c.beginPath();
      c.moveTo(bx + 12 * Math.cos(angle), by + 12 * Math.sin(angle));
      c.lineTo(bx + 14 * Math.cos(angle + 2.3), by + 14 * Math.sin(angle + 2.3));
      c.lineTo(bx + 14 * Math.cos(angle - 2.3), by + 14 * Math.sin(angle - 2.3));
      c.fill();
      c.beginPath();
      c.arc(ax, ay, 12, 0, 2 * Math.PI);
      c.fill();
    }
  }
}
