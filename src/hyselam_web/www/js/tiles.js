// Pictures of the map's tiles, in the colours of the page, and one small picture of all of it for looks from afar.
const AT_ONCE = 16; // tiles that are decoded together
const SHRINK = 8; // cells of a pixel of the small picture, and of the coarse one that comes first

export class TilePictures {
  constructor(model, redraw) {
    this.model = model;
    this.redraw = redraw;
    this.drawn = new Map(); // key: {version, dark, canvas, small}
    this.overview = null; // {of, dark, canvas}: all tiles coarsely, where they are not drawn yet
    this.busy = false;
  }

  // All of the map is drawn, coarsely or not.
  isWhole() {
    return this.overview !== null || this.isFine();
  }

  isFine() {
    return this.drawn.size > 0 && this.drawn.size === this.model.tiles.size && this.model.complete;
  }

  // Decodes what is new or has other colours; the rest stays.
  async update(dark) {
    this.dark = dark;
    if (this.busy) {
      this.again = true;
      return;
    }
    this.busy = true;
    do {
      this.again = false;
      await this.updateOverview();
      for (const key of [...this.drawn.keys()]) if (!this.model.tiles.has(key)) this.drawn.delete(key);
      const stale = [...this.model.tiles].filter(([key, tile]) => {
        const known = this.drawn.get(key);
        return !known || known.version !== tile.version || known.dark !== this.dark;
      });
      for (let begin = 0; begin < stale.length; begin += AT_ONCE) {
        await Promise.all(stale.slice(begin, begin + AT_ONCE).map(([key, tile]) => this.decode(key, tile)));
        this.redraw();
      }
    } while (this.again);
    await this.updateOverview();
    this.busy = false;
    this.redraw();
  }

  async updateOverview() {
    const of = this.model.overview;
    if (of === null || this.isFine()) {
      this.model.overview = this.overview = null; // what is fine replaces it
      return;
    }
    if (this.overview?.of === of && this.overview.dark === this.dark) return;
    try {
      this.overview = {of, dark: this.dark, canvas: this.inColors(await createImageBitmap(of.picture))};
      this.before = this.drawn.size; // tiles that were drawn before it
      this.redraw();
    } catch {
      this.model.overview = this.overview = null; // it is no picture
    }
  }

  async decode(key, tile) {
    const of_tile = {version: tile.version, dark: this.dark};
    try {
      this.drawn.set(key, {...of_tile, ...this.colored(await createImageBitmap(tile.picture))});
    } catch {
      this.drawn.set(key, {...of_tile, canvas: null}); // it is no picture
    }
  }

  inColors(image) {
    if (!this.dark) return image;
    // White becomes dark and black light; what is unknown stays clear.
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [image.width, image.height];
    const context = canvas.getContext("2d");
    context.drawImage(image, 0, 0);
    context.globalCompositeOperation = "difference";
    context.fillStyle = "#ecebe6";
    context.fillRect(0, 0, image.width, image.height);
    context.globalCompositeOperation = "destination-in";
    context.drawImage(image, 0, 0);
    return canvas;
  }

  colored(image) {
    const canvas = this.inColors(image);
    const small = document.createElement("canvas");
    small.width = small.height = image.width / SHRINK;
    const little = small.getContext("2d");
    little.imageSmoothingQuality = "high";
    little.drawImage(canvas, 0, 0, small.width, small.height);
    return {canvas, small};
  }

  // scale: pixels of the screen a cell; the context's unit is a metre, y up.
  draw(context, info, pixelsPerCell, view) {
    const side = info.side * info.resolution;
    context.save();
    context.rotate(info.yaw);
    context.translate(info.rest[0], info.rest[1]);
    context.imageSmoothingEnabled = pixelsPerCell < 3;
    const bleed = 0.3 * info.resolution; // no seams between tiles
    const paint = (column, row, image, ...part) => {
      const [x, y] = [column * side, row * side];
      if (info.yaw === 0 && (x > view.right || x + side < view.left || y > view.top || y + side < view.bottom)) return;
      context.save();
      context.translate(x, y + side);
      context.scale(1, -1);
      context.drawImage(image, ...part, 0, 0, side + bleed, side + bleed);
      context.restore();
    };
    if (this.overview) this.drawOverview(info.side / SHRINK, paint);
    for (const [key, tile] of this.model.tiles) {
      const drawn = this.drawn.get(key);
      if (drawn?.canvas) paint(tile.column, tile.row, pixelsPerCell < 0.25 ? drawn.small : drawn.canvas);
    }
    context.restore();
  }

  // side: pixels of the coarse picture a tile.
  drawOverview(side, paint) {
    const {of, canvas} = this.overview;
    const [columns, rows] = [canvas.width / side, canvas.height / side];
    for (let i = 0; i < columns; ++i) {
      for (let j = 0; j < rows; ++j) {
        const [column, row] = [of.column + i, of.row + j];
        if (!this.drawn.has(`${column},${row}`)) paint(column, row, canvas, i * side, (rows - 1 - j) * side, side, side);
      }
    }
  }
}
