#!/usr/bin/env python3
"""The charts of `apertura stability`, from the tables that it left in a folder.

stability_charts.py DIR
"""
import csv
import pathlib
import sys

try:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
except ImportError:
    sys.exit("apertura: matplotlib is missing (Debian: python3-matplotlib); the tables are there, the charts are not")

plt.rcParams.update({"font.size": 8, "figure.constrained_layout.use": True})


def read(folder, name):
    return list(csv.DictReader(open(folder / name, newline="")))


def label(row):
    return row["model"] + (" (baseline)" if row["baseline"] == "1" else "")


def table(folder, stem, title, rows, columns, value, top, good):
    """A table in colours: models down, `columns` across; darker is worse, `good` is the bound."""
    models = list(dict.fromkeys(label(r) for r in rows))
    names = list(dict.fromkeys(r[columns] for r in rows))
    figure, axes = plt.subplots(figsize=(2.2 + 0.52 * len(names), 2.6 + 0.22 * len(models)))
    grid = [[0.0] * len(names) for _ in models]
    for row in rows:
        y, x = models.index(label(row)), names.index(row[columns])
        grid[y][x] = max(grid[y][x], value(row))
    axes.imshow(grid, cmap="YlOrRd", vmin=0, vmax=top, aspect="auto")
    for y, line in enumerate(grid):
        for x, v in enumerate(line):
            axes.text(x, y, ("NaN" if v >= 1e6 else ">10" if v > 10 else f"{v:.2f}" if v >= 0.1 else f"{v:.3f}"), ha="center", va="center", fontsize=6,
                      weight="normal" if v <= good else "bold", color="white" if v > 0.7 * top else "black")
    axes.set_xticks(range(len(names)), names, rotation=40, ha="right")
    axes.set_yticks(range(len(models)), models)
    axes.set_title(title, fontsize=8, loc="left")
    for kind in ("png", "svg"):
        figure.savefig(folder / f"{stem}.{kind}", dpi=130, metadata={"Date": None} if kind == "svg" else None)
    plt.close(figure)


def failure_map(folder, rows):
    models = list(dict.fromkeys(r["model"] for r in rows))
    lights = sorted({float(r["light_radius_deg"]) for r in rows})
    figure, grid = plt.subplots(len(models), len(lights), figsize=(2.2 * len(lights), 1.25 * len(models) + 0.6), squeeze=False,
                                sharex=True, sharey=True)
    for line, model in zip(grid, models):
        for axes, light in zip(line, lights):
            here = [r for r in rows if r["model"] == model and float(r["light_radius_deg"]) == light]
            radii = sorted({float(r["aperture_radius_deg"]) for r in here})
            distances = sorted({float(r["distance"]) for r in here})
            value = {(float(r["aperture_radius_deg"]), float(r["distance"])): float(r["error"]) for r in here}
            shown = axes.pcolormesh(radii, distances, [[value[(a, d)] for a in radii] for d in distances], cmap="inferno", vmin=0, vmax=0.3,
                                    shading="nearest")
            axes.set_xscale("log")
            if axes in grid[0]:
                axes.set_title(f"light {light:g}°", fontsize=8)
        line[0].set_ylabel(model, fontsize=7)
    figure.supxlabel("aperture radius, degrees", fontsize=8)
    figure.supylabel("distance of the axes / sum of the radii", fontsize=8)
    figure.colorbar(shown, ax=grid, shrink=0.4, label="error, in shares of the smaller cap")
    figure.savefig(folder / "failures.png", dpi=110)
    plt.close(figure)


def decode_chart(folder, rows):
    """What 8 and 16 bits do to the axis and the radius, and the bounds that `info` prints."""
    figure, grid = plt.subplots(1, 2, figsize=(9, 3.6))
    for bits, style in (("8", "-"), ("16", "--")):
        here = [r for r in rows if r["bits"] == bits]
        for capness, colour in (("1", "C0"), ("0.4", "C1"), ("0.1", "C2")):
            line = [r for r in here if r["capness"] == capness]
            x = [float(r["open"]) for r in line]
            grid[0].plot(x, [float(r["axis_deg"]) for r in line], style, color=colour, lw=1.2, label=f"{bits} bits, |D| {capness} of a cap's")
            grid[0].plot(x, [float(r["axis_bound_deg"]) for r in line], ":", color=colour, lw=0.8)
        line = [r for r in here if r["capness"] == "1"]
        grid[1].plot([float(r["open"]) for r in line], [max(float(q["radius_deg"]) for q in here if q["open"] == r["open"]) for r in line], style,
                     color="C3", lw=1.2, label=f"{bits} bits")
        grid[1].axhline(float(here[0]["radius_bound_deg"]), ls=":", color="C3", lw=0.8)
    for axes, what in zip(grid, ("axis", "radius")):
        axes.set(xscale="log", yscale="log", xlabel="open, of the hemisphere", ylabel=f"largest error of the {what}, degrees")
        axes.set_title(f"{what}; dotted: the bound", fontsize=8, loc="left")
        axes.legend(fontsize=5.5, ncol=2, loc="center")
        axes.grid(alpha=0.3)
    figure.savefig(folder / "decode.png", dpi=130)
    plt.close(figure)


def main(folder):
    sweeps = read(folder, "sweeps.csv")
    table(folder, "sweep-errors", "Largest error in shares of the smaller of light and opening; bold: over 0.015", sweeps, "sweep",
          lambda r: 1e9 if int(r["not_finite"]) else float(r["error"]), 0.5, 0.015)
    moving = [r for r in sweeps if float(r["exact_step"]) > 0.01]
    table(folder, "sweep-steps", "Largest step between frames as a multiple of the exact one; bold: over 1.3", moving, "sweep",
          lambda r: float(r["step"]) / float(r["exact_step"]), 2.5, 1.3)
    steps = read(folder, "scenes.csv")
    for row in steps:
        row["light"] = f"{float(row['light_radius_deg']):g}°"
    table(folder, "scene-steps", "Largest step of a light over the built-in scenes,\nas a multiple of what its rim sweeps; bold: over 1", steps, "light",
          lambda r: min(float(r["step"]), 99), 2.5, 1.005)
    failure_map(folder, read(folder, "map.csv"))
    decode_chart(folder, read(folder, "decode.csv"))
    halves = read(folder, "half.csv")
    if halves:
        for row in halves:
            row["light"] = f"{float(row['light_radius_deg']):g}°"
        table(folder, "half", "What 16-bit floats add: RMS of E / (L π sin²r)", halves, "light",
              lambda r: 9.99 if int(r["not_finite"]) else float(r["rms"]), 0.02, 0.01)
    mixing = read(folder, "mixing.csv")
    if mixing:
        table(folder, "mixing", "How far the light of what is mixed leaves that of the ends", mixing, "between",
              lambda r: max(float(r["below"]), float(r["above"])), 1, 0.02)


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
