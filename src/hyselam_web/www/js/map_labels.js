// The names of the places on the map. Where there is no room for a name there is a number, or a dot: no place stays unseen.
const NEAR = 22; // [pixels] from a number or a dot to the finger that means it
const EXACT = 12; // [pixels] within which it is meant, also in another place
const DOT = 4.5; // [pixels], radius
const SPARE = 6; // [pixels] around the middle of each place that names of others leave free for its dot

// A name in up to three lines.
export function wrapped(text) {
  if (text.length <= 11) return [text];
  const lines = [""];
  for (const word of text.split(" ")) {
    const last = lines[lines.length - 1];
    if (last && last.length + 1 + word.length > 11) lines.push(word);
    else lines[lines.length - 1] = last ? `${last} ${word}` : word;
  }
  const cut = lines.slice(0, 3).map((line) => (line.length > 18 ? line.slice(0, 17) + "…" : line));
  if (lines.length > 3) cut[2] = cut[2].slice(0, 16) + "…";
  return cut;
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
    const taken = [];
    this.shown = new Map();
    c.textAlign = "center";
    c.textBaseline = "middle";
    for (const each of wanted) {
      const others = middles.filter(([id]) => id !== each.id && !this.shown.has(id)).map(([, box]) => box);
      const fits = (box) => ![...taken, ...others].some((other) => meets(box, other));
      const size = (each.small ? 11 : 14) - (view.scale < 12 ? 2 : 0);
      // What is pointed at is named in any case.
      const done = this.name(c, each, size, fits) ?? (each.small ? null : this.name(c, each, size - 3, fits)) ?? (each.rank < 2 ? this.name(c, each, size, () => true) : null) ?? this.dot(c, each);
      taken.push(done.box);
      this.shown.set(each.id, done);
    }
  }

  // A little higher or lower in its place, where another name is in the way; null: there is no room.
  name(c, {place, x, y, text, small, weight, color}, size, fits) {
    const {view} = this;
    c.font = `${weight}${size}px system-ui, "Liberation Sans", sans-serif`;
    const lines = wrapped(text);
    const wide = Math.max(...lines.map((line) => c.measureText(line).width)) + 6;
    const high = lines.length * (size + 2) + 2;
    const width = view.canvas.clientWidth;
    if (x >= 0 && x <= width) x = Math.max(wide / 2, Math.min(width - wide / 2, x)); // not cut off by the edge
    const ys = (place.o ?? []).filter((_, i) => i % 2);
    const room = ys.length ? Math.max(0, (Math.max(...ys) - Math.min(...ys)) * view.scale * 0.5 - high / 2) : 0;
    for (const share of [0, 0.5, -0.5, 1, -1]) {
      const at = y + share * Math.min(room, 1.6 * high);
      const box = [x - wide / 2, at - high / 2, x + wide / 2, at + high / 2];
      if (!fits(box)) continue;
      lines.forEach((line, i) => haloed(c, line, x, at + (i - (lines.length - 1) / 2) * (size + 2), color, view.colors.halo));
      return {kind: small ? "number" : "name", x, y: at, box};
    }
    return null;
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
