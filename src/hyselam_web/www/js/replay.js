// A recorded day instead of the robot: the same page with a slider for the time.
import {byId} from "./dom.js";
import {t} from "./i18n.js";

const KEEP = 200; // entries between two states that are kept, to go back quickly

export class Replay {
  // onTime(text): the time of the day that is shown has changed.
  constructor(model, entries, onTiles, onTime) {
    Object.assign(this, {model, entries, onTiles, onTime});
    this.replays = true;
    this.at = -1;
    this.playing = false;
    this.begin = entries.length ? entries[0].t : 0;
    this.end = entries.reduce((latest, entry) => Math.max(latest, entry.t), this.begin);
    this.slider = byId("time");
    this.slider.max = String(Math.max(1, Math.round(this.end - this.begin)));
    // Its steps are whole seconds; the last one is the end, however long that second is.
    this.slider.addEventListener("input", () => this.goTo(this.slider.value === this.slider.max ? this.end : this.begin + Number(this.slider.value)));
    byId("play").onclick = () => this.play(!this.playing);
    this.now = this.begin;
    this.states = new Map();
  }

  // Nothing can be asked for here.
  ask() {
    return Promise.reject({code: "not_allowed", reason: ""});
  }

  showButton() {
    const play = byId("play");
    play.classList.toggle("playing", this.playing);
    play.dataset.label = this.playing ? "pause" : "play"; // kept, for when the language changes
    play.title = t(play.dataset.label);
    play.setAttribute("aria-label", play.title);
  }

  play(on) {
    if (on && this.now >= this.end) this.goTo(this.begin);
    this.playing = on;
    this.showButton();
    if (!on) return;
    let last = performance.now();
    const step = (time) => {
      if (!this.playing) return;
      const speed = Number(byId("speed").value);
      this.goTo(Math.min(this.end, this.now + (speed * Math.min(200, time - last)) / 1000));
      last = time;
      if (this.now >= this.end) this.play(false);
      else requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  // The last entry at or before a time; stamps of a bag that starts again do not matter, the order of the entries does.
  indexAt(time) {
    let found = 0;
    for (let i = 0; i < this.entries.length; ++i) {
      if (this.entries[i].t <= time + 0.001) found = i;
    }
    return found;
  }

  goTo(time) {
    this.now = time;
    const wanted = this.indexAt(time);
    let names = new Set();
    if (wanted < this.at) {
      let from = -1;
      for (const index of this.states.keys()) if (index <= wanted && index > from) from = index;
      names = new Set([...Object.keys(this.model.values), ...Object.keys(this.model.tables), "talk"]);
      this.restore(from);
    }
    let tiles = false;
    while (this.at < wanted) {
      this.at += 1;
      const entry = this.entries[this.at];
      this.model.apply({d: entry.d, full: entry.full}, true);
      for (const name of Object.keys(entry.d)) names.add(name);
      for (const [column, row, picture] of entry.tiles ?? []) {
        tiles = true;
        this.model.setTile(column, row, this.at, picture ? blobOf(picture) : null);
      }
      if (this.at % KEEP === 0 && !this.states.has(this.at)) this.states.set(this.at, this.snapshot());
    }
    if (names.size) this.model.tell([...names]);
    if (tiles || names.has("map")) this.onTiles();
    const seconds = Math.round(time - this.begin);
    this.slider.value = String(seconds);
    const text = minutes(seconds);
    byId("clock").textContent = `${text} / ${minutes(Math.round(this.end - this.begin))}`;
    this.slider.setAttribute("aria-valuetext", text);
    this.onTime(text);
  }

  snapshot() {
    const {values, tables, talk, tiles} = this.model;
    const copies = Object.fromEntries(Object.entries(tables).map(([name, table]) => [name, {...table}]));
    return {values: {...values}, tables: copies, talk: [...talk], tiles: new Map(tiles)};
  }

  restore(index) {
    this.model.clear();
    this.model.tiles.clear();
    this.at = index;
    const state = this.states.get(index);
    if (!state) {
      this.at = -1;
      return;
    }
    this.model.values = {...state.values};
    for (const [name, table] of Object.entries(state.tables)) this.model.tables[name] = {...table};
    this.model.talk = [...state.talk];
    for (const [key, tile] of state.tiles) this.model.tiles.set(key, tile);
  }
}

function minutes(seconds) {
  return `${Math.floor(seconds / 60)}:${String(seconds % 60).padStart(2, "0")}`;
}

function blobOf(base64) {
  const raw = atob(base64);
  const bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; ++i) bytes[i] = raw.charCodeAt(i);
  return new Blob([bytes], {type: "image/png"});
}

// The entries of a recording as the server keeps it; a last line that is cut off is left out.
export function entriesOf(text) {
  const entries = [];
  for (const line of text.split("\n").slice(1)) {
    try {
      if (line) entries.push(JSON.parse(line));
    } catch { /* being written */ }
  }
  return entries;
}
