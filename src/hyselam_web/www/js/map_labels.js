// The names of the places on the map. Where there is no room for a name there is a number, or a dot: no place stays unseen.
import {inside} from "./model.js";

const NEAR = 22; // [pixels] from a number or a dot to the finger that means it
const EXACT = 12; // [pixels] within which it is meant, also in another place
const DOT = 4.5; // [pixels], radius
const SPARE = 6; // [pixels] around the middle of each place that names of others leave free for its dot

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
    this.kept = new Map(); // id: how its name was written last; it stays so where it can
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
      const pointed = [view.selected, view.hovered].some((each) => String(each) === id);
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
    const taken = this.robotBox();
    const kept = this.kept;
    this.kept = new Map();
    this.shown = new Map();
    c.textAlign = "center";
    c.textBaseline = "middle";
    for (const each of wanted) {
      const others = middles.filter(([id]) => id !== each.id && !this.shown.has(id)).map(([, box]) => box);
      const fits = (box) => ![...taken, ...others].some((other) => meets(box, other));
      const size = (each.small ? 11 : 14) - (view.scale < 12 ? 2 : 0);
      const done = this.name(c, each, size, fits, kept.get(each.id)) ?? this.dot(c, each);
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
    const wide = Math.max(...lines.map((line) => this.widthOf(c, this.fontOf(each, size), line))) + 6;
    const high = lines.length * (size + 2) + 2;
    const width = this.view.canvas.clientWidth;
    const x = each.x >= 0 && each.x <= width ? Math.max(wide / 2, Math.min(width - wide / 2, each.x + dx)) : each.x + dx;
    const y = each.y + dy;
    return [x - wide / 2, y - high / 2, x + wide / 2, y + high / 2];
  }

  isWithin({place}, [left, top, right, bottom]) {
    if (!place.o) return false;
    const rim = 3; // of which the letters have no need
    const [l, m, r] = [left + rim, (left + right) / 2, right - rim];
    return [[l, top + rim], [m, top + rim], [r, top + rim], [l, bottom - rim], [m, bottom - rim], [r, bottom - rim]]
      .every(([x, y]) => inside(place.o, ...this.view.toMap(x, y)));
  }

  // Written as before where that has room; else within its place, on more lines or smaller; else across its walls, a little higher or
  // lower. What is pointed at is named in any case. null: there is no room.
  name(c, each, size, fits, before) {
    const {view} = this;
    const {id, place, text, small, rank} = each;
    const sizes = small ? [size] : [size, size - 2, Math.max(10, size - 4)];
    const room = (first) => {
      const all = (place.o ?? []).filter((_, i) => i % 2 === first).map((at) => at * view.scale);
      return all.length ? Math.max(...all) - Math.min(...all) : 0;
    };
    const [wide, high] = [room(0), room(1)];
    const steps = [0, 0.15, -0.15, 0.3, -0.3, 0.42, -0.42];
    const tried = (ways, dys, dxs, is_good, of_sizes = sizes) => {
      for (const own of of_sizes) {
        for (const lines of ways) {
          for (const dx of dxs) {
            for (const dy of dys(lines, own)) {
              const how = {lines, size: own, dx, dy};
              const box = this.boxOf(c, each, how);
              if (is_good(box)) return {how, box};
            }
          }
        }
      }
      return null;
    };
    const same = before && before.text === text && before.scale === view.scale && sizes.includes(before.how.size) ? {how: before.how, box: this.boxOf(c, each, before.how)} : null;
    const ways = small ? [[text]] : waysToWrite(text);
    const done = (same && fits(same.box) ? same : null)
      ?? (small ? null : tried(ways, () => steps.map((share) => share * high), steps.map((share) => share * wide), (box) => this.isWithin(each, box) && fits(box)))
      ?? tried([small ? [text] : wrapped(text)], (lines, own) => [0, 0.5, -0.5, 1, -1].map((share) => share * Math.min(high / 2, 1.6 * lines.length * (own + 2))), [0], fits, sizes.slice(-2))
      ?? (rank < 2 ? tried([wrapped(text)], () => [0], [0], () => true) : null);
    if (!done) return null;
    this.kept.set(id, {text, scale: view.scale, how: done.how});
    const {box, how: {lines, size: own}} = done;
    const [x, y] = [(box[0] + box[2]) / 2, (box[1] + box[3]) / 2];
    c.font = this.fontOf(each, own);
    lines.forEach((line, i) => haloed(c, line, x, y + (i - (lines.length - 1) / 2) * (own + 2), each.color, view.colors.halo));
    return {kind: small ? "number" : "name", x, y, box};
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
