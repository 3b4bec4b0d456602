#!/usr/bin/env python3
"""Makes the meshes, materials and textures of road.toml beside itself. Needs nothing but Python 3; always the same bytes.

World: metres, y up, the road runs along -z from under the camera; d = -z is the distance down the road.
Distance haze is part of the materials: a colour c seen through a transmission t becomes Kd = t c, Ke = (1 - t) haze.
"""
import functools
import math
import pathlib
import random
import struct
import zlib

HERE = pathlib.Path(__file__).resolve().parent
CAMERA_X = 5.0
HAZE = (0.80, 0.585, 0.415)
HAZE_LENGTH = 8500.0


def lerp(a, b, t):
    return a + (b - a) * t


def smoothstep(a, b, x):
    t = min(max((x - a) / (b - a), 0.0), 1.0)
    return t * t * (3 - 2 * t)


def profile(d):
    """Height of the road: down from the camera into a basin, then up a long slope."""
    return -8.0 * (1 - math.exp(-max(d, 0.0) / 320.0)) + 5.2 * smoothstep(700.0, 3200.0, d)


def hashed(i, j, seed):
    h = (i * 374761393 + j * 668265263 + seed * 2147483647) & 0xFFFFFFFF
    h = ((h ^ (h >> 13)) * 1274126177) & 0xFFFFFFFF
    return ((h ^ (h >> 16)) & 0xFFFF) / 65535.0


def noise(x, y, seed, period=None):
    """Value noise in [0, 1], smooth; repeats after `period` cells."""
    i, j = math.floor(x), math.floor(y)
    u, v = x - i, y - j
    u, v = u * u * (3 - 2 * u), v * v * (3 - 2 * v)

    def corner(a, b):
        return hashed(a % period, b % period, seed) if period else hashed(a, b, seed)

    return lerp(lerp(corner(i, j), corner(i + 1, j), u), lerp(corner(i, j + 1), corner(i + 1, j + 1), u), v)


def fractal(x, y, seed, octaves=4, period=None):
    total, weight, scale = 0.0, 0.5, 1
    for k in range(octaves):
        total += weight * noise(x * scale, y * scale, seed + k, period * scale if period else None)
        weight, scale = weight * 0.5, scale * 2
    return total / (1 - 0.5**octaves)


class Materials:
    """The one material library; materials are made as they are asked for."""

    def __init__(self):
        self.lines = {}

    def get(self, name, color, distance=0.0, texture=None, emission=(0, 0, 0)):
        transmission = math.exp(-distance / HAZE_LENGTH)
        key = f"{name}_{distance:.0f}" if distance else name
        kd = " ".join(f"{c * transmission:.4f}" for c in color)
        ke = " ".join(f"{e + h * (1 - transmission):.4f}" for e, h in zip(emission, HAZE))
        text = f"newmtl {key}\nKd {kd}\nKe {ke}\n" + (f"map_Kd {texture}\n" if texture else "")
        self.lines[key] = text
        return key

    def write(self):
        (HERE / "plate.mtl").write_text("\n".join(self.lines[k] for k in sorted(self.lines)))


class Mesh:
    def __init__(self, name):
        self.name, self.out = name, ["mtllib plate.mtl"]
        self.count = self.normals = self.uvs = 0
        self.material = None

    def use(self, material):
        if material != self.material:
            self.out.append(f"usemtl {material}")
            self.material = material

    def vertex(self, x, y, z, color=None):
        digits = 4 if -z < 6 else 3 if -z < 400 and self.name != "bushes" else 2
        text = f"v {x:.{digits}f} {y:.{digits}f} {z:.{digits}f}"
        if color:
            text += "".join(f" {c:.2f}" for c in color)
        self.out.append(text)
        self.count += 1
        return self.count

    def uv(self, u, v):
        self.out.append(f"vt {u:.3f} {v:.3f}")
        self.uvs += 1
        return self.uvs

    def face(self, *corners):
        self.out.append("f " + " ".join(str(c) for c in corners))

    def polygon(self, points, color=None):
        self.face(*[self.vertex(*p, color) for p in points])

    def box(self, x0, x1, y0, y1, z0, z1):
        v = [self.vertex(x, y, z) for z in (z0, z1) for y in (y0, y1) for x in (x0, x1)]
        for f in ((4, 5, 7, 6), (1, 0, 2, 3), (0, 4, 6, 2), (5, 1, 3, 7), (6, 7, 3, 2), (0, 1, 5, 4)):
            self.face(*[v[i] for i in f])

    def rings(self, rings, sides, closed=True):
        """A surface of revolution about a vertical axis: rings of (x, y, z, radius), bottom first."""
        rows = []
        for x, y, z, r in rings:
            angles = [2 * math.pi * k / sides for k in range(sides)]
            rows.append([self.vertex(x + r * math.sin(a), y, z + r * math.cos(a)) for a in angles])
        for a, b in zip(rows, rows[1:]):
            for k in range(sides):
                self.face(a[k], a[(k + 1) % sides], b[(k + 1) % sides], b[k])
        if closed:
            self.face(*rows[-1])

    def beam(self, a, b, width):
        """A triangular rod from a to b."""
        direction = [q - p for p, q in zip(a, b)]
        length = math.sqrt(sum(c * c for c in direction))
        dx, dy, dz = (c / length for c in direction)
        side = (dz, 0, -dx) if abs(dy) < 0.9 else (1, 0, 0)
        norm = math.sqrt(sum(c * c for c in side))
        side = [c / norm for c in side]
        up = (dy * side[2] - dz * side[1], dz * side[0] - dx * side[2], dx * side[1] - dy * side[0])
        ends = []
        for p in (a, b):
            for k in range(3):
                c, s = math.cos(2.0944 * k) * width / 2, math.sin(2.0944 * k) * width / 2
                ends.append(self.vertex(*[p[i] + c * side[i] + s * up[i] for i in range(3)]))
        for k in range(3):
            self.face(ends[k], ends[(k + 1) % 3], ends[3 + (k + 1) % 3], ends[3 + k])

    def write(self):
        (HERE / f"{self.name}.obj").write_text("\n".join(self.out) + "\n")


