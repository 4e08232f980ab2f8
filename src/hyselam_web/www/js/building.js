// How places lie to each other: through which door, behind which wall; which doors people have shut.
import {inside} from "./model.js";

const ON_DOOR = 0.3; // [m] from the middle of a wall to that of the door it shuts
const BESIDE = [0.3, 0.5, 0.8]; // [m] from the middle of a wall: beyond the wall itself, and what is drawn of it
const THICKEST = 0.45; // [m] of a wall between two places
const SHARED = 0.75; // [m] of it that both share, at least
const STEP = 0.25; // [m] between two looks along an outline

function middleOf(wall) {
  return [(wall.ax + wall.bx) / 2, (wall.ay + wall.by) / 2];
}

export function lengthOf(wall) {
  return Math.hypot(wall.bx - wall.ax, wall.by - wall.ay);
}

// The wall across a door, by which somebody has shut it; null: none.
export function shutBy(model, door) {
  const shuts = (wall) => {
    const [x, y] = middleOf(wall);
    const length = lengthOf(wall);
    const across = Math.abs((wall.bx - wall.ax) * door.nx + (wall.by - wall.ay) * door.ny);
    return wall.v && door.r && Math.hypot(x - door.x, y - door.y) <= ON_DOOR && across <= 0.5 * length && length >= door.w - ON_DOOR && length <= door.w + 2 * ON_DOOR;
  };
  return Object.values(model.tables.told).find(shuts) ?? null;
}

// Walls that people told of and that shut no door.
export function plainWalls(model) {
  const shut = Object.values(model.tables.doors).map((door) => shutBy(model, door));
  return Object.values(model.tables.told).filter((wall) => !shut.includes(wall));
}

// The places on both sides of a wall.
export function sidesOf(model, wall) {
  const [x, y] = middleOf(wall);
  const length = Math.max(lengthOf(wall), 0.01);
  const [nx, ny] = [(wall.ay - wall.by) / length, (wall.bx - wall.ax) / length];
  const beside = (sign) => BESIDE.map((far) => model.placeAt(x + sign * far * nx, y + sign * far * ny)).find((id) => id !== null);
  return [1, -1].map(beside).filter((id) => id !== undefined);
}

function distanceTo(outline, x, y) {
  let least = Infinity;
  for (let i = 0, j = outline.length - 2; i < outline.length; j = i, i += 2) {
    const [ax, ay, dx, dy] = [outline[j], outline[j + 1], outline[i] - outline[j], outline[i + 1] - outline[j + 1]];
    const share = Math.max(0, Math.min(1, ((x - ax) * dx + (y - ay) * dy) / Math.max(dx * dx + dy * dy, 1e-9)));
    least = Math.min(least, Math.hypot(x - ax - share * dx, y - ay - share * dy));
  }
  return least;
}

// Along so much of the outline of one place [m] the other is near.
function sharedLength(a, b) {
  let shared = 0;
  for (let i = 0, j = a.length - 2; i < a.length; j = i, i += 2) {
    const length = Math.hypot(a[i] - a[j], a[i + 1] - a[j + 1]);
    const steps = Math.max(1, Math.round(length / STEP));
    for (let k = 0; k < steps; ++k) {
      const share = (k + 0.5) / steps;
      const [x, y] = [a[j] + share * (a[i] - a[j]), a[j + 1] + share * (a[i + 1] - a[j + 1])];
      if (distanceTo(b, x, y) <= THICKEST || inside(b, x, y)) shared += length / steps;
    }
  }
  return shared;
}

// The places behind the walls of one, to which it has no door.
export function behind(model, id) {
  const own = model.place(id);
  const by_door = model.neighbours(id).map(String);
  if (!own?.o) return [];
  return Object.entries(model.tables.places).filter(([other, place]) => other !== String(id) && place.o && !by_door.includes(other)
    && sharedLength(own.o, place.o) >= SHARED).map(([other]) => other);
}

// Where a thing lies of which only the place is known: beside the others there, below the name of the place.
export function spotsOfTold(model) {
  const found = new Map(); // id of the thing: [x, y, how many stand there before it]
  const counts = {};
  for (const [id, each] of Object.entries(model.tables.objects)) {
    if (each.c || !each.at) continue;
    const place = Object.keys(model.tables.places).find((one) => {
      const {e, n} = model.place(one);
      return e === each.at[1] || n.some((word) => word[0].toLowerCase() === each.at[1].toLowerCase());
    });
    if (!place || !model.place(place).c) continue;
    counts[place] = (counts[place] ?? 0) + 1;
    found.set(id, [...model.place(place).c, counts[place]]);
  }
  return found;
}
