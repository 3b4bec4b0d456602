#!/usr/bin/env python3
"""Makes the meshes, materials and sky of ../mirage.toml beside itself. Needs nothing but Python 3; always the same bytes.

World: metres, y up, the plain is y = 0, the road runs along -z and is centred on x = 0; d = -z is the distance.
Distance haze is part of the materials: a colour c seen through a transmission t becomes Kd = t c, Ke = (1 - t) haze.
"""
import math
import pathlib
import random
import struct
import zlib

HERE = pathlib.Path(__file__).resolve().parent
HAZE = (0.50, 0.60, 0.70)
HAZE_LENGTH = 7500.0
ROAD = 3.7  # half its width [m]
FAR = 10000.0


class Mesh:
    def __init__(self, name):
        self.name, self.out, self.count, self.uvs = name, ["mtllib mirage.mtl"], 0, 0

    def use(self, material):
        self.out.append(f"usemtl {material}")

    def quad(self, points, uvs=None):
        for x, y, z in points:
            self.out.append(f"v {x:.2f} {y:.2f} {z:.2f}")
        corners = [self.count + k + 1 for k in range(len(points))]
        self.count += len(points)
        if uvs:
            self.out += [f"vt {u:.3f} {v:.3f}" for u, v in uvs]
            corners = [f"{c}/{self.uvs + k + 1}" for k, c in enumerate(corners)]
            self.uvs += len(uvs)
        self.out.append("f " + " ".join(str(c) for c in corners))

    def box(self, x0, x1, y0, y1, d0, d1):
        """Its five sides above the ground, d0 nearer."""
        z0, z1 = -d0, -d1
        self.quad([(x0, y0, z0), (x1, y0, z0), (x1, y1, z0), (x0, y1, z0)])
        self.quad([(x1, y0, z1), (x0, y0, z1), (x0, y1, z1), (x1, y1, z1)])
        self.quad([(x0, y0, z1), (x0, y0, z0), (x0, y1, z0), (x0, y1, z1)])
        self.quad([(x1, y0, z0), (x1, y0, z1), (x1, y1, z1), (x1, y1, z0)])
        self.quad([(x0, y1, z0), (x1, y1, z0), (x1, y1, z1), (x0, y1, z1)])

    def write(self):
        (HERE / f"{self.name}.obj").write_text("\n".join(self.out) + "\n")


class Materials:
    """The one material library; materials are made as they are asked for."""

    def __init__(self):
        self.lines = {}

    def get(self, name, color, d=0.0, texture=None, emission=(0, 0, 0)):
        t = math.exp(-d / HAZE_LENGTH)
        key = f"{name}_{d:.0f}"
        kd = " ".join(f"{c * t:.4f}" for c in color)
        ke = " ".join(f"{e + h * (1 - t):.4f}" for e, h in zip(emission, HAZE))
        self.lines[key] = f"newmtl {key}\nKd {kd}\nKe {ke}\n" + (f"map_Kd {texture}\n" if texture else "")
        return key

    def write(self):
        (HERE / "mirage.mtl").write_text("\n".join(self.lines[k] for k in sorted(self.lines)))