def png(name, width, height, pixel, channels, bits=8):
    """pixel(x, y) gives `channels` sRGB codes on 0…1."""
    top, form = (255, ">B") if bits == 8 else (65535, ">H")
    raw = bytearray()
    for y in range(height):
        raw.append(0 if channels == 1 else 2)  # filter: none, up
        row = [min(max(int(c * top + 0.5), 0), top) for x in range(width) for c in pixel(x, y)]
        data = b"".join(struct.pack(form, c) for c in row)
        if channels > 1:
            above = png.above if y else bytes(len(data))
            raw += bytes((a - b) & 255 for a, b in zip(data, above))
            png.above = data
        else:
            raw += data

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    header = struct.pack(">IIBBBBB", width, height, bits, {1: 0, 3: 2}[channels], 0, 0, 0)
    (HERE / name).write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header)
                              + chunk(b"IDAT", zlib.compress(bytes(raw), 9)) + chunk(b"IEND", b""))


def srgb(c):
    c = max(c, 0.0)
    return 12.92 * c if c <= 0.0031308 else 1.055 * c ** (1 / 2.4) - 0.055


def textures():
    def sand(x, y):
        n = fractal(x / 32, y / 32, 1, 5, 8)
        grain = hashed(x, y, 7)
        value = 0.80 + 1.0 * (n - 0.5) + 0.20 * (grain - 0.5)
        if hashed(x // 2, y // 2, 9) < 0.035:  # pebbles
            value *= 0.62
        return (srgb(value),)

    def asphalt(x, y):
        u = x / 255 * 7.4 - 3.7
        n = fractal(x / 32, y / 64, 20, 4, 8)
        value = 0.70 + 0.22 * (n - 0.5) + 0.16 * (hashed(x, y, 23) - 0.5)
        for track in (-2.7, -0.95, 0.95, 2.7):
            value *= 1 - 0.17 * math.exp(-((u - track) / 0.32) ** 2)
        for lane in (-1.82, 1.82):
            value *= 1 - 0.10 * math.exp(-((u - lane) / 0.25) ** 2)
        for k, (y0, x0) in enumerate(((40, 0), (118, 60), (201, 10))):  # tar in transverse cracks
            crack = y0 + 9 * (fractal(x / 24, k + 0.5, 40 + k, 3) - 0.5)
            if abs(y - crack) < 0.8 and x0 < x < x0 + 200:
                value *= 0.5
        seam = 128 + 5 * (fractal(0.5, y / 24, 50, 3, None) - 0.5) * (1 - abs(y - 127.5) / 127.5)
        if abs(x - seam) < 0.8:
            value *= 0.62
        return (srgb(value),)

    @functools.lru_cache(None)
    def clear_sky(y):
        elevation = 90 - (y + 0.5) / 4096 * 180
        stops = ((-90, (0.50, 0.40, 0.32)), (-0.3, HAZE), (0.0, (0.90, 0.665, 0.475)), (0.5, (0.86, 0.675, 0.525)),
                 (1.1, (0.70, 0.63, 0.58)), (2.1, (0.40, 0.49, 0.60)), (4.0, (0.27, 0.40, 0.58)),
                 (12, (0.22, 0.37, 0.60)), (90, (0.08, 0.19, 0.45)))
        for (e0, c0), (e1, c1) in zip(stops, stops[1:]):
            if elevation <= e1:
                t = smoothstep(e0, e1, elevation) * 0.35 + (elevation - e0) / (e1 - e0) * 0.65
                return elevation, tuple(lerp(a, b, t) for a, b in zip(c0, c1))

    @functools.lru_cache(None)
    def cloudless(y):
        return tuple(round(srgb(c) * 4095) / 4095 for c in clear_sky(y)[1])

    def sky(x, y):
        elevation, color = clear_sky(y)
        azimuth = (x + 0.5) / 1024 * 360 - 180
        window = (1 - smoothstep(7, 11, abs(azimuth))) * smoothstep(0.45, 1.0, elevation) * (1 - smoothstep(5, 9, elevation))
        if window <= 0:
            return cloudless(y)
        else:
            streak = fractal(azimuth / 3.1 + elevation * 0.55, elevation / 0.30, 60, 4)
            veil = fractal(azimuth / 6 + 3, elevation / 1.1, 70, 3)
            cover = smoothstep(0.44, 0.80, 0.62 * streak + 0.38 * veil) * window * 0.75
            color = [lerp(a, b, cover) for a, b in zip(color, (0.99, 0.80, 0.64))]
        return [round(srgb(c) * 4095) / 4095 for c in color]

    png("sand.png", 256, 256, sand, 1)
    png("asphalt.png", 256, 256, asphalt, 1)
    png("sky.png", 1024, 4096, sky, 3, 16)


def distances(near, far, count):
    return [near * (far / near) ** (k / (count - 1)) for k in range(count)]


ROWS = distances(34.0, 5200.0, 92)


def ground_height(x, d):
    off_road = smoothstep(8.0, 22.0, abs(x))
    bumps = 0.55 * (fractal(x / 14, d / 30, 80, 3) - 0.5) + 2.2 * (fractal(x / 90, d / 160, 90, 3) - 0.5) * min(d / 500, 1)
    return profile(d) - 0.05 + off_road * bumps - 0.18 * smoothstep(5.6, 8.0, abs(x)) * (1 - off_road)


def ground(materials):
    mesh = Mesh("ground")
    side = [0.0, 0.05, 0.12, 0.22, 0.36, 0.54, 0.75, 1.0]
    rows = []
    for d in ROWS:
        left, right = CAMERA_X - 0.10 * d - 14, CAMERA_X + 0.066 * d + 14
        xs = [lerp(-8, min(left, -9), t) for t in reversed(side)] + [-5.6, 5.6] + [lerp(8, max(right, 9), t) for t in side]
        row = []
        for x in xs:
            n = fractal(x / 11 + 40, d / (26 + d * 0.12), 100, 4) - 0.5
            bare = 1 + 0.55 * n
            tint = (bare, bare * (1 + 0.10 * n), bare * (1 + 0.16 * n))
            gravel = 1 - smoothstep(6.0, 9.0, abs(x))
            color = [lerp(a, b, 0.6 * gravel) for a, b in zip(tint, (0.86, 0.92, 1.0))]
            v = mesh.vertex(x, ground_height(x, d), -d, color)
            row.append(f"{v}/{mesh.uv(x / 9, d / 9)}")
        rows.append(row)
    for d, a, b in zip(ROWS, rows, rows[1:]):
        mesh.use(materials.get("sand", (0.80, 0.515, 0.295), d if d > 60 else 0, "sand.png"))
        for k in range(len(a) - 1):
            mesh.face(a[k], a[k + 1], b[k + 1], b[k])
    mesh.write()


def road(materials):
    mesh = Mesh("road")

    def strip(x0, x1, lift, name, color, texture=None, rows=ROWS):
        last = None
        for d in rows:
            y = profile(d) + lift
            corners = [f"{mesh.vertex(x, y, -d)}/{mesh.uv(u, d / 24)}" for u, x in ((0, x0), (1, x1))]
            if last:
                mesh.use(materials.get(name, color, d if d > 60 else 0, texture))
                mesh.face(last[0], last[1], corners[1], corners[0])
            last = corners

    def on_rows(d):
        """The road's own height between its rows, so that markings lie flat on it."""
        for a, b in zip(ROWS, ROWS[1:]):
            if a <= d <= b:
                return lerp(profile(a), profile(b), (d - a) / (b - a))
        return profile(d)

    strip(-3.7, 3.7, 0.0, "asphalt", (0.235, 0.205, 0.18), "asphalt.png")
    strip(-3.42, -3.28, 0.012, "white_paint", (0.80, 0.77, 0.70))
    strip(3.28, 3.42, 0.012, "white_paint", (0.80, 0.77, 0.70))
    d = 40.0
    while d < 2600:
        mesh.use(materials.get("yellow_paint", (0.78, 0.47, 0.07), d))
        mesh.polygon([(x, on_rows(e) + 0.012, -e) for x, e in ((-0.08, d), (0.08, d), (0.08, d + 3.2), (-0.08, d + 3.2))])
        d += 12.2
    strip(0.22, 0.36, 0.012, "yellow_paint", (0.78, 0.47, 0.07), None, [r for r in ROWS if r < 420])
    mesh.write()


def bushes(materials):
    mesh, rng = Mesh("bushes"), random.Random(5)
    palette = ((0.36, 0.32, 0.17), (0.44, 0.36, 0.19), (0.27, 0.275, 0.16), (0.52, 0.41, 0.23), (0.23, 0.245, 0.145))

    def bush(x, d, size, blades, kind):
        """A tuft: blades from a common root ring to tips of their own."""
        y = ground_height(x, d) - 0.03
        tone = rng.uniform(0.8, 1.15)
        ring, spread = 7, size * 0.17
        root = [mesh.vertex(x + spread * math.cos(6.2832 * k / ring), y, -d + spread * math.sin(6.2832 * k / ring),
                            (0.55 * tone,) * 3) for k in range(ring)]
        mesh.use(f"bush{kind}")
        for _ in range(blades):
            k, lean = rng.randrange(ring), rng.uniform(0.03, 1.0)
            a = 6.2832 * (k + 0.5) / ring + rng.gauss(0, 0.45)
            r, h = size * 0.60 * lean, size * rng.uniform(0.55, 1.0) * math.sqrt(1 - 0.75 * lean * lean)
            light = tone * rng.uniform(0.85, 1.25)
            tip = mesh.vertex(x + r * math.cos(a), y + h, -d + r * math.sin(a), (light, light, 0.95 * light))
            mesh.face(root[k], root[(k + rng.choice((1, 1, 2))) % ring], tip)

    for index, color in enumerate(palette):
        materials.get(f"bush{index}", color)

    def place(near, far, count, low, high, blades, shoulder):
        for _ in range(count):
            d = near * (far / near) ** rng.random()
            x = rng.uniform(5 - 0.092 * d, 5 + 0.060 * d)
            if shoulder:
                x = rng.choice((rng.gauss(7.4, 0.7), rng.gauss(-6.6, 0.8)))
            cluster = fractal(x / 9, d / 14, 300, 2)
            if abs(x) < 6.0 or (not shoulder and cluster < 0.40):
                continue
            bush(x, d, rng.uniform(low, high) * (1 + d / 1800), blades, rng.randrange(len(palette)))

    place(50, 190, 170, 0.28, 0.75, 24, False)
    place(48, 260, 120, 0.12, 0.34, 9, True)
    place(150, 520, 420, 0.45, 1.05, 9, False)
    place(420, 2600, 520, 0.7, 1.5, 4, False)
    mesh.write()


def roadside(materials):
    mesh = Mesh("roadside")
    # The marker post five metres from the lens: a flat post with rounded edges, dirtier towards the ground.
    x, d = CAMERA_X + 0.192, 5.0
    mesh.use(materials.get("post", (0.56, 0.53, 0.49)))
    outline = [(-0.043, 0.0), (-0.040, 0.009), (-0.034, 0.014), (-0.028, 0.016), (0.028, 0.016), (0.034, 0.014), (0.040, 0.009),
               (0.043, 0.0), (0.0, -0.02)]
    rows = []
    for y, dirt in ((0.5, 0.45), (0.92, 0.66), (1.0, 0.84), (1.06, 0.95), (1.225, 1.0)):
        tint = (dirt, lerp(0.80, 1, dirt) * dirt, lerp(0.6, 1, dirt) * dirt)
        slant = 0.009 if y > 1.2 else 0
        rows.append([mesh.vertex(x + a + 0.004 * (y - 1), y - slant * a / 0.043, -d + b, tint) for a, b in outline])
    for a, b in zip(rows, rows[1:]):
        for k in range(len(outline)):
            m = (k + 1) % len(outline)
            mesh.face(a[k], a[m], b[m], b[k])
    mesh.face(*rows[-1])
    front = -d + 0.0168
    mesh.use(materials.get("post_band", (0.035, 0.033, 0.032)))
    mesh.polygon([(x - 0.0278, 1.046, front), (x + 0.0278, 1.068, front), (x + 0.0278, 1.200, front), (x - 0.0278, 1.178, front)])
    mesh.use(materials.get("reflector_frame", (0.10, 0.09, 0.08)))
    mesh.box(x - 0.0215, x + 0.0215, 1.084, 1.162, front, front + 0.003)
    for k in range(3):
        for j in range(6):
            shade = 0.82 + 0.30 * hashed(k, j, 3)
            mesh.use(materials.get(f"amber{(k + j) % 3}", (0.95, 0.30 + 0.07 * ((k + j) % 3), 0.03),
                                   emission=(0.12, 0.03, 0.0)))
            x0, y0, z = x - 0.0185 + 0.0124 * k, 1.0870 + 0.0121 * j, front + 0.0035
            mesh.polygon([(x0, y0, z), (x0 + 0.0119, y0, z), (x0 + 0.0119, y0 + 0.0116, z), (x0, y0 + 0.0116, z)],
                         (shade,) * 3)

    # Small markers along the left edge, a fence on the right.
    for k in range(14):
        d = 75 + 55 * k
        y = profile(d)
        mesh.use(materials.get("marker", (0.78, 0.75, 0.69), d))
        mesh.box(-4.85, -4.74, y - 0.1, y + 1.0, -d - 0.03, -d)
        mesh.use(materials.get("marker_amber", (0.95, 0.33, 0.04), d))
        mesh.box(-4.83, -4.76, y + 0.72, y + 0.90, -d, -d + 0.01)
    rng = random.Random(11)
    last = None
    for k in range(60):
        d = 84 + 8.4 * k
        px, lean = 12.5 + rng.uniform(-0.1, 0.1), rng.uniform(-0.07, 0.07)
        y = ground_height(px, d)
        mesh.use(materials.get("wood", (0.32, 0.235, 0.165), 40 * (d // 40)))
        mesh.beam((px, y - 0.2, -d), (px + lean, y + 1.1 + rng.uniform(-0.08, 0.08), -d), 0.11)
        top = (px + lean, y, -d)
        if last and d < 330:
            mesh.use(materials.get("wire", (0.20, 0.18, 0.16), 40 * (d // 40)))
            for height in (0.55, 0.98):
                mesh.beam((last[0], last[1] + height, last[2]), (top[0], top[1] + height, top[2]), 0.011)
        last = top

    # The warning sign.
    x, d = 7.55, 118.0
    y = profile(d)
    mesh.use(materials.get("steel", (0.42, 0.40, 0.37), d))
    mesh.box(x - 0.035, x + 0.035, y - 0.3, y + 2.75, -d - 0.06, -d - 0.01)
    for size, z, name, color in ((0.72, 0.0, "sign_black", (0.03, 0.028, 0.025)), (0.675, 0.03, "sign_yellow", (0.92, 0.55, 0.03))):
        mesh.use(materials.get(name, color, d))
        cy = y + 2.15
        mesh.polygon([(x, cy - size, -d + z), (x + size, cy, -d + z), (x, cy + size, -d + z), (x - size, cy, -d + z)])
    mesh.use("sign_black_118")
    mesh.polygon([(x + a, cy + b, -d + 0.06) for a, b in ((-0.05, -0.36), (0.05, -0.36), (0.05, 0.10), (-0.05, 0.10))])
    mesh.polygon([(x - 0.19, cy + 0.08, -d + 0.06), (x + 0.19, cy + 0.08, -d + 0.06), (x, cy + 0.38, -d + 0.06)])
    mesh.write()


def power_line(materials):
    mesh, rng = Mesh("power_line"), random.Random(3)
    last = None
    for k in range(34):
        d = 130 + 47.0 * k
        x = -14.5 + rng.uniform(-0.2, 0.2)
        y, lean = ground_height(x, d), rng.uniform(-0.15, 0.15)
        haze = d
        mesh.use(materials.get("pole", (0.235, 0.165, 0.115), haze))
        mesh.rings([(x, y - 0.5, -d, 0.17), (x + lean, y + 9.6, -d, 0.11)], 6)
        mesh.box(x + lean - 1.25, x + lean + 1.25, y + 8.75, y + 8.90, -d - 0.07, -d + 0.07)
        hooks = []
        for a in (-1.12, -0.45, 1.12):
            mesh.use(materials.get("insulator", (0.50, 0.55, 0.52), haze))
            mesh.box(x + lean + a - 0.05, x + lean + a + 0.05, y + 8.9, y + 9.12, -d - 0.05, -d + 0.05)
            hooks.append((x + lean + a, y + 9.1, -d))
        if k % 4 == 2:
            mesh.use(materials.get("transformer", (0.52, 0.50, 0.47), haze))
            mesh.rings([(x + lean + 0.42, y + 7.1, -d, 0.24), (x + lean + 0.42, y + 8.1, -d, 0.24)], 8)
        if last and d < 950:
            mesh.use(materials.get("cable", (0.09, 0.08, 0.075), haze))
            for p, q in zip(last, hooks):
                points = []
                for j in range(6):
                    t = j / 5
                    points.append((lerp(p[0], q[0], t), lerp(p[1], q[1], t) - 0.75 * 4 * t * (1 - t), lerp(p[2], q[2], t)))
                for a, b in zip(points, points[1:]):
                    mesh.beam(a, b, 0.026)
        last = hooks
    mesh.write()


def truck(materials):
    mesh, d = Mesh("truck"), 335.0
    x, y, z = -1.85, profile(d), -d

    def part(name, color, *b, emission=(0, 0, 0)):
        mesh.use(materials.get(f"truck_{name}", color, d, emission=emission))
        mesh.box(x + b[0], x + b[1], y + b[2], y + b[3], z + b[4], z + b[5])

    red, chrome, black = (0.42, 0.035, 0.022), (0.46, 0.45, 0.44), (0.02, 0.02, 0.022)
    part("trailer", (0.80, 0.78, 0.74), -1.28, 1.28, 1.15, 4.05, -16.0, -3.4)
    part("cab", red, -1.16, 1.16, 1.05, 2.95, -3.0, -0.9)
    part("fairing", red, -1.05, 1.05, 2.95, 3.72, -3.0, -1.3)
    part("visor", (0.40, 0.04, 0.025), -1.12, 1.12, 2.86, 2.98, -0.92, -0.60)
    part("glass", (0.035, 0.045, 0.055), -1.02, -0.04, 2.10, 2.84, -0.92, -0.86)
    part("glass", (0.035, 0.045, 0.055), 0.04, 1.02, 2.10, 2.84, -0.92, -0.86)
    part("hood", red, -0.82, 0.82, 0.95, 2.02, -0.9, 0.75)
    part("grille_frame", chrome, -0.62, 0.62, 0.80, 1.98, 0.75, 0.80)
    part("grille", (0.05, 0.05, 0.05), -0.54, 0.54, 0.88, 1.90, 0.80, 0.82)
    for k in range(6):
        bar = -0.45 + 0.18 * k
        part("grille_bar", chrome, bar - 0.025, bar + 0.025, 0.88, 1.90, 0.82, 0.84)
    for s in (-1, 1):
        a, b = sorted((s * 0.80, s * 1.22))
        part("fender", red, a, b, 0.75, 1.32, -0.7, 0.62)
        part("tyre", black, *sorted((s * 0.86, s * 1.16)), 0.0, 0.98, -0.45, 0.50)
        part("tyre", black, *sorted((s * 0.62, s * 1.22)), 0.0, 1.0, -5.6, -4.6)
        a, b = sorted((s * 0.86, s * 1.16))
        part("lamp_frame", (0.06, 0.055, 0.05), a - 0.06, b + 0.06, 0.86, 1.31, 0.62, 0.70)
        mesh.use(materials.get("headlight", (0.9, 0.9, 0.85), emission=(60.0, 52.0, 38.0)))
        cx, cy = x + s * 1.01, y + 1.085
        mesh.polygon([(cx + 0.165 * math.sin(0.5236 * k), cy + 0.165 * math.cos(0.5236 * k), z + 0.71) for k in range(12)])
        part("stack", chrome, *sorted((s * 1.20, s * 1.34)), 1.2, 4.35, -2.9, -2.76)
        part("mirror", chrome, *sorted((s * 1.28, s * 1.48)), 2.15, 2.75, -1.0, -0.93)
        part("marker_lamp", (0.9, 0.4, 0.05), *sorted((s * 0.72, s * 0.86)), 3.72, 3.80, -1.4, -1.3, emission=(3.0, 1.1, 0.12))
    part("marker_lamp", (0.9, 0.4, 0.05), -0.07, 0.07, 3.72, 3.80, -1.4, -1.3, emission=(3.0, 1.1, 0.12))
    part("bumper", (0.30, 0.29, 0.28), -1.22, 1.22, 0.38, 0.78, 0.72, 0.86)
    mesh.write()


def town(materials):
    mesh = Mesh("town")

    def at(screen, d):
        """x of the place seen `screen` pixels (of 960) right of the vanishing point."""
        return CAMERA_X + screen * d / 6864.0

    # Water tower.
    d = 1320.0
    x, y, z = at(132, d), profile(1320.0) - 0.3, -d
    leg, tank = materials.get("tower_leg", (0.50, 0.47, 0.44), d), materials.get("tower_tank", (0.80, 0.745, 0.66), d)
    mesh.use(leg)
    feet = [(sx * 4.2, sz * 4.2) for sx, sz in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    for fx, fz in feet:
        mesh.beam((x + fx, y, z + fz), (x + fx * 0.72, y + 19.0, z + fz * 0.72), 0.55)
    for level in (0.0, 0.36, 0.70):
        s0, s1 = 1 - 0.28 * level, 1 - 0.28 * (level + 0.33)
        for (ax, az), (bx, bz) in zip(feet, feet[1:] + feet[:1]):
            mesh.beam((x + ax * s0, y + 19 * level, z + az * s0), (x + bx * s1, y + 19 * (level + 0.33), z + bz * s1), 0.16)
            mesh.beam((x + bx * s0, y + 19 * level, z + bz * s0), (x + ax * s1, y + 19 * (level + 0.33), z + az * s1), 0.16)
            mesh.beam((x + ax * s1, y + 19 * (level + 0.33), z + az * s1), (x + bx * s1, y + 19 * (level + 0.33), z + bz * s1), 0.2)
    mesh.rings([(x, y, z, 0.5), (x, y + 19, z, 0.5)], 8)
    mesh.use(tank)
    mesh.rings([(x, y + 16.6, z, 0.8), (x, y + 17.4, z, 2.6), (x, y + 18.6, z, 3.9), (x, y + 19.4, z, 4.2),
                (x, y + 25.2, z, 4.2)], 24)
    mesh.use(materials.get("tower_roof", (0.46, 0.16, 0.09), d))
    mesh.rings([(x, y + 25.1, z, 4.5), (x, y + 25.4, z, 4.5), (x, y + 27.9, z, 0.3), (x, y + 28.6, z, 0.25)], 24)
    mesh.use(leg)
    mesh.rings([(x, y + 19.2, z, 4.9), (x, y + 19.4, z, 4.9), (x, y + 19.4, z, 4.2)], 24, closed=False)

    def house(screen, dist, width, depth, wall, roof, color, roof_color, windows=3):
        hx, hy, hz = at(screen, dist), profile(dist) - 0.4, -dist
        mesh.use(materials.get(f"wall{len(color_names(color))}_{color_names(color)}", color, dist))
        w = width / 2
        mesh.box(hx - w, hx + w, hy, hy + wall, hz - depth, hz)
        mesh.polygon([(hx - w, hy + wall, hz), (hx + w, hy + wall, hz), (hx, hy + roof, hz)])
        mesh.use(materials.get(f"roof_{color_names(roof_color)}", roof_color, dist))
        for s in (-1, 1):
            mesh.polygon([(hx + s * (w + 0.5), hy + wall - 0.4, hz + 0.4), (hx, hy + roof + 0.1, hz + 0.4),
                          (hx, hy + roof + 0.1, hz - depth - 0.4), (hx + s * (w + 0.5), hy + wall - 0.4, hz - depth - 0.4)])
        mesh.use(materials.get("dark", (0.05, 0.045, 0.04), dist))
        for k in range(windows):
            cx = hx - w + width * (k + 0.5) / windows
            tall = wall * (0.62 if k == windows // 2 else 0.3)
            bottom = 0.0 if k == windows // 2 else wall * 0.38
            mesh.box(cx - 0.75, cx + 0.75, hy + bottom, hy + bottom + tall, hz, hz + 0.05)

    def color_names(color):
        return "".join(f"{round(c * 100):02d}" for c in color)

    house(205, 1290, 13, 18, 4.6, 8.2, (0.48, 0.12, 0.075), (0.52, 0.50, 0.47))
    house(278, 1240, 10, 12, 3.4, 5.6, (0.76, 0.68, 0.56), (0.38, 0.20, 0.13), 5)
    house(60, 1420, 12, 10, 3.6, 6.0, (0.70, 0.66, 0.58), (0.36, 0.33, 0.31), 5)
    house(-118, 1380, 17, 10, 4.0, 6.2, (0.74, 0.60, 0.44), (0.42, 0.22, 0.15), 5)
    house(-205, 1450, 11, 10, 3.8, 6.6, (0.62, 0.63, 0.60), (0.30, 0.28, 0.27))
    # Filling station: a canopy on posts.
    d = 1210.0
    x, y = at(-62, d), profile(d) - 0.3
    mesh.use(materials.get("canopy", (0.82, 0.78, 0.72), d))
    mesh.box(x - 6, x + 6, y + 4.6, y + 5.5, -d - 8, -d)
    mesh.use(materials.get("canopy_band", (0.62, 0.08, 0.04), d))
    mesh.box(x - 6.02, x + 6.02, y + 4.75, y + 5.1, -d - 8, -d + 0.05)
    mesh.use(materials.get("canopy_post", (0.60, 0.57, 0.53), d))
    for px in (-4.5, 4.5):
        mesh.box(x + px - 0.2, x + px + 0.2, y, y + 4.6, -d - 4, -d - 3.6)
        mesh.box(x + px * 0.6 - 0.4, x + px * 0.6 + 0.4, y, y + 1.6, -d - 2, -d - 1.2)
    # Silos.
    mesh.use(materials.get("silo", (0.72, 0.70, 0.66), 1300))
    for k in range(2):
        sx, sy = at(236 + 30 * k, 1330), profile(1330.0) - 0.3
        mesh.rings([(sx, sy, -1330, 2.4), (sx, sy + 10, -1330, 2.4), (sx, sy + 11.6, -1330, 0.4)], 16)
    # Cottonwoods: heaps of leaf clumps.
    rng = random.Random(17)
    for screen, dist, size in ((168, 1300, 6.5), (182, 1345, 8.0), (250, 1375, 7.5), (318, 1330, 8.5), (-90, 1430, 7.0),
                               (-160, 1420, 8.0), (-182, 1470, 6.5), (30, 1470, 7.0), (95, 1440, 6.0), (-250, 1480, 7.5)):
        tx, ty = at(screen, dist), profile(dist) - 0.3
        for _ in range(46):
            a, b, c = rng.gauss(0, 0.24), rng.uniform(0.0, 1.0), rng.gauss(0, 0.24)
            spread = math.sin(math.pi * (0.18 + 0.78 * b))
            px, py, pz = tx + a * size * spread, ty + size * (0.14 + 0.86 * b), -dist + c * size * spread
            r = size * rng.uniform(0.07, 0.13)
            mesh.use(materials.get(f"leaf{rng.randrange(3)}", ((0.17, 0.19, 0.065), (0.22, 0.22, 0.08), (0.13, 0.155, 0.06))[rng.randrange(3)], 1400))
            top, low = mesh.vertex(px, py + r, pz), mesh.vertex(px, py - r, pz)
            ring = [mesh.vertex(px + 1.1 * r * math.cos(1.257 * k), py + 0.2 * r * math.sin(3 * k), pz + 1.1 * r * math.sin(1.257 * k)) for k in range(5)]
            for k in range(5):
                mesh.face(ring[k], top, ring[(k + 1) % 5])
                mesh.face(ring[(k + 1) % 5], low, ring[k])
    for k, leaf in enumerate(((0.17, 0.19, 0.065), (0.22, 0.22, 0.08), (0.13, 0.155, 0.06))):
        materials.get(f"leaf{k}", leaf, 1400)
    mesh.write()


def mesas(materials):
    mesh = Mesh("mesas")

    def wall(d, haze, height, screens, rock, seed, rough, step):
        """A range at distance d. height(s): pixels above the vanishing point's horizon over screen position s."""
        scale = d / 6864.0
        base = -6.0
        name = materials.get(f"rock{d:.0f}", rock, haze)
        talus_name = materials.get(f"talus{d:.0f}", tuple(c * f for c, f in zip(rock, (1.05, 1.02, 0.98))), haze)
        columns, s = [], screens[0]
        while s <= screens[1]:
            h = height(s) * scale
            x = CAMERA_X + s * scale
            flute = rough * scale * (fractal(s / 9.0, 0.5, seed, 3) - 0.5) * 2
            gully = rough * scale * 1.6 * (fractal(s / 26.0, 4.5, seed + 5, 2) - 0.5) * 2
            spread = max(h, 0.0)
            cliff = 0.42 if h > 18 * scale else 0.75
            rows = [(x, base, -d + spread * 1.5 + gully, 0.98), (x, base + cliff * h * 0.5, -d + spread * 0.62 + gully, 1.02),
                    (x, base + cliff * h, -d + spread * 0.14 + flute, 1.0), (x, base + lerp(cliff, 1, 0.30) * h, -d + flute * 0.9, 0.86),
                    (x, base + lerp(cliff, 1, 0.52) * h, -d - 0.04 * spread + flute, 1.10),
                    (x, base + lerp(cliff, 1, 0.74) * h, -d - 0.05 * spread + 0.8 * flute, 0.90),
                    (x, base + h, -d - 0.08 * spread + flute * 0.8, 1.06), (x, base + h * 1.0, -d - 40 * scale, 1.0)]
            columns.append([mesh.vertex(a, b, c, (tone, tone * lerp(1, tone, 0.5), tone)) for a, b, c, tone in rows])
            s += step
        for a, b in zip(columns, columns[1:]):
            for k in range(len(a) - 1):
                mesh.use(talus_name if k < 2 else name)
                mesh.face(a[k], b[k], b[k + 1], a[k + 1])

    def table(s, left, right, top, skirt):
        return top * smoothstep(left - skirt, left, s) * (1 - smoothstep(right, right + skirt, s))

    def near_range(s):
        jag = 5.0 * (fractal(s / 14.0, 1.5, 200, 3) - 0.5)
        h = max(table(s, -455, -300, 104, 22), table(s, -292, -205, 82, 12), table(s, -196, -178, 70, 8),
                table(s, -560, -430, 66, 40), 0.0)
        h = max(h, table(s, 40, 62, 58, 7), table(s, 84, 92, 50, 5))
        return (h + jag * min(h / 40, 1)) if h > 1 else 9 * fractal(s / 30, 2.5, 210, 2)

    def far_range(s):
        return (max(table(s, -700, -160, 48, 70), table(s, -130, 20, 40, 30), table(s, 150, 300, 66, 26), table(s, 318, 420, 54, 16), 22)
                + 5 * (fractal(s / 20, 3.5, 220, 3) - 0.5))

    def mountains(s):
        return 52 + 62 * (fractal(s / 230.0 + 7.3, 5.5, 230, 5) - 0.42) + 26 * math.exp(-((s - 120) / 130.0) ** 2)

    wall(4600.0, 3600.0, near_range, (-640, 400), (0.56, 0.245, 0.125), 240, 6.0, 5.0)
    wall(8200.0, 8200.0, far_range, (-640, 400), (0.50, 0.26, 0.16), 250, 7.0, 9.0)
    wall(16000.0, 17000.0, mountains, (-660, 420), (0.34, 0.25, 0.24), 260, 9.0, 9.0)
    mesh.write()


def main():
    materials = Materials()
    for make in (ground, road, bushes, roadside, power_line, truck, town, mesas):
        make(materials)
    materials.write()
    textures()


if __name__ == "__main__":
    main()
