"""A grid map in tiles, so that only those that changed go to the pages. Tiles lie on the lattice of the map's cells, not on its corner:
a map that grows keeps them. Each is a PNG of two bits a cell (no library for pictures: they take more memory than all else)."""
import math
import struct
import zlib

import numpy as np

SIDE = 256  # cells
COARSE = 8  # cells, each way, of a pixel of the coarse picture
WALL_SHARE = 8  # of the COARSE * COARSE cells: so many occupied ones are a wall there
UNKNOWN, FREE, OCCUPIED, UNSURE = 0, 1, 2, 3
FREE_MAX, OCCUPIED_MIN = 25, 65  # as in Gr2To
PALETTE = bytes([0, 0, 0, 255, 255, 255, 24, 32, 44, 158, 164, 172])  # by class
ALPHA = bytes([0, 255, 255, 255])
MAX_CELLS = 50000000
MAX_COARSE = 4000000  # pixels of the coarse picture


def classes():
    """Class of each value of an occupancy grid, read as unsigned byte."""
    table = np.full(256, UNKNOWN, np.uint8)
    table[:101] = UNSURE
    table[:FREE_MAX + 1] = FREE
    table[OCCUPIED_MIN:101] = OCCUPIED
    return table


CLASSES = classes()


def png(cells):
    """Classes of cells, a multiple of four in each row, row 0 the lowest, as a PNG, whose row 0 is the highest."""
    rows = cells[::-1]
    height, width = cells.shape
    packed = np.zeros((height, width // 4 + 1), np.uint8)  # one byte for the filter
    packed[:, 1:] = rows[:, 0::4] << 6 | rows[:, 1::4] << 4 | rows[:, 2::4] << 2 | rows[:, 3::4]

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 2, 3, 0, 0, 0)) + chunk(b"PLTE", PALETTE) +
            chunk(b"tRNS", ALPHA) + chunk(b"IDAT", zlib.compress(packed.tobytes(), 6)) + chunk(b"IEND", b""))