def plain(materials):
    """Sand, asphalt and its markings side by side in one plane: nothing lies on anything."""
    mesh = Mesh("plain")
    edges = [30.0]
    while edges[-1] < FAR:
        edges.append(edges[-1] * 1.12 + 2)
    strips = [("sand", (0.52, 0.41, 0.29), -400, -ROAD, "../plate/sand.png"),
              ("asphalt", (0.26, 0.26, 0.27), -ROAD, -3.5, "../plate/asphalt.png"),
              ("line", (0.80, 0.80, 0.76), -3.5, -3.35, None),
              ("asphalt", (0.26, 0.26, 0.27), -3.35, -0.09, "../plate/asphalt.png"),
              (None, None, -0.09, 0.09, None),
              ("asphalt", (0.26, 0.26, 0.27), 0.09, 3.35, "../plate/asphalt.png"),
              ("line", (0.80, 0.80, 0.76), 3.35, 3.5, None),
              ("asphalt", (0.26, 0.26, 0.27), 3.5, ROAD, "../plate/asphalt.png"),
              ("sand", (0.52, 0.41, 0.29), ROAD, 400, "../plate/sand.png")]

    def strip(name, color, x0, x1, texture, d0, d1, d):
        mesh.use(materials.get(name, color, d, texture))
        corners = [(x0, 0, -d0), (x1, 0, -d0), (x1, 0, -d1), (x0, 0, -d1)]
        mesh.quad(corners, [(x / 6, -z / 60) for x, _, z in corners] if texture else None)

    for d0, d1 in zip(edges, edges[1:]):
        d = 50 * round((d0 + d1) / 100)
        for name, color, x0, x1, texture in strips:
            reach = max(1.0, d1 / 400)  # sand as wide as the view and more
            if name:
                strip(name, color, x0 * reach if x0 < -ROAD else x0, x1 * reach if x1 > ROAD else x1, texture, d0, d1, d)
    d = edges[0]
    while d < 4000:  # dashed centre line: 5 m of paint, 9 m without
        for name, color, texture, length in (("line", (0.80, 0.80, 0.76), None, 5), ("asphalt", (0.26, 0.26, 0.27),
                                                                                    "../plate/asphalt.png", 9)):
            strip(name, color, -0.09, 0.09, texture, d, d + length, 50 * round(d / 50))
            d += length
    strip("asphalt", (0.26, 0.26, 0.27), -0.09, 0.09, "../plate/asphalt.png", d, edges[-1], 8000)
    mesh.write()


def roadside(materials):
    """Marker posts every 100 m, poles on the left every 110 m, a few bushes."""
    mesh, rng = Mesh("roadside"), random.Random(3)
    for d in range(100, 1600, 100):
        for x in (-5.2, 5.2):
            mesh.use(materials.get("post", (0.82, 0.82, 0.78), d))
            mesh.box(x - 0.07, x + 0.07, 0, 0.72, d, d + 0.1)
            mesh.box(x - 0.07, x + 0.07, 0.9, 1.05, d, d + 0.1)
            mesh.use(materials.get("black", (0.03, 0.03, 0.03), d))
            mesh.box(x - 0.071, x + 0.071, 0.72, 0.9, d, d + 0.1)
    for d in range(430, 2600, 110):
        mesh.use(materials.get("wood", (0.17, 0.12, 0.08), d))
        mesh.box(-14.16, -13.84, 0, 8.2, d, d + 0.3)
        mesh.box(-15.2, -12.8, 7.4, 7.62, d, d + 0.2)
    for _ in range(90):
        d = 130 * math.exp(rng.random() * 2.6)
        x = rng.choice((-1, 1)) * (7 + rng.random() ** 1.5 * 0.05 * d)
        r = 0.25 + 0.45 * rng.random()
        c = rng.uniform(0.8, 1.2)
        mesh.use(materials.get(f"bush{int(c * 10)}", (0.20 * c, 0.21 * c, 0.10 * c), 100 * round(d / 100)))
        sides = 7
        for (r0, y0), (r1, y1) in zip([(0.7, 0), (1, 0.45), (0.7, 0.85)], [(1, 0.45), (0.7, 0.85), (0.05, 1.0)]):
            for k in range(sides):
                a, b = (2 * math.pi * (k + j) / sides for j in (0, 1))
                mesh.quad([(x + r * q * math.sin(t), r * y, -d + r * q * math.cos(t))
                           for t, q, y in ((a, r0, y0), (b, r0, y0), (b, r1, y1), (a, r1, y1))])
    mesh.write()


