// What the page knows, as the server tells it: values, tables, the talk, and the tiles of the map.
import {t} from "./i18n.js";
import {folded} from "./wording.js";

const ARTICLE = /^(?:(?:the|os|as) |[oa] (?=\p{L}{3}))/u; // "A 5" is a number of a room
const ROOM = /^(?:room|sala) (?=\S*\d|\S{1,2}$)/u; // before its number or letter

// A name without what some say or write and others do not: "the kitchen", "room 5", accents.
function bare(name) {
  return folded(name).trim().replace(/\s+/g, " ").replace(ARTICLE, "").replace(ROOM, "");
}

export class Model {
  constructor() {
    this.listeners = new Map();
    this.tiles = new Map(); // "column,row": {column, row, version, picture}
    this.overview = null; // {column, row, picture}: all tiles coarsely, until they are here
    this.clear();
  }

  clear() {
    this.version = 0;
    this.values = {};
    this.tables = {places: {}, doors: {}, walls: {}, told: {}, objects: {}, layers: {}};
    this.talk = [];
  }

  // listener(names): some of these channels have changed.
  on(names, listener) {
    for (const name of names) {
      if (!this.listeners.has(name)) this.listeners.set(name, new Set());
      this.listeners.get(name).add(listener);
    }
  }

  tell(names) {
    const called = new Set();
    for (const name of names) for (const listener of this.listeners.get(name) ?? []) called.add(listener);
    for (const listener of called) listener(names);
  }

  apply(message, quiet = false) {
    const changed = new Set(Object.keys(message.d));
    if (message.full) {
      for (const name of [...Object.keys(this.values), ...Object.keys(this.tables), "talk"]) changed.add(name);
      this.clear();
    }
    this.version = message.v ?? this.version;
    for (const [name, change] of Object.entries(message.d)) {
      if (name === "talk") {
        const last = this.talk.length ? this.talk[this.talk.length - 1].i : -1;
        this.talk.push(...change.filter((entry) => entry.i > last));
        if (this.talk.length > 300) this.talk.splice(0, this.talk.length - 300);
      } else if (name in this.tables) {
        for (const key of change["-"] ?? []) delete this.tables[name][key];
        Object.assign(this.tables[name], change["+"] ?? {});
      } else {
        this.values[name] = change;
      }
    }
    if (!quiet) this.tell([...changed]);
  }

  // A picture of null: nothing is known there any more.
  setTile(column, row, version, picture) {
    const key = `${column},${row}`;
    if (picture === null) this.tiles.delete(key);
    else this.tiles.set(key, {column, row, version, picture});
  }

  // All tiles that the server has are here: it adds the numbers of their changes.
  get complete() {
    let sum = 0;
    for (const tile of this.tiles.values()) sum = (sum + tile.version) % 2 ** 32;
    return !this.values.map || this.values.map.sum === sum;
  }

  place(id) {
    return this.tables.places[id];
  }

  // The name of a place: text, whether a person has confirmed it.
  nameOf(id) {
    const place = this.place(id);
    if (!place) return {text: String(id), sure: false, none: true};
    const confirmed = place.n.find((word) => word[1]);
    const word = confirmed ?? place.n[0];
    return word ? {text: word[0], sure: Boolean(confirmed), none: false} : {text: t("place_number", {n: id}), sure: false, none: true};
  }

  labelOf(id) {
    const name = this.nameOf(id);
    return name.text + (name.sure || name.none ? "" : "?");
  }

  // As a heading, or on a button.
  titleOf(id) {
    return this.nameOf(id).none ? t("place_of", {n: id}) : this.labelOf(id);
  }

  confirmedNames(id) {
    return (this.place(id)?.n ?? []).filter((word) => word[1]).map((word) => word[0]);
  }

  // The place where a person has confirmed a name, but for one, and for those beside that, which may share it; null: none.
  holderOf(name, but) {
    const wanted = bare(name);
    const beside = [String(but), ...this.neighbours(but).map(String)];
    return Object.keys(this.tables.places).find((id) => !beside.includes(id) && this.confirmedNames(id).some((each) => bare(each) === wanted)) ?? null;
  }

  neighbours(id) {
    const found = new Set();
    for (const door of Object.values(this.tables.doors)) {
      if (door.a === Number(id)) found.add(door.b);
      if (door.b === Number(id)) found.add(door.a);
    }
    return [...found].filter((each) => this.place(each));
  }

  // The smallest place whose outline holds a point; its id, or null.
  placeAt(x, y) {
    let best = null;
    for (const [id, place] of Object.entries(this.tables.places)) {
      if (place.o && inside(place.o, x, y) && (best === null || place.s < this.place(best).s)) best = id;
    }
    return best;
  }
}

export function inside(outline, x, y) {
  let odd = false;
  for (let i = 0, j = outline.length - 2; i < outline.length; j = i, i += 2) {
    const [ax, ay, bx, by] = [outline[i], outline[i + 1], outline[j], outline[j + 1]];
    if (ay > y !== by > y && x < ax + ((y - ay) * (bx - ax)) / (by - ay)) odd = !odd;
  }
  return odd;
}

// Points in base64: little-endian whole numbers of centimetres; [x, y, x, y, ...] in metres.
export function unpack(text, bytes) {
  const raw = atob(text);
  const view = new DataView(new ArrayBuffer(raw.length));
  for (let i = 0; i < raw.length; ++i) view.setUint8(i, raw.charCodeAt(i));
  const points = new Float32Array(raw.length / bytes);
  for (let i = 0; i < points.length; ++i) {
    points[i] = (bytes === 2 ? view.getInt16(2 * i, true) : view.getInt32(4 * i, true)) / 100;
  }
  return points;
}
