// The names of the places on the map, each within its place: on one line or more, smaller, or cut. Where not even that has room there is its
// number, or a dot: no place stays unseen.
import {inside} from "./model.js";

const NEAR = 22; // [pixels] from a number or a dot to the finger that means it
const EXACT = 12; // [pixels] within which it is meant, also in another place
const DOT = 4.5; // [pixels], radius
const SPARE = 6; // [pixels] around the middle of each place that names of others leave free for its dot
const SMALLEST = 9; // [pixels], letters
const CUTS = [0.8, 0.65, 0.5, 0.35]; // shares of a name that are left where all of it has no room,
const FEW_LETTERS = [6, 5, 4, 3, 2]; // and letters, where not even these have
const RIM = 1; // [pixels] of a name's box that may lie on the walls of its place
const SPOTS = [0, 0.12, -0.12, 0.24, -0.24, 0.36, -0.36, 0.44, -0.44]; // of the room's width and height, where a name may stand
const DOOR_RIM = 3; // [pixels] on both sides of a door

// A name in lines of so many letters, up to three.
export function wrapped(text, most = 11) {
  const lines = [""];
  for (const word of text.split(" ")) {
    const last = lines[lines.length - 1];
    if (last && last.length + 1 + word.length > most) lines.push(word);
    else lines[lines.length - 1] = last ? `${last} ${word}` : word;
  }
  const cut = lines.slice(0, 3).map((line) => (line.length > 18 ? line.slice(0, 17) + "…" : line));
  if (lines.length > 3) cut[2] = cut[2].slice(0, 16) + "…";
  return cut;
}

// The ways to write a name, the shortest ones first: in one line, in two as long as each other, in one for each word.
function waysToWrite(text) {
  const longest = Math.max(...text.split(" ").map((word) => word.length));
  const ways = [18, 11, Math.ceil(text.length / 2) + 1, longest].map((most) => wrapped(text, Math.max(most, longest)));
  const different = new Map(ways.map((lines) => [lines.join("\n"), lines]));
  return [...different.values()].sort((a, b) => a.length - b.length);
}

export function haloed(c, text, x, y, color, halo) {
  c.lineWidth = 3.5;
  c.lineJoin = "round";
  c.strokeStyle = halo;
  c.strokeText(text, x, y);
  c.fillStyle = color;
  c.fillText(text, x, y);
}

function meets(a, b) {
  return a[0] < b[2] && a[2] > b[0] && a[1] < b[3] && a[3] > b[1];
}

export class MapLabels {
  constructor(view) {
    this.view = view;
    this.shown = new Map(); // id: {kind: "name", "number" or "dot", x, y, box}
    this.widths = new Map(); // of lines, by their fonts
    this.kept = new Map(); // id: how its name was written last; it stays so where it can, until the best spot is free
    this.best = new Map(); // "id small": where its name, or its number, would be if nothing moved: {key, place, how}
  }

  // What is to be named, the most important first: what is asked about or pointed at, confirmed names, guesses, the rest.
  wanted() {
    const {view} = this;
    const {model, colors} = view;
    const [width, height] = [view.canvas.clientWidth, view.canvas.clientHeight];
    const found = [];
    for (const [id, place] of Object.entries(model.tables.places)) {
      if (!place.c) continue;
      const [x, y] = view.toScreen(...place.c);
      if (x < -80 || y < -40 || x > width + 80 || y > height + 40) continue;
      const name = model.nameOf(id);
      const asked = Number(id) === model.values.asked?.place;
      const pointed = [view.selected, view.hovered, model.lit].some((each) => String(each) === id);
      const marked = model.marked?.ids.includes(Number(id)) ?? false;
      const rank = asked ? 0 : pointed ? 1 : marked ? 2 : name.sure ? 3 : name.none ? 5 : 4;
      const number = !pointed && !asked && (name.none || marked); // as on the buttons
      const text = number ? id : !name.none ? model.labelOf(id) : asked ? "?" : model.titleOf(id);
      found.push({id, place, x, y, rank, text, small: number || (asked && name.none), weight: marked || name.sure ? "600 " : name.none ? "" : "italic 500 ",
        color: asked || marked ? colors.asked : name.none ? colors.soft : colors.text});
    }
    return found.sort((a, b) => a.rank - b.rank || b.place.s - a.place.s);
  }

