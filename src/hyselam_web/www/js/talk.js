// The talk: what was said, what the robot answered, undo, yes and no, suggestions.
import {byId, make, button, toast} from "./dom.js";
import {t, onLanguage} from "./i18n.js";
import {called, corrected, plain, told} from "./wording.js";
import {listen, speak} from "./speech.js";

// Answers after which there is something to take back.
const TAKEN = /^(Noted:|Thank you\. |That moves|I have (forgotten|added|found \d)|I treat the door as|I have taken|So \S+ is .* again\.|So (SS|CC|VV)\d+ is not |(SS|CC|VV)\d+ (is no longer confirmed|já não está confirmado)|Anotado:|Obrigad[oa]\. |Isso muda|Esqueci|Acrescentei|Trato a porta como|Volto a tratar a porta como|Anotei|Desfiz|Então (.* volta a ser|\S+ não é )|Encontrei \d)/;
const TAKES_BACK = /^(Undo that|Desfaça isso)\b/; // as the button says it
const ASKS_WHERE = /^\s*(where|onde)\b/i;
const PLACE_CODE = /\b(?:SS|CC|VV)0*(\d+)\b/g;
const LONGEST_LABEL = 60; // letters on a button
const OWN_FOR = 15000; // [ms] in which an answer belongs to what was said or tapped here
const MAX_CHIPS = 8;
const STOPS = ["Stop.", "Stop moving.", "Pare."]; // as the server says them for the button

export function reasonOf(error) {
  if (error.code === "not_connected") return t("not_connected");
  // What people can do nothing with is left out.
  const useful = error.reason && !/[_/]|:=|Error\b/.test(error.reason) && ["failed", "invalid"].includes(error.code);
  const text = t(["too_often", "stopped", "not_allowed", "nobody", "no_answer", "busy", "failed", "invalid", "unknown"].includes(error.code) ? `error_${error.code}` : "error_malformed");
  return useful ? `${text} (${plain(error.reason)})` : text;
}

// Starts and names that go on with what is typed: whole lines.
export function suggestions(line, names, sentences) {
  if (!line.trim()) return sentences;
  const lower = line.toLowerCase();
  const found = sentences.filter((each) => each.toLowerCase().startsWith(lower) && each.length > line.length);
  for (let begin = 0; begin < line.length; ++begin) {
    if (begin && line[begin - 1] !== " ") continue;
    const part = lower.slice(begin);
    if (part.length < 1) continue;
    for (const name of names) {
      if (name.toLowerCase().startsWith(part) && name.length > part.length) found.push(line.slice(0, begin) + name);
    }
    if (found.length > MAX_CHIPS) break;
  }
  if (line.endsWith(" ")) found.push(...names.map((name) => line + name));
  const right = corrected(line, names);
  if (right) found.push(right);
  return [...new Set(found)].slice(0, MAX_CHIPS);
}

export class Talk {
  // heard(text): before a sentence is said; answer(text): what is meant by it where something is open; light(id, brings): shows a place on the
  // map for a moment, and brings it into view.
  constructor(model, connection, may, heard, answer, light) {
    Object.assign(this, {model, connection, may, heard, answer, light});
    this.log = byId("talk-log");
    // The newest line stays in sight, also when the panel was out of it, unless somebody reads further up.
    this.atEnd = true;
    this.log.addEventListener("scroll", () => {
      const {clientHeight, scrollHeight, scrollTop} = this.log;
      const size = `${clientHeight} ${scrollHeight}`;
      // What has become higher or lower has moved the lines, and nobody's finger.
      if (clientHeight && size === this.size) this.atEnd = scrollHeight - scrollTop - clientHeight < 60;
      else if (this.atEnd) this.showNewest();
      this.size = size;
    });
    new ResizeObserver(() => this.atEnd && this.showNewest()).observe(this.log);
    let width = 0;
    new ResizeObserver(([{contentRect}]) => {
      if (contentRect.width !== width) this.fitLine();
      width = contentRect.width;
    }).observe(byId("say"));
    this.line = byId("say");
    this.pending = []; // said, and not yet come back from the robot
    this.typed = new Map(); // what the robot was told: as it was typed here
    this.undoes = new Map(); // what the robot was told: what takes that back
    this.notes = []; // {after, number, key, values}: what happened behind an entry of the talk
    this.said = [];
    this.recalled = 0;
    this.shownTo = 0;
    this.first = true;
    byId("say-form").addEventListener("submit", (event) => {
      event.preventDefault();
      this.say(this.line.value.trim());
    });
    this.line.addEventListener("input", () => this.showChips());
    this.line.addEventListener("keydown", (event) => this.key(event));
    byId("yes").onclick = () => this.say(t("yes") + ".");
    byId("no").onclick = () => this.say(t("no") + ".");
    this.listenButton = byId("listen");
    this.listenButton.onclick = () => this.toggleListening();
    model.on(["talk", "undo", "halted"], () => this.showTalk());
    model.on(["asked", "talk"], () => this.showAsked());
    model.on(["names", "offered"], () => this.showChips());
    onLanguage(() => {
      this.showTalk();
      this.showChips();
      this.showAsked();
    });
  }

