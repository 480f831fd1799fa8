#!/usr/bin/env python3
"""Draws what `taut run --poses poses.csv` wrote as an SVG: each body as a stroke along its x axis, older instants paler.

    taut run net-flag --poses poses.csv --poses-interval 0.25
    scenes/examples/pictures/draw.py poses.csv net.svg --length 0.1
"""
import argparse
import csv
import math


def rotate(q, v):
    """R(q) v with q = (w, x, y, z)."""
    w, x, y, z = q
    t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])]
    return [v[0] + w * t[0] + y * t[2] - z * t[1],
            v[1] + w * t[1] + z * t[0] - x * t[2],
            v[2] + w * t[2] + x * t[1] - y * t[0]]


def read(file):
    """[(time, [(body, p, q), ...]), ...]"""
    frames = {}
    with open(file, newline="") as lines:
        for row in csv.DictReader(lines):
            p = [float(row[k]) for k in ("px", "py", "pz")]
            q = [float(row[k]) for k in ("qw", "qx", "qy", "qz")]
            frames.setdefault(float(row["time"]), []).append((row["body"], p, q))
    return sorted(frames.items())


def corners(p, q, points):
    return [[a + b for a, b in zip(p, rotate(q, point))] for point in points]


def outline(name, p, q, options):
    """World points of the polyline that stands for a body."""
    for box in options.box:
        box_name, size = box.split(":")
        if name == box_name:
            x, z = (float(s) / 2 for s in size.split("x"))
            return corners(p, q, [[-x, 0, -z], [x, 0, -z], [x, 0, z], [-x, 0, z], [-x, 0, -z]])
    return corners(p, q, [[-options.length / 2, 0, 0], [options.length / 2, 0, 0]])


def project(point, azimuth, elevation):
    """Parallel projection; seen along +y for azimuth and elevation 0."""
    x, y, z = point
    ca, sa, ce, se = math.cos(azimuth), math.sin(azimuth), math.cos(elevation), math.sin(elevation)
    return ca * x + sa * y, -(ce * z + se * (-sa * x + ca * y))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("poses")
    parser.add_argument("svg")
    parser.add_argument("--length", type=float, default=0.1, help="length of a body along its x axis [m]")
    parser.add_argument("--box", action="append", default=[], metavar="NAME:XxZ", help="body drawn as a box [m]")
    parser.add_argument("--azimuth", type=float, default=0, help="[degrees]")
    parser.add_argument("--elevation", type=float, default=0, help="[degrees]")
    parser.add_argument("--width", type=float, default=900, help="[px]")
    options = parser.parse_args()

    view = math.radians(options.azimuth), math.radians(options.elevation)
    frames = [(time, [[project(point, *view) for point in outline(*body, options)] for body in bodies])
              for time, bodies in read(options.poses)]
    everything = [point for _, lines in frames for line in lines for point in line]
    left, right = min(p[0] for p in everything), max(p[0] for p in everything)
    top, bottom = min(p[1] for p in everything), max(p[1] for p in everything)
    scale = (options.width - 40) / (right - left)
    height = (bottom - top) * scale + 40

    with open(options.svg, "w") as out:
        out.write(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {options.width:.0f} {height:.0f}">\n'
                  '<rect width="100%" height="100%" fill="#ffffff"/>\n')
        for i, (time, lines) in enumerate(frames):
            age = (len(frames) - 1 - i) / max(1, len(frames) - 1)
            red, green, blue = (round(c + (d - c) * age) for c, d in ((16, 205), (62, 216), (110, 228)))
            out.write(f'<g fill="none" stroke="#{red:02x}{green:02x}{blue:02x}" stroke-width="{1.4 if age else 2:g}" '
                      f'stroke-linecap="round"><title>t = {time:.3g} s</title><path d="')
            for line in lines:
                out.write("M" + "L".join(f"{20 + (x - left) * scale:.1f} {20 + (y - top) * scale:.1f}" for x, y in line))
            out.write('"/></g>\n')
        out.write("</svg>\n")


if __name__ == "__main__":
    main()
