// Pictures of the map's tiles, in the colours of the page, and one small picture of all of it for looks from afar.
const SHRINK = 8; // cells of a pixel of the small picture

export class TilePictures {
  constructor(model, redraw) {
    this.model = model;
    this.redraw = redraw;
    this.drawn = new Map(); // key: {version, dark, canvas, small}
    this.busy = false;
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
      for (const key of [...this.drawn.keys()]) if (!this.model.tiles.has(key)) this.drawn.delete(key);
      for (const [key, tile] of [...this.model.tiles]) {
        const known = this.drawn.get(key);
        if (known && known.version === tile.version && known.dark === this.dark) continue;
        try {
          const image = await createImageBitmap(tile.picture);
          this.drawn.set(key, {version: tile.version, dark: this.dark, ...this.colored(image)});
          image.close();
          this.redraw();
        } catch {
          this.drawn.set(key, {version: tile.version, dark: this.dark, canvas: null}); // it is no picture
        }
      }
    } while (this.again);
    this.busy = false;
    this.redraw();
  }

  colored(image) {
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [image.width, image.height];
    const context = canvas.getContext("2d");
    context.drawImage(image, 0, 0);
    if (this.dark) { // white becomes dark and black light; what is unknown stays clear
      context.globalCompositeOperation = "difference";
      context.fillStyle = "#ecebe6";
      context.fillRect(0, 0, image.width, image.height);
      context.globalCompositeOperation = "destination-in";
      context.drawImage(image, 0, 0);
    }
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
    for (const [key, tile] of this.model.tiles) {
      const drawn = this.drawn.get(key);
      if (!drawn || !drawn.canvas) continue;
      const [x, y] = [tile.column * side, tile.row * side];
      if (info.yaw === 0 && (x > view.right || x + side < view.left || y > view.top || y + side < view.bottom)) continue;
      context.save();
      context.translate(x, y + side);
      context.scale(1, -1);
      const bleed = 0.3 * info.resolution; // no seams between tiles
      context.drawImage(pixelsPerCell < 0.25 ? drawn.small : drawn.canvas, 0, 0, side + bleed, side + bleed);
      context.restore();
    }
    context.restore();
  }
}