  // undo: what takes it back, where that is not "undo that"; "": nothing does.
  async say(typed, undo = undefined) {
    if (!typed) return;
    if (!this.may("talk")) {
      toast(t("error_not_allowed"), true);
      return;
    }
    const text = told(this.answer(typed), this.model);
    if (text !== typed) this.typed.set(text, typed);
    if (undo !== undefined) this.undoes.set(text, undo);
    else this.undoes.delete(text);
    this.heard(text);
    byId("answers").hidden = true;
    const entry = {text, failed: "", number: (this.sayings = (this.sayings ?? 0) + 1)};
    this.pending = this.pending.filter((each) => !each.failed);
    this.pending.push(entry);
    if (this.said[this.said.length - 1] !== typed) this.said.push(typed);
    this.recalled = 0;
    if (this.line.value.trim() === typed) this.line.value = "";
    this.showChips();
    this.showTalk(true);
    try {
      await this.connection.ask("say", {text});
      // The robot's own record of the talk follows; without it the sentence goes when it was answered.
      setTimeout(() => this.forget(entry), 1500);
    } catch (error) {
      entry.failed = reasonOf(error);
      this.showAsked();
      if (!this.line.value) this.line.value = typed; // to try again
      this.fitLine();
    }
    this.showTalk(true);
  }

  // Something that happened, in a line of its own behind what was said.
  note(key, values) {
    const {talk} = this.model;
    this.notes.push({after: talk.length ? talk[talk.length - 1].i : 0, number: (this.noted = (this.noted ?? 0) + 1), key, values});
    this.notes.splice(0, this.notes.length - 50);
    this.showTalk(this.atEnd);
  }

  // What a person said: as it was typed, where that was here.
  shownText(text) {
    return STOPS.includes(text) ? t("stop_said") : this.typed.get(text) ?? plain(text);
  }

  forget(entry) {
    this.pending = this.pending.filter((each) => each !== entry);
    this.showTalk();
    this.showAsked();
  }

  // As high as what is typed needs.
  fitLine() {
    this.line.style.height = "auto";
    this.line.style.height = `${this.line.scrollHeight + 2}px`;
  }

  // Up and down go through what was said where the cursor could not move.
  recalls(key) {
    if (!this.said.length || !["ArrowUp", "ArrowDown"].includes(key)) return false;
    const at = this.line.selectionStart;
    return this.recalled > 0 || at === (key === "ArrowUp" ? 0 : this.line.value.length);
  }

  key(event) {
    if (event.key === "Enter" && !event.shiftKey && !event.isComposing) {
      event.preventDefault();
      this.say(this.line.value.trim());
      return;
    }
    if (event.key === "Tab" && !event.shiftKey && !event.altKey && this.line.value.trim()) {
      const [first] = this.chips ?? [];
      if (!first || this.dismissed === this.line.value) return; // on to the next element
      this.complete(first);
      event.preventDefault();
    } else if (event.key === "Escape") {
      this.dismissed = this.line.value;
    } else if (this.recalls(event.key)) {
      this.recalled = Math.max(0, Math.min(this.said.length, this.recalled + (event.key === "ArrowUp" ? 1 : -1)));
      this.line.value = this.recalled ? this.said[this.said.length - this.recalled] : "";
      this.showChips();
      event.preventDefault();
    }
  }

  complete(text) {
    this.line.value = text;
    this.line.focus();
    this.line.setSelectionRange(text.length, text.length);
    this.showChips();
  }

