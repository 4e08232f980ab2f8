// Things on the map, where there is room for them.
import {haloed} from "./map_labels.js";
import {spotsOfTold} from "./building.js";

const THINGS = 14; // pixels a metre from which things are drawn
const THING_NAMES = 24; // and their names

// {id, each, x, y [pixels], told}; those that were only told of lie in their places, below the names.
export function thingsOn(view) {
  const found = [];
  if (view.scale < THINGS) return found;
  const told = view.scale < THING_NAMES ? new Map() : spotsOfTold(view.model);
  for (const [id, each] of Object.entries(view.model.tables.objects)) {
    const spot = told.get(id);
    if (!each.c && !spot) continue;
    const [x, y] = view.toScreen(...(each.c ?? spot));
    found.push(each.c ? {id, each, x, y} : {id, each, told: true, x: x - 30, y: y + 12 + 19 * spot[2]});
  }
  return found;
}

export function drawThings(c, view) {
  const {object, halo} = view.colors;
  c.font = "12px system-ui, sans-serif";
  c.textAlign = "left";
  c.textBaseline = "middle";
  for (const {each, x, y, told} of thingsOn(view)) {
    c.fillStyle = told ? halo : object;
    c.strokeStyle = told ? object : halo;
    c.lineWidth = 2;
    c.beginPath();
    c.rect(x - 5, y - 5, 10, 10);
    c.stroke();
    c.fill();
    if (view.scale >= THING_NAMES && !["thing", "furniture"].includes(each.k)) haloed(c, each.k.length > 24 ? each.k.slice(0, 23) + "…" : each.k, x + 9, y, object, halo);
  }
}
