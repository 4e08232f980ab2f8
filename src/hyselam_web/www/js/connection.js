// The server: what it tells goes into the model, what the page asks for goes there. A lost connection is shown and made again.
import {currentLanguage} from "./i18n.js";

const QUIET = 13000; // [ms] without a word, though the server speaks every five seconds
const ANSWER = 45000; // [ms] for what was asked for
const SLOWEST = 8000; // [ms] between two tries
const IN_ALL = -(2 ** 31); // column of the frame of the coarse picture

export class Connection {
  // events: onState(connected), onSession(session), onTiles()
  constructor(model, events) {
    this.model = model;
    this.events = events;
    this.socket = null;
    this.connected = false;
    this.run = "";
    this.waiting = new Map(); // number: {resolve, reject, timer}
    this.next = 1;
    this.tries = 0;
    this.heard = 0;
    document.addEventListener("visibilitychange", () => this.hide(document.hidden));
    addEventListener("online", () => this.retrySoon(0));
    setInterval(() => this.watch(), 1000);
  }

  // Who this page is for the server; then the talk with it.
  async start() {
    clearTimeout(this.timer);
    const number = (this.starting = (this.starting ?? 0) + 1);
    try {
      const answer = await fetch("session", {cache: "no-store", signal: AbortSignal.timeout(6000)});
      if (!answer.ok) throw new Error(String(answer.status));
      const session = await answer.json();
      if (number !== this.starting) return;
      this.events.onSession(session);
      this.open(session);
    } catch {
      if (number === this.starting) this.lost();
    }
  }

  open(session) {
    this.close();
    const goes_on = session.run === this.run && this.model.complete && this.model.version > 0;
    if (!goes_on) {
      this.model.tiles.clear();
      this.model.overview = null;
    }
    const query = goes_on ? `?run=${session.run}&since=${this.model.version}` : "";
    const address = new URL("ws" + query, location.href);
    address.protocol = address.protocol === "https:" ? "wss:" : "ws:";
    const socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this.heard = Date.now();
      this.tries = 0;
      this.connected = true;
      this.events.onState(true);
      if (document.hidden) this.hide(true);
    };
    socket.onmessage = (event) => this.receive(event.data);
    socket.onclose = () => {
      if (socket === this.socket) this.lost();
    };
    this.socket = socket;
  }

  close() {
    const old = this.socket;
    this.socket = null;
    this.connected = false;
    if (old) old.close();
    for (const each of this.waiting.values()) each.reject({code: "not_connected", reason: ""});
    this.waiting.clear();
  }

  lost() {
    this.close();
    this.events.onState(false);
    this.tries += 1;
    this.retrySoon(Math.min(SLOWEST, 400 * 1.7 ** this.tries) * (0.7 + 0.6 * Math.random()));
  }

  retrySoon(after) {
    if (this.connected) return;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.start(), after);
  }

  watch() {
    if (this.connected && !document.hidden && this.allowed && Date.now() - this.heard > QUIET) this.lost();
  }

  receive(data) {
    this.heard = Date.now();
    if (data instanceof ArrayBuffer) {
      const view = new DataView(data);
      if (view.getInt32(0, true) === IN_ALL) {
        this.model.overview = {column: view.getInt32(12, true), row: view.getInt32(16, true), picture: new Blob([new Uint8Array(data, 20)], {type: "image/png"})};
        this.events.onTiles();
        return;
      }
      const picture = data.byteLength > 12 ? new Blob([new Uint8Array(data, 12)], {type: "image/png"}) : null;
      this.model.setTile(view.getInt32(0, true), view.getInt32(4, true), view.getUint32(8, true), picture);
      this.events.onTiles();
      return;
    }
    const message = JSON.parse(data);
    if (message.d) {
      this.run = message.run;
      this.model.apply(message);
    } else if (message.n !== undefined || message.error) {
      const waits = this.waiting.get(message.n);
      if (!waits) return;
      this.waiting.delete(message.n);
      clearTimeout(waits.timer);
      if (message.error) waits.reject({code: message.error, reason: message.reason});
      else waits.resolve(message.result ?? {});
    }
  }

  // A promise of the answer; it fails with {code, reason}.
  ask(what, fields = {}, patience = ANSWER) {
    if (what !== "try") this.asked = performance.now(); // by a person, here
    return new Promise((resolve, reject) => {
      if (!this.connected || this.socket.readyState !== WebSocket.OPEN) {
        reject({code: "not_connected", reason: ""});
        return;
      }
      const number = this.next++;
      const timer = setTimeout(() => {
        this.waiting.delete(number);
        reject({code: "no_answer", reason: ""});
      }, patience);
      this.waiting.set(number, {resolve, reject, timer});
      this.socket.send(JSON.stringify({do: what, n: number, ...fields}));
    });
  }

  hide(on) {
    this.heard = Date.now();
    if (this.connected && this.allowed) this.ask("hide", {on}, 1).catch(() => {});
    if (!on && !this.connected) this.retrySoon(0);
  }

  // By the open connection; where that does not answer at once, by a request of its own. "sent", "unheard", or "failed".
  async stop() {
    try {
      const {heard} = await this.ask("stop", {language: currentLanguage()}, 700);
      return heard === 0 ? "unheard" : "sent";
    } catch {
      return postStop();
    }
  }
}

// Needs neither a login nor an open connection.
export async function postStop() {
  try {
    const answer = await fetch(`stop?language=${currentLanguage()}`, {method: "POST", keepalive: true, signal: AbortSignal.timeout(4000)});
    if (!answer.ok) return "failed";
    return (await answer.json()).heard === 0 ? "unheard" : "sent";
  } catch {
    return "failed";
  }
}