def coarse(cells):
    """The classes of a tile, COARSE x COARSE of them as one: walls stay in sight, what is known a little is known."""
    blocks = cells.reshape(SIDE // COARSE, COARSE, SIDE // COARSE, COARSE)

    def count(kind):
        return (blocks == kind).sum(axis=(1, 3))
    free, unsure = count(FREE), count(UNSURE)
    return np.where(count(OCCUPIED) >= WALL_SHARE, OCCUPIED, np.where(free + unsure == 0, UNKNOWN, np.where(free >= unsure, FREE, UNSURE))).astype(np.uint8)


def overview_of(coarse_tiles):
    """What MapTiles.overview() tells of the coarse tiles {(column, row): classes}."""
    if not coarse_tiles:
        return None
    columns, rows = zip(*coarse_tiles)
    left, low = min(columns), min(rows)
    side = SIDE // COARSE
    if (max(rows) - low + 1) * (max(columns) - left + 1) * side * side > MAX_COARSE:
        return None
    whole = np.zeros(((max(rows) - low + 1) * side, (max(columns) - left + 1) * side), np.uint8)
    for (column, row), cells in coarse_tiles.items():
        whole[(row - low) * side:(row - low + 1) * side, (column - left) * side:(column - left + 1) * side] = cells
    return left, low, png(whole)


class Prepared:
    """What a new map changes; commit() takes it over."""

    def __init__(self, identity, info, pictures, checksums, emptied, coarse_tiles, overview):
        self.identity, self.info, self.pictures, self.checksums, self.emptied = identity, info, pictures, checksums, emptied
        self.coarse_tiles, self.overview = coarse_tiles, overview


class MapTiles:
    """The tiles of the newest map, {(column, row): (number of the change, PNG)}. A PNG of no bytes: nothing is known there."""

    def __init__(self):
        self.info = None
        self.tiles = {}
        self._checksums = {}
        self._identity = None
        self._coarse, self._overview = {}, None

    def prepare(self, width, height, resolution, origin, data):
        """A new map; origin (x, y, yaw) of its corner; data: int8, row by row. Changes nothing: may run in a thread, one at a time.
        @throws ValueError for a map that is none."""
        if not (width > 0 and height > 0 and width * height <= MAX_CELLS and len(data) == width * height):
            raise ValueError(f"{len(data)} cells are not {width} x {height}, or more than {MAX_CELLS}")
        if not (math.isfinite(resolution) and resolution > 0 and all(math.isfinite(v) for v in origin)):
            raise ValueError(f"cells of {resolution} m at {origin} are not possible")
        yaw = origin[2]
        # The corner in the axes of the cells.
        along = math.cos(yaw) * origin[0] + math.sin(yaw) * origin[1]
        across = -math.sin(yaw) * origin[0] + math.cos(yaw) * origin[1]
        if max(abs(along), abs(across)) > 1e6 * resolution:
            raise ValueError(f"cells of {resolution} m at {origin} are too far from the origin")
        column, row = round(along / resolution), round(across / resolution)
        rest = (along - column * resolution, across - row * resolution)
        identity = (round(resolution, 9), round(yaw, 6), round(rest[0], 4), round(rest[1], 4))
        same = identity == self._identity  # else other cells: nothing of the old map fits
        grid = np.frombuffer(data, np.uint8).reshape(height, width)
        pictures, checksums, coarse_tiles = {}, {}, {}
        for ty in range(row // SIDE, (row + height - 1) // SIDE + 1):
            for tx in range(column // SIDE, (column + width - 1) // SIDE + 1):
                x0, y0 = tx * SIDE - column, ty * SIDE - row  # of the tile in the grid
                part = grid[max(0, y0):y0 + SIDE, max(0, x0):x0 + SIDE]
                cells = np.zeros((SIDE, SIDE), np.uint8)
                left, low = max(0, -x0), max(0, -y0)
                cells[low:low + part.shape[0], left:left + part.shape[1]] = CLASSES[part]
                if not cells.any():
                    continue
                checksums[(tx, ty)] = (zlib.crc32(cells), zlib.adler32(cells))
                if not same or self._checksums.get((tx, ty)) != checksums[(tx, ty)]:
                    pictures[(tx, ty)] = png(cells)
                    coarse_tiles[(tx, ty)] = coarse(cells)
        emptied = [key for key, (_, picture) in self.tiles.items() if picture and key not in checksums]
        info = {"resolution": resolution, "yaw": round(yaw, 6), "rest": [round(v, 6) for v in rest], "side": SIDE,
                "box": [column, row, column + width, row + height]}
        all_coarse = {key: coarse_tiles.get(key, self._coarse.get(key)) for key in checksums}
        return Prepared(identity, info, pictures, checksums, emptied, all_coarse, overview_of(all_coarse))

    def commit(self, prepared, next_version):
        """next_version() numbers each changed tile. Returns how many changed."""
        for key in prepared.emptied:
            self.tiles[key] = (next_version(), b"")
        for key, picture in prepared.pictures.items():
            self.tiles[key] = (next_version(), picture)
        self._identity, self._checksums, self.info = prepared.identity, prepared.checksums, prepared.info
        self._coarse, self._overview = prepared.coarse_tiles, prepared.overview
        return len(prepared.pictures) + len(prepared.emptied)

    def overview(self):
        """(column, row, PNG) of the lowest left tile and of all tiles in one coarse picture; None: there are none, or it would be too large."""
        return self._overview

    def changed_since(self, version):
        """Keys of the tiles that changed after it."""
        return [key for key, (number, _) in self.tiles.items() if number > version]


HEADER = struct.Struct("<iiI")
IN_ALL = -2 ** 31  # column and row of the frame of the coarse picture, of which those of its lowest left tile follow
CORNER = struct.Struct("<ii")
OVERVIEW = HEADER.pack(IN_ALL, IN_ALL, 0)[:8]


def frame(key, tile):
    """A tile as it goes to the pages: column, row, number of the change, PNG."""
    return HEADER.pack(key[0], key[1], tile[0] & 0xffffffff) + tile[1]


def overview_frame(overview):
    return HEADER.pack(IN_ALL, IN_ALL, 0) + CORNER.pack(*overview[:2]) + overview[2]
