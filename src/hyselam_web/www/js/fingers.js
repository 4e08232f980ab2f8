// Fingers tap twice, and what is under them changes in between: what appears there is not what was meant. STOP is always meant.
const SETTLES_IN = 700; // [ms] in which nothing new is pressed where something else was, nor anything that drives where it was not before
const SAME_SPOT = 44; // [pixels] within which a second tap is on the same spot
const HELD = 12; // [pixels] that a button may move and still be the same under a finger
const LOOKS_EVERY = 100; // [ms] between looks at what has appeared
const PRESSABLE = "button, summary, a";

export class Fingers {
  constructor() {
    this.shown = new Map(); // what buttons that must settle do: {x, y, since}
    this.presses = []; // the last two: {x, y, time, element}
    addEventListener("pointerdown", (event) => this.press(event), {capture: true});
    document.addEventListener("click", (event) => {
      if (this.isMeant(event)) return;
      event.preventDefault();
      event.stopPropagation();
    }, {capture: true});
    // What appears is seen at once, what moves a moment later.
    new MutationObserver(() => this.look()).observe(document.body, {subtree: true, childList: true, attributes: true, attributeFilter: ["hidden", "data-settles"]});
    setInterval(() => this.look(), LOOKS_EVERY);
  }

  press({clientX, clientY, target}) {
    this.presses = [...this.presses.slice(-1), {x: clientX, y: clientY, time: performance.now(), element: target.closest?.(PRESSABLE)}];
  }

  // Since when each button that says what it does in data-settles stands where it is; also when it was made again meanwhile.
  look() {
    const now = performance.now();
    const seen = new Set();
    for (const element of document.querySelectorAll("[data-settles]")) {
      const {x, y, width} = element.getBoundingClientRect();
      if (!width) continue;
      const meaning = element.dataset.settles;
      const before = this.shown.get(meaning);
      if (!before || Math.hypot(before.x - x, before.y - y) > HELD) this.shown.set(meaning, {x, y, since: now});
      seen.add(meaning);
      element.classList.toggle("settling", now - this.shown.get(meaning).since < SETTLES_IN);
    }
    for (const meaning of this.shown.keys()) if (!seen.has(meaning)) this.shown.delete(meaning);
  }

  isMeant(event) {
    const element = event.target.closest?.(PRESSABLE);
    if (!element || element.id === "stop") return true;
    if (element.dataset.settles !== undefined) {
      this.look();
      if (element.classList.contains("settling")) return false;
    }
    const [before, last] = this.presses;
    if (!last || event.detail === 0) return true; // keys
    return last.time - before.time >= SETTLES_IN || Math.hypot(last.x - before.x, last.y - before.y) > SAME_SPOT || before.element === element;
  }
}