  draw(c) {
    const {view} = this;
    const wanted = this.wanted();
    const middles = wanted.map(({id, x, y}) => [id, [x - SPARE, y - SPARE, x + SPARE, y + SPARE]]);
    const [taken, robot] = [[], this.robotBox()];
    this.doors = this.doorBoxes();
    const kept = this.kept;
    this.kept = new Map();
    this.shown = new Map();
    c.textAlign = "center";
    c.textBaseline = "middle";
    for (const each of wanted) {
      const others = middles.filter(([id]) => id !== each.id && !this.shown.has(id)).map(([, box]) => box);
      const free = (box, without = []) => ![...taken, ...without, ...others].some((other) => meets(box, other));
      const size = (each.small ? 11 : 14) - (view.scale < 12 ? 2 : 0);
      const done = this.name(c, each, size, free, robot, kept.get(each.id)) ?? this.number(c, each, free, robot) ?? this.dot(c, each);
      taken.push(done.box);
      this.shown.set(each.id, done);
    }
  }

  // What the robot's picture covers.
  robotBox() {
    const pose = this.view.shown;
    if (!pose) return [];
    const [x, y] = this.view.toScreen(pose.x, pose.y);
    const r = 1.3 * Math.max(10, 0.25 * this.view.scale);
    return [[x - r, y - r, x + r, y + r]];
  }

  fontOf({weight}, size) {
    return `${weight}${size}px system-ui, "Liberation Sans", sans-serif`;
  }

  widthOf(c, font, line) {
    const key = `${font} ${line}`;
    if (!this.widths.has(key)) {
      if (this.widths.size > 2000) this.widths.clear();
      c.font = font;
      this.widths.set(key, c.measureText(line).width);
    }
    return this.widths.get(key);
  }

  // The box of some lines, so far from the middle of their place [pixels]; not cut off by the edge of the screen.
  boxOf(c, each, {lines, size, dx, dy}) {
    const wide = Math.max(...lines.map((line) => this.widthOf(c, this.fontOf(each, size), line))) + 4;
    const high = lines.length * (size + 2) + 2;
    const width = this.view.canvas.clientWidth;
    const x = each.x >= 0 && each.x <= width ? Math.max(wide / 2, Math.min(width - wide / 2, each.x + dx)) : each.x + dx;
    const y = each.y + dy;
    return [x - wide / 2, y - high / 2, x + wide / 2, y + high / 2];
  }

  // Inside its place, and in no door.
  isWithin({id, place}, [left, top, right, bottom]) {
    if (!place.o) return false;
    const [l, r, t, b] = [left + RIM, right - RIM, top + RIM, bottom - RIM];
    const along = (from, to, n) => Array.from({length: n + 1}, (_, i) => from + ((to - from) * i) / n);
    return along(l, r, 4).every((x) => along(t, b, 2).every((y) => inside(place.o, ...this.view.toMap(x, y))))
      && !(this.doors.get(id) ?? []).some((door) => meets([left, top, right, bottom], door));
  }

  // Of all places, on the screen as it is drawn now.
  doorBoxes() {
    const boxes = new Map();
    for (const door of Object.values(this.view.model.tables.doors)) {
      if (!door.r) continue;
      const [x, y] = this.view.toScreen(door.x, door.y);
      const half = (door.w / 2) * this.view.scale;
      const [dx, dy] = [Math.abs(door.ny) * half + DOOR_RIM, Math.abs(door.nx) * half + DOOR_RIM];
      for (const id of [door.a, door.b]) boxes.set(String(id), [...(boxes.get(String(id)) ?? []), [x - dx, y - dy, x + dx, y + dy]]);
    }
    return boxes;
  }

  // How a name is written, the best way first: whole, the larger the better; then cut.
  *ways(text, small, size) {
    if (small) {
      yield {lines: [text], size};
      return;
    }
    const sizes = [...new Set([size, size - 2, size - 4, SMALLEST].map((each) => Math.max(SMALLEST, each)))];
    const all = waysToWrite(text);
    const isWhole = (lines) => !lines.some((line) => line.endsWith("…"));
    for (const own of sizes) for (const lines of all) if (isWhole(lines)) yield {lines, size: own};
    for (const own of sizes) for (const lines of all) if (!isWhole(lines)) yield {lines, size: own};
    const letters = [...text];
    for (const many of [...CUTS.map((share) => Math.round(share * letters.length)).filter((many) => many > FEW_LETTERS[0]), ...FEW_LETTERS.filter((many) => many < letters.length)]) {
      for (const lines of waysToWrite(letters.slice(0, many).join("").trimEnd() + "…")) yield {lines, size: SMALLEST};
    }
  }