def car(materials):
    """A red estate car that drives away."""
    mesh, d, x = Mesh("car"), 620.0, 1.8
    mesh.use(materials.get("red", (0.42, 0.035, 0.025), d))
    mesh.box(x - 0.9, x + 0.9, 0.32, 0.98, d, d + 4.4)
    mesh.box(x - 0.74, x + 0.74, 1.36, 1.46, d + 0.25, d + 2.6)
    for side in (-0.74, 0.66):
        mesh.box(x + side, x + side + 0.08, 0.98, 1.36, d + 0.2, d + 0.3)
    mesh.use(materials.get("glass", (0.05, 0.07, 0.09), d, emission=(0.03, 0.04, 0.05)))
    mesh.box(x - 0.70, x + 0.70, 0.98, 1.36, d + 0.22, d + 2.6)
    mesh.use(materials.get("black", (0.03, 0.03, 0.03), d))
    for side in (-0.88, 0.64):
        mesh.box(x + side, x + side + 0.24, 0.0, 0.6, d + 0.4, d + 1.0)
    mesh.use(materials.get("lamp", (0.5, 0.02, 0.01), d, emission=(1.4, 0.05, 0.02)))
    for side in (-0.86, 0.62):
        mesh.box(x + side, x + side + 0.24, 0.72, 0.92, d - 0.02, d)
    mesh.use(materials.get("plate", (0.8, 0.8, 0.8), d))
    mesh.box(x - 0.26, x + 0.26, 0.50, 0.61, d - 0.02, d)
    mesh.write()


def hills(materials):
    """Three ridges that leave a gap where the road goes."""
    mesh, rng = Mesh("hills"), random.Random(11)
    for d, height, gap, color in ((4750, 55, 0.001, (0.22, 0.20, 0.21)), (3600, 38, 0.007, (0.25, 0.20, 0.17)),
                                  (2700, 22, 0.012, (0.26, 0.19, 0.13))):
        mesh.use(materials.get("hill", color, d))
        phases = [(k, rng.random() * 2 * math.pi, rng.uniform(0.6, 1.0)) for k in (35, 80, 170, 390, 900)]
        count, edge = 420, 0.045
        crest = []
        for i in range(count + 1):
            s = edge * (2 * i / count - 1)  # slope across the view
            rough = sum(a * math.sin(k * s * 2 + p) / k for k, p, a in phases) * 34
            away = abs(s + 0.001) - gap
            rise = min(max(away / 0.010, 0.0), 1.0)
            y = height * (0.03 + 0.97 * rise * rise * (3 - 2 * rise)) * max(0.6 + 0.4 * rough, 0.05)
            crest.append((s * d, y))
        for (x0, y0), (x1, y1) in zip(crest, crest[1:]):
            mesh.quad([(x0, -2, -d), (x1, -2, -d), (x1, y1, -d - 3 * y1), (x0, y0, -d - 3 * y0)])
    mesh.write()


def png(name, width, height, pixel):
    """pixel(y): linear colour of a row; 16-bit sRGB codes."""
    def code(c):
        return round(65535 * (12.92 * c if c <= 0.0031308 else 1.055 * c ** (1 / 2.4) - 0.055))
    raw = b"".join(b"\0" + struct.pack(">3H", *map(code, pixel(y))) * width for y in range(height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    (HERE / name).write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", width, height, 16, 2, 0, 0, 0)) +
                              chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b""))


def sky():
    rows = 4096

    def color(y):
        e = 180 * (0.5 - (y + 0.5) / rows)  # elevation [degrees]
        if e < 0:
            return HAZE
        a = 1 - math.exp(-e / 0.7)
        b = 1 - math.exp(-e / 14)
        low, middle, high = HAZE, (0.30, 0.46, 0.72), (0.10, 0.22, 0.50)
        return tuple(l + (m - l) * a + (h - m) * b * a for l, m, h in zip(low, middle, high))
    png("sky.png", 2, rows, color)


def main():
    materials = Materials()
    for make in (plain, roadside, car, hills):
        make(materials)
    materials.write()
    sky()


if __name__ == "__main__":
    main()