  showChips() {
    this.fitLine();
    const sentences = ["start_in", "start_left", "start_right", "start_this", "start_where", "start_go", "start_told", "start_help"].map((key) => t(key));
    const {asked} = this.model.values;
    this.chips = asked && !this.line.value ? [] : suggestions(this.line.value, this.model.values.names ?? [], sentences);
    byId("chips").replaceChildren(...this.chips.map((text) => {
      const whole = /[?!.]$/.test(text) || text === t("start_help");
      const from = this.line.value.lastIndexOf(" ") + 1;
      const shown = this.line.value && text.startsWith(this.line.value.slice(0, from)) ? text.slice(from).trim() || text : text.trim() + (whole ? "" : "…");
      return button(shown, () => (whole && !this.line.value ? this.say(text) : this.complete(text)));
    }));
    // Below yes and no, in the room that is kept there: it comes later than they do, and moves nothing.
    const {offered} = this.model;
    if (asked?.yes && offered && !this.line.value) byId("chips").append(button(`${t("did_you_mean")} ${offered}`, () => this.say(offered), {class: "offered", "data-settles": `say ${offered}`}));
  }

  showAsked() {
    const asked = this.model.values.asked;
    byId("answers").hidden = !(asked && asked.yes && this.may("talk"));
    // Yes and no stand under their question: the last line of the talk, or once more here.
    const last = this.model.talk[this.model.talk.length - 1];
    byId("question").textContent = asked ? plain(asked.text) : "";
    for (const answer of ["yes", "no"]) byId(answer).dataset.settles = `${answer} ${asked?.text ?? ""}`; // a yes may set the robot going
    byId("question").classList.toggle("said-last", Boolean(asked) && !this.pending.length && last?.w === "robot" && last.s === asked.text);
    this.line.placeholder = t(asked && !asked.yes ? "answer_placeholder" : "say_placeholder");
    this.showChips();
  }

  showTalk(own = false) {
    const {talk} = this.model;
    const newest = talk.length ? talk[talk.length - 1].i : 0;
    for (const entry of talk) {
      if (entry.w === "human" && entry.i > this.shownTo) {
        const at = this.pending.findIndex((each) => each.text === entry.s && !each.failed);
        if (at >= 0) this.pending.splice(at, 1);
      }
      if (entry.w === "robot" && entry.i > this.shownTo && !this.first) {
        own ||= performance.now() - (this.connection.asked ?? -Infinity) < OWN_FOR;
        if (!this.connection.replays) speak(plain(entry.s));
      }
    }
    if (newest !== this.shownTo || own || !this.log.children.length || this.drawnLanguage !== document.documentElement.lang || this.pending.length || this.hadPending || this.drawnOpen !== this.open()) {
      this.showLines();
      this.drawnLanguage = document.documentElement.lang;
      this.drawnOpen = this.open();
    }
    const where = this.whereTold();
    if (where && where.i > this.shownTo && !this.first) this.light(where.place, false);
    this.hadPending = this.pending.length > 0;
    if (this.atEnd || own || this.first) this.showNewest();
    if (this.model.version) this.first = false;
    this.shownTo = newest;
  }

  // A place that it was sent to by its number is known by its name, where it has one.
  goalOf(halted) {
    const [id] = [...halted.matchAll(PLACE_CODE)].filter(([code]) => code === halted).map((found) => found[1]);
    if (!id) return plain(halted);
    return !this.model.place(id) || this.model.nameOf(id).none ? t("place_number", {n: id}) : called(this.model.labelOf(id));
  }

  // What is offered behind the talk and may change without it.
  open() {
    const {undo, halted} = this.model.values;
    return `${undo} ${halted && this.goalOf(halted)}`;
  }

  // The place that the answer to "Where is ...?" told: {i of the answer, place}; null: that was not asked last.
  whereTold() {
    const {talk} = this.model;
    const last = talk.map((entry) => entry.w).lastIndexOf("human");
    if (last < 0 || !ASKS_WHERE.test(talk[last].s)) return null;
    const places = (entry) => [...new Set([...entry.s.matchAll(PLACE_CODE)].map((found) => found[1]))];
    const answer = talk.slice(last + 1).find((entry) => entry.w === "robot" && places(entry).length === 1);
    const [place] = answer ? places(answer) : [];
    return place && this.model.place(place) ? {i: answer.i, place} : null;
  }