  // The first way and spot within its place that is good; null: there is none.
  find(c, each, size, is_good) {
    const {view} = this;
    const [wide, high] = [0, 1].map((first) => {
      const all = (each.place.o ?? []).filter((_, i) => i % 2 === first).map((at) => at * view.scale);
      return all.length ? Math.max(...all) - Math.min(...all) : 0;
    });
    for (const way of this.ways(each.text, each.small, size)) {
      const [left, top, right, bottom] = this.boxOf(c, each, {...way, dx: 0, dy: 0});
      if (right - left > wide + 2 * RIM || bottom - top > high + 2 * RIM) continue;
      for (const across of SPOTS) {
        for (const up of SPOTS) {
          const how = {...way, dx: across * wide, dy: up * high};
          const box = this.boxOf(c, each, how);
          if (is_good(box)) return how;
        }
      }
    }
    return null;
  }

  // Where it would be if nothing moved.
  bestOf(c, each, size) {
    const {view} = this;
    const middle = Math.abs(each.x - view.canvas.clientWidth / 2) < view.canvas.clientWidth / 2;
    const key = JSON.stringify([each.text, each.weight, size, view.scale, middle ? 0 : each.x, this.doors.get(each.id)?.length]);
    const slot = `${each.id} ${each.small}`;
    const known = this.best.get(slot);
    if (known?.key === key && known.place === each.place && (!known.how || this.isWithin(each, this.boxOf(c, each, known.how)))) return known.how;
    const how = this.find(c, each, size, (box) => this.isWithin(each, box));
    this.best.set(slot, {key, place: each.place, how});
    return how;
  }

  // At its best spot where nothing is in the way; else as before; else elsewhere in its place; below the robot before nowhere. What is pointed
  // at or asked about is there in any case. null: there is no room.
  name(c, each, size, free, robot, before) {
    const {id, text, small, rank, place} = each;
    const best = this.bestOf(c, each, size);
    const fits = (how) => how && free(this.boxOf(c, each, how), robot);
    const same = before && before.text === text && before.scale === this.view.scale && before.how.size <= size && this.isWithin(each, this.boxOf(c, each, before.how)) ? before.how : null;
    const anyhow = {lines: small ? [text] : wrapped(text), size: small ? size : Math.max(SMALLEST, size - 4), dx: 0, dy: 0};
    const how = (fits(best) ? best : null)
      ?? (fits(same) ? same : null)
      ?? (best ? this.find(c, each, size, (box) => this.isWithin(each, box) && free(box, robot)) : null)
      ?? (best && free(this.boxOf(c, each, best)) ? best : null)
      ?? ((small || !place.o) && fits(anyhow) ? anyhow : null)
      ?? (rank < (small ? 3 : 2) ? anyhow : null);
    if (!how) return null;
    this.kept.set(id, {text, scale: this.view.scale, how});
    const box = this.boxOf(c, each, how);
    const {lines, size: own} = how;
    const [x, y] = [(box[0] + box[2]) / 2, (box[1] + box[3]) / 2];
    c.font = this.fontOf(each, own);
    lines.forEach((line, i) => haloed(c, line, x, y + (i - (lines.length - 1) / 2) * (own + 2), each.color, this.view.colors.halo));
    return {kind: small ? "number" : "name", x, y, box, lines};
  }

  // Instead of a name that has no room.
  number(c, each, free, robot) {
    return each.small ? null : this.name(c, {...each, text: each.id, small: true, rank: 9}, SMALLEST, free, robot, null);
  }

  dot(c, {x, y, color}) {
    c.beginPath();
    c.arc(x, y, DOT, 0, 2 * Math.PI);
    c.fillStyle = color;
    c.fill();
    c.lineWidth = 2;
    c.strokeStyle = this.view.colors.halo;
    c.stroke();
    return {kind: "dot", x, y, box: [x - SPARE, y - SPARE, x + SPARE, y + SPARE]};
  }

  // The place that a finger there means: by its dot or number, by its outline, by what is nearest; null: none.
  placeAt(px, py) {
    let [nearest, distance] = [null, NEAR];
    for (const [id, {kind, x, y}] of this.shown) {
      const far = Math.hypot(x - px, y - py);
      if (kind !== "name" && far < distance) [nearest, distance] = [id, far];
    }
    if (nearest !== null && distance < EXACT) return nearest;
    return this.view.model.placeAt(...this.view.toMap(px, py)) ?? nearest;
  }
}