  // What can be taken back: {text, what}, or null. Only what the last answer has told of; behind an undo, what else the same sentence has told.
  undoable() {
    const {talk} = this.model;
    let last = talk.map((entry) => entry.w).lastIndexOf("human");
    if (last < 0 || !this.may("talk") || this.connection.replays) return null;
    const said = talk[last].s;
    const answers = talk.slice(last + 1).filter((entry) => entry.w === "robot");
    const taken = answers.some((entry) => TAKEN.test(entry.s));
    const next = this.model.values.undo ?? "";
    if (TAKES_BACK.test(said)) {
      while (last >= 0 && (talk[last].w !== "human" || TAKES_BACK.test(talk[last].s))) --last;
      return taken && next && talk[last]?.s.includes(next) ? {text: t("undo_sentence"), what: plain(next)} : null;
    }
    const own = this.undoes.get(said);
    if (!taken || own === "") return null;
    return own ? {text: own, what: this.shownText(said)} : next ? {text: t("undo_sentence"), what: plain(next)} : null;
  }

  showNewest() {
    this.log.scrollTop = this.log.scrollHeight;
    this.size = `${this.log.clientHeight} ${this.log.scrollHeight}`;
  }

  // What is there stays: a screen reader reads only what is new.
  showLines() {
    const lines = this.lines();
    const wanted = new Set(lines.map(([key]) => key));
    for (const element of [...this.log.children]) if (!wanted.has(element.dataset.key)) element.remove();
    lines.forEach(([key, build], i) => {
      if (this.log.children[i]?.dataset.key === key) return;
      const element = build();
      element.dataset.key = key;
      this.log.insertBefore(element, this.log.children[i] ?? null);
    });
  }

  // [key, how it is made] of each line; what is the same has the same key.
  lines() {
    const {talk} = this.model;
    const language = document.documentElement.lang;
    const lines = [];
    if (!talk.length && !this.pending.length) lines.push([`welcome ${language}`, () => make("p", {class: "welcome"}, t("welcome"))]);
    const noteAfter = (from, to) => {
      for (const each of this.notes) {
        if (each.after >= from && each.after < to) lines.push([`note ${each.number} ${language}`, () => make("p", {class: "happened"}, t(each.key, each.values))]);
      }
    };
    noteAfter(0, talk.length ? talk[0].i : Infinity);
    talk.forEach((entry, i) => {
      const is_own = entry.w === "human";
      lines.push([`${entry.i} ${entry.t} ${is_own && STOPS.includes(entry.s) ? language : ""}`, () => make("div", {class: `said ${entry.w}${!is_own && entry.s.endsWith("?") ? " asks" : ""}`}, is_own ? this.shownText(entry.s) : plain(entry.s))]);
      noteAfter(entry.i, talk[i + 1]?.i ?? Infinity);
    });
    // Below the last answer, what can be done with it.
    const where = this.whereTold();
    if (where) lines.push([`show ${language} ${where.i}`, () => button(t("show_place", {n: where.place}), () => this.light(where.place, true), {class: "after show"})]);
    const undoable = this.undoable();
    if (undoable) {
      const {text, what} = undoable;
      const short = what.length > LONGEST_LABEL ? what.slice(0, LONGEST_LABEL - 1).trimEnd() + "…" : what.replace(/\.$/, "");
      lines.push([`undo ${language} ${text} ${what}`, () => button(t("undo_what", {what: short}), () => this.say(text), {class: "after undo", "data-settles": `undo ${what}`})]);
    }
    const {halted} = this.model.values;
    if (halted && this.may("drive") && !this.pending.length) {
      lines.push([`halted ${language} ${this.goalOf(halted)}`, () => button(t("carry_on_to", {name: this.goalOf(halted)}), () => this.say(t("carry_on")), {class: "after carry-on", "data-settles": `carry on ${halted}`})]);
    }
    for (const each of this.pending) {
      lines.push([`pending ${each.number} ${each.failed}`, () => make("div", {class: `said human ${each.failed ? "failed" : "waits"}`}, this.shownText(each.text), each.failed ? make("span", {class: "why"}, each.failed) : null)]);
    }
    return lines;
  }

  toggleListening() {
    if (this.stopListening) {
      this.stopListening();
      return;
    }
    this.showListening(true);
    const stop = listen({
      onText: (text, final) => {
        this.line.value = text;
        this.fitLine();
        if (final) this.say(text.trim());
      },
      onRefused: (key) => toast(t(key), true),
      onEnd: () => {
        this.stopListening = null;
        this.showListening(false);
      },
    });
    if (this.isListening) this.stopListening = stop;
  }

  showListening(on) {
    this.isListening = on;
    this.listenButton.setAttribute("aria-pressed", String(on));
    byId("hearing").hidden = !on;
  }
}
