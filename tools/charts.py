#!/usr/bin/env python3
"""The charts and the page of `apertura chart`, from the models.csv and maps.csv that it left in a folder.

charts.py DIR
"""
import base64
import csv
import datetime
import html
import json
import pathlib
import sys

try:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.text import Text
except ImportError:
    sys.exit("apertura: matplotlib is missing (Debian: python3-matplotlib); models.csv is there, the charts are not")

LINEAR_TO = 300     # cycles: an axis is linear up to here and logarithmic beyond
BASELINES = {"unshadowed"}  # left out of the charts
matplotlib.rcParams["svg.hashsalt"] = "apertura"  # the same bytes from the same table
plt.rcParams.update({"font.size": 9, "axes.grid": True, "grid.alpha": 0.25, "figure.constrained_layout.use": True})


def read(path):
    rows = list(csv.DictReader(open(path, newline="")))
    for row in rows:
        for key, value in row.items():
            if key not in ("scene", "model", "source", "at"):
                row[key] = float(value) if value else None
    return rows


def name(row):
    """A model, and how `bake` made it where there are two ways: soft (sh-fit), anti (fit)."""
    return row["model"] if row["source"] == "sh" or row["model"] not in ("soft", "anti") else f"{row['model']} ({row['source']})"


def mean(values):
    values = list(values)
    return None if not values or any(v is None for v in values) else sum(values) / len(values)


def means(rows, radius):
    """One entry a model: the mean over the scenes of all its columns (of edges, over those that have any), and the largest leaks, for lights of one radius."""
    out = {}
    for row in rows:
        if row["light_radius_deg"] == radius:
            out.setdefault(name(row), []).append(row)
    def drawn(values):
        return mean(v for v in values if v is not None)
    def spread(values):
        values = list(values)
        return sum(v * v for v in values) ** 0.5 / len(values)
    return {model: {key: (max if key.startswith("leak") else drawn if key == "whole_edge" else spread if key == "rmse_spread" else mean)(r[key] for r in found) for key in found[0] if key not in ("scene", "model", "source")}
            for model, found in out.items()}


def front(points):
    """The points that no other is both cheaper and better than, by cost."""
    out, best = [], float("inf")
    for cost, error, label in sorted(points):
        if error < best:
            out.append((cost, error, label))
            best = error
    return out


def place_labels(axes, labels):
    """Writes a text beside each point where it covers no other text and no other point, or as near to that as it gets."""
    figure = axes.figure
    figure.canvas.draw()
    renderer = figure.canvas.get_renderer()
    points = [axes.transData.transform((x, y)) for x, y, _, _ in labels]
    frame, taken = axes.get_window_extent(renderer), []
    around = ((5, 4), (5, -10), (-5, 4), (-5, -10), (0, 7), (0, -13))
    shifts = [(dx * wide, dy * high) for high in (1, 2.2, 3.6, 5.2, 7, 9) for wide in (1, 4) for dx, dy in around]
    for (x, y, text, colour), at in sorted(zip(labels, points), key=lambda pair: -pair[0][1]):
        best = None
        for rank, (dx, dy) in enumerate(shifts):
            shown = axes.annotate(text, (x, y), xytext=(dx, dy), textcoords="offset points", fontsize=7, color=colour, va="bottom",
                                  ha="left" if dx > 0 else "right" if dx < 0 else "center",
                                  arrowprops={"arrowstyle": "-", "lw": 0.4, "color": "#aaa", "shrinkA": 0, "shrinkB": 2} if max(abs(dx), abs(dy)) > 13 else None)
            shown.update_positions(renderer)
            box = Text.get_window_extent(shown, renderer).expanded(1.02, 1.05)  # without its line
            overlap = sum(box.overlaps(other) for other in taken) + sum(box.contains(*p) for p in points)
            outside = not (frame.contains(box.x0, box.y0) and frame.contains(box.x1, box.y1))
            score = (overlap + outside, rank)
            if best is None or score < best[0]:
                if best:
                    best[1].remove()
                best = (score, shown, box)
            else:
                shown.remove()
            if score[0] == 0:
                break
        taken.append(best[2])


def scatter(axes, table, column, label, log=False):
    points = [(row[column], row["rmse"], model) for model, row in table.items()
              if row[column] is not None and model not in BASELINES and (column != "bytes" or model != "shadow-map")]
    if not points:
        axes.text(0.5, 0.5, "not measured on this machine", ha="center", transform=axes.transAxes)
        return []
    best = front(points)
    axes.step([p[0] for p in best], [p[1] for p in best], where="post", color="tab:red", lw=1, zorder=1)
    chosen = {p[2] for p in best}
    for cost, error, model in points:
        colour = "tab:red" if model in chosen else "tab:gray"
        axes.plot(cost, error, "o", ms=5, color=colour, mfc="white" if table[model]["baseline"] else colour, zorder=2)
        if table[model]["rmse_spread"]:
            axes.errorbar(cost, error, yerr=table[model]["rmse_spread"], color=colour, lw=0.6, zorder=1)
    noise = mean(row["noise"] for row in table.values())
    axes.axhspan(0, noise, color="tab:blue", alpha=0.2, lw=0)
    axes.set(xlabel=label, ylabel="RMSE of E / (L π sin²r)", ylim=(0, None))
    if column.startswith("cycles"):
        axes.set_xscale("symlog", linthresh=LINEAR_TO, linscale=1.5)
        axes.set_xlim(0, 1.6 * max(p[0] for p in points))
        ticks = [0, 50, 100, 150, 200, 250, 300] + [t for t in (500, 1000, 2000, 4000) if t < 1.6 * max(p[0] for p in points)]
        axes.set_xticks(ticks, [str(t) for t in ticks])
        axes.minorticks_off()
    elif log:
        axes.set_xscale("log")
    place_labels(axes, [(cost, error, model, "black" if model in chosen else "dimgray") for cost, error, model in points])
    return best


def save(figure, folder, stem):
    for kind in ("png", "svg"):
        figure.savefig(folder / f"{stem}.{kind}", dpi=130, metadata={"Date": None} if kind == "svg" else None)
    plt.close(figure)


def cost_charts(rows, radius, folder):
    table = means(rows, radius)
    costs = [("cycles_pixel_navi21", "cycles a pixel above N·L, RDNA2 (navi21)", True),
             ("cycles_pixel_polaris10", "cycles a pixel above N·L, GCN4 (polaris10)", True),
             ("bytes", "bytes a sample in the asset, 8 bits a number; a rival's own", False),
             ("frame_ratio", "time of a frame on this machine's device / N·L", False),
             ("bake_ratio", "bake time / four SH coefficients, 256 rays", True)]
    fronts = {}
    for column, label, log in costs:
        figure, axes = plt.subplots(figsize=(8.5, 5.6))
        fronts[column] = scatter(axes, table, column, label, log)
        axes.set_title(f"Light radius {radius:g}°, mean over the scenes; red: nothing is cheaper and better; hollow: rivals; bars: what other receivers change", fontsize=8)
        save(figure, folder, "error-" + column.replace("_", "-"))
    return table, fronts


def scene_chart(rows, radius, folder):
    models = list(dict.fromkeys(name(r) for r in rows))
    scenes = list(dict.fromkeys(r["scene"] for r in rows))
    value = {(name(r), r["scene"]): r["rmse"] for r in rows if r["light_radius_deg"] == radius}
    figure, axes = plt.subplots(figsize=(1.6 + 0.85 * len(scenes), 1.2 + 0.26 * len(models)))
    grid = [[value.get((m, s), float("nan")) for s in scenes] for m in models]
    axes.imshow(grid, cmap="YlOrRd", vmin=0, vmax=0.25, aspect="auto")
    axes.set_xticks(range(len(scenes)), [s.removeprefix("builtin:") for s in scenes], rotation=35, ha="right")
    axes.set_yticks(range(len(models)), models)
    axes.grid(False)
    for y, line in enumerate(grid):
        for x, v in enumerate(line):
            axes.text(x, y, f"{v:.3f}", ha="center", va="center", fontsize=7, color="white" if v > 0.17 else "black")
    axes.set_title(f"RMSE by scene, light radius {radius:g}°", fontsize=9)
    save(figure, folder, "scenes")


def leak_chart(rows, radius, folder):
    """What each model lets through where truth is blocked."""
    table = means(rows, radius)
    order = sorted(table, key=lambda m: -table[m]["leak_99"])
    figure, axes = plt.subplots(figsize=(7.5, 1 + 0.24 * len(order)))
    axes.barh(order, [table[m]["leak_max"] for m in order], color="#ddd", label="the largest")
    axes.barh(order, [table[m]["leak_99"] for m in order], color="#c55", label="one in a hundred is above it, in the worst scene")
    axes.set(xlabel="E / (L π sin²r)", xlim=(0, 1))
    axes.legend(fontsize=7)
    axes.set_title(f"Light through what blocks all of it, light radius {radius:g}°", fontsize=9)
    save(figure, folder, "leaks")


def mottle_chart(rows, folder):
    """What each model errs from one stored point to the next, where truth is even. False where nothing was measured between them."""
    found = {}
    for radius in sorted({r["light_radius_deg"] for r in rows}):
        table = {model: row["whole_mottle"] for model, row in means(rows, radius).items() if row["whole_mottle"] is not None}
        if table:
            found[radius] = table
    if not found:
        return False
    small, large = min(found), max(found)
    order = sorted(found[small], key=lambda m: -found[small][m])
    figure, axes = plt.subplots(figsize=(7.5, 1.2 + 0.24 * len(order)))
    axes.barh(order, [found[small][m] for m in order], color="#999", height=0.8, label=f"light radius {small:g}°")
    axes.barh(order, [found[large][m] for m in order], color="#c55", height=0.4, label=f"{large:g}°")
    axes.set(xlabel="RMS of the error less its mean within two edges, E / (L π sin²r)", xlim=(0, None))
    axes.legend(fontsize=7)
    axes.set_title("Mottle: error that changes from point to point where truth does not, mean over the scenes", fontsize=9)
    save(figure, folder, "mottle")
    return True


def bounce_chart(rows, radius, folder):
    """What the sky errs by where its light bounces from surface to surface. False where that was not measured."""
    table = {model: row for model, row in means(rows, radius).items() if row["ambient_unbounced"] is not None and row["ambient_bounced"] is not None}
    if not table:
        return False
    order = sorted(table, key=lambda m: -table[m]["ambient_bounced"])
    figure, axes = plt.subplots(figsize=(7.5, 1.2 + 0.24 * len(order)))
    axes.barh(order, [table[m]["ambient_unbounced"] for m in order], color="#ddd", height=0.8, label="without what surfaces reflect")
    axes.barh(order, [table[m]["ambient_bounced"] for m in order], color="#c55", height=0.4, label="with it, from the openness alone")
    axes.set(xlabel="RMSE of the sky's E / π", xlim=(0, None))
    axes.legend(fontsize=7)
    axes.set_title("Light of the sky that bounces 8 times, from surfaces of albedo .5, mean over the scenes", fontsize=9)
    save(figure, folder, "bounces")
    return True


def place_chart(places, folder):
    """What `soft` errs by where it is stored, against its bytes. False where that was not measured."""
    if not places:
        return False
    figure, axes = plt.subplots(figsize=(7.5, 4.6))
    for at, marker, colour in (("vertices", "o", "#999"), ("faces", "s", "#c55"), ("texels", "^", "#37a")):
        found = [p for p in places if p["at"] == at]
        axes.scatter([p["bytes"] for p in found], [p["rmse"] for p in found], marker=marker, color=colour, label=at, zorder=3)
    for scene in sorted({p["scene"] for p in places}):
        own = sorted((p for p in places if p["scene"] == scene), key=lambda p: p["bytes"])
        images = [p for p in own if p["at"] == "texels"]
        axes.plot([p["bytes"] for p in images], [p["rmse"] for p in images], color="#37a", linewidth=0.7)
        for p in images:
            if p["texels"]:
                axes.annotate(f"{p['texels']:g}²", (p["bytes"], p["rmse"]), fontsize=6, color="#37a", xytext=(0, -10), textcoords="offset points", ha="center")
        axes.plot([own[0]["bytes"], own[-1]["bytes"]], [own[0]["own_rmse"]] * 2, color="#bbb", linewidth=0.7, linestyle=":")
        axes.annotate(scene.removeprefix("builtin:").split("/")[-1], (own[-1]["bytes"], own[-1]["rmse"]), fontsize=7, xytext=(-2, 6), textcoords="offset points", ha="right")
    axes.set(xscale="log", xlabel="bytes of visibility in the file; dotted: what the model itself errs", ylabel="RMSE of E / (L π sin²r), light radius 5°", ylim=(0, None))
    axes.legend(fontsize=7)
    axes.set_title("Where visibility is stored: soft at vertices, on faces, in images", fontsize=9)
    save(figure, folder, "places")
    return True


def radius_chart(rows, folder):
    radii = sorted({r["light_radius_deg"] for r in rows})
    figure, axes = plt.subplots(figsize=(7.5, 4.6))
    tables = [means(rows, radius) for radius in radii]
    colours = [plt.get_cmap("tab20")(k) for k in list(range(0, 20, 2)) + list(range(1, 20, 2))]
    for k, model in enumerate(m for m in tables[0] if m not in BASELINES):
        axes.plot(radii, [t[model]["rmse"] for t in tables], "-o" if k < len(colours) else "--s", ms=3, lw=1, color=colours[k % len(colours)],
                  label=model)
    # From the top as the lines end, so that the eye finds them.
    handles, names = axes.get_legend_handles_labels()
    order = sorted(range(len(names)), key=lambda i: -tables[-1][names[i]]["rmse"])
    axes.plot(radii, [mean(row["noise"] for row in t.values()) for t in tables], "k:", lw=1, label="the truth's own noise")
    axes.set(xlabel="light radius, degrees", ylabel="RMSE of E / (L π sin²r)", xscale="log", ylim=(0, None))
    axes.set_xticks(radii, [f"{r:g}" for r in radii])
    axes.minorticks_off()
    noise = axes.legend(fontsize=7, handles=[axes.lines[-1]], loc="upper right")
    axes.add_artist(noise)
    axes.legend([handles[i] for i in order], [names[i] for i in order], fontsize=6, loc="upper left", bbox_to_anchor=(1.01, 1.01))
    axes.set_title("Error by the size of the light, mean over the scenes", fontsize=9)
    save(figure, folder, "error-by-radius")


def map_chart(maps, folder):
    groups = {}
    for row in maps:
        groups.setdefault((name(row), row["scene"]), []).append(row)
    groups = {key: found for key, found in groups.items() if key[0] not in BASELINES}
    if not groups:
        return False
    columns = 4
    lines = (len(groups) + columns - 1) // columns
    figure, grid = plt.subplots(lines, columns, figsize=(11, 2.5 * lines), squeeze=False)
    for axes in grid.flat:
        axes.axis("off")
    for axes, ((model, scene), found) in zip(grid.flat, groups.items()):
        axes.axis("on")
        # Seen along the direction in which the receivers spread least.
        spread = {k: max(r[k] for r in found) - min(r[k] for r in found) for k in "xyz"}
        across, up = [k for k in "xyz" if k != min(spread, key=spread.get)]
        shown = axes.scatter([r[across] for r in found], [r[up] for r in found], c=[r["rmse"] for r in found], s=6,
                             cmap="inferno", vmin=0, vmax=0.3)
        axes.set_title(f"{model}: {scene.removeprefix('builtin:')}", fontsize=8)
        axes.set(xlabel=f"{across}, m", ylabel=f"{up}, m", aspect="equal")
        axes.tick_params(labelsize=6)
    figure.colorbar(shown, ax=grid, shrink=0.5, label="RMSE at the receiver")
    save(figure, folder, "worst-scenes")
    return True


def conclusions(rows, radius, tolerance=0.05):
    """For each scene, the fewest numbers within the tolerance, and the best of all; as (scene, text) pairs."""
    out = []
    for scene in dict.fromkeys(r["scene"] for r in rows):
        here = [r for r in rows if r["scene"] == scene and r["light_radius_deg"] == radius and r["model"] not in BASELINES | {"auto"}]
        if not here:
            continue
        within = sorted((r["numbers"], r["rmse"], name(r)) for r in here if r["rmse"] <= tolerance and r["model"] != "shadow-map")
        best = min(here, key=lambda r: r["rmse"])
        text = (f"{within[0][2]}, {within[0][0]:g} numbers, RMSE {within[0][1]:.3f}" if within
                else f"no model comes within {tolerance:g}")
        out.append((scene.removeprefix("builtin:"), text, f"{name(best)}, {best['rmse']:.3f}" if best["model"] == "shadow-map"
                    else f"{name(best)}, {best['numbers']:g} numbers, {best['rmse']:.3f}"))
    return out


COLUMNS = [("numbers", "numbers", 2), ("bytes", "bytes", 2), ("rmse", "RMSE", 4), ("rmse_spread", "± over seeds", 4), ("whole_rmse", "whole RMSE", 4), ("bias", "bias", 4), ("max", "max", 3),
           ("ambient_rmse", "sky RMSE", 4), ("ambient_unbounced", "of a sky that bounces, without", 4), ("ambient_bounced", "with bounces", 4), ("whole_ambient", "whole sky RMSE", 4), ("whole_mottle", "mottle", 4), ("whole_edge", "edge width / truth's", 1), ("leak_max", "leak max", 3), ("leak_99", "leak 99 %", 3), ("cycles_navi21", "cycles a light, RDNA2", 0), ("cycles_pixel_navi21", "a pixel, RDNA2", 0),
           ("cycles_lit_navi21", "a pixel of lit vertices, RDNA2", 0), ("cycles_polaris10", "a light, GCN4", 0), ("cycles_pixel_polaris10", "a pixel, GCN4", 0),
           ("time_ratio", "time of a light / N·L", 2), ("frame_ratio", "time of a frame / N·L", 2), ("bake_ratio", "bake / sh", 2), ("fits_per_second", "fits/s", 0)]


def cell(value, digits):
    return "" if value is None else f"{value:.{digits}f}"


def page(rows, folder, radius, about, date, pictures):
    body = []
    for scene in ["mean over the scenes"] + list(dict.fromkeys(r["scene"] for r in rows)):
        for light in sorted({r["light_radius_deg"] for r in rows}):
            found = means(rows if scene.startswith("mean") else [r for r in rows if r["scene"] == scene], light)
            for model, row in found.items():
                cells = "".join(f"<td>{cell(row[key], digits)}</td>" for key, _, digits in COLUMNS)
                body.append(f"<tr><td>{html.escape(scene)}</td><td>{html.escape(model)}</td><td>{light:g}</td>{cells}</tr>")
    images = "".join(
        f'<figure><img alt="{html.escape(text)}" src="data:image/svg+xml;base64,'
        f'{base64.b64encode((folder / (stem + ".svg")).read_bytes()).decode()}"><figcaption>{html.escape(text)}</figcaption></figure>'
        for stem, text in pictures)
    advice = "".join(f"<tr><td>{html.escape(s)}</td><td>{html.escape(t)}</td><td>{html.escape(b)}</td></tr>"
                     for s, t, b in conclusions(rows, radius))
    heads = "".join(f"<th>{html.escape(h)}</th>" for h in ["scene", "model", "light °"] + [c[1] for c in COLUMNS])
    text = TEMPLATE
    for key, value in {"DATE": date, "VERSION": html.escape(about["version"]), "RECEIVERS": str(about["receivers"]),
                       "DEVICE": html.escape(about["device"] or "none"), "RADIUS": f"{radius:g}", "IMAGES": images,
                       "HEADS": heads, "BODY": "".join(body), "ADVICE": advice}.items():
        text = text.replace("@" + key + "@", value)
    (folder / "index.html").write_text(text)


TEMPLATE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>Apertura: error against cost</title><style>
body { font: 15px/1.5 sans-serif; margin: 2em auto; max-width: 1100px; padding: 0 1em; color: #222 }
table { border-collapse: collapse; font-size: 13px } td, th { padding: 2px 8px; text-align: right; border-bottom: 1px solid #ddd }
td:first-child, td:nth-child(2), th:first-child, th:nth-child(2) { text-align: left; vertical-align: top }
#all th { cursor: pointer; position: sticky; top: 0; background: #f3f3f3 } #all th[data-order]::after { content: " \\25B2" }
#all th[data-order="-1"]::after { content: " \\25BC" }
figure { margin: 1.5em 0 } img { max-width: 100% } figcaption { color: #666; font-size: 13px } input { width: 22em }
</style></head><body>
<h1>Error against cost</h1>
<p>Made by <code>apertura chart</code> @VERSION@ on @DATE@; @RECEIVERS@ receivers a scene. Every error is of E / (L π sin²r): what a light of
radiance L and angular radius r gives a surface, as a share of what it gives one that faces it, unblocked; against ray-traced truth. Hollow
points are rivals, as their authors would make them, and methods as published; their bytes are those that they need alone.</p>
<table>
<tr><td>RMSE</td><td>of a model made at the receivers themselves: over receivers and 96 directions of the light</td></tr>
<tr><td>± over seeds</td><td>how much of it other receivers would change: its standard deviation, from how those of this run differ</td></tr>
<tr><td>whole RMSE</td><td>interpolated between the samples of an asset, as it is drawn</td></tr>
<tr><td>bias, max</td><td>the mean of the error, above 0 where a model is too bright; the largest at any receiver and direction</td></tr>
<tr><td>sky RMSE</td><td>of the light of an even sky, over π; with bounces: where that light goes on from surface to surface</td></tr>
<tr><td>mottle</td><td>RMS of the error less its own mean within two edges of the mesh or cells of samples, where truth is even: what looks like speckle</td></tr>
<tr><td>edge width</td><td>of drawn shadow edges over that of truth's own</td></tr>
<tr><td>leak max, 99 %</td><td>the light that comes through where truth is blocked altogether: the most, and what one in a hundred exceeds, in the worst scene</td></tr>
<tr><td>cycles</td><td>as Mesa's compiler states them for one wave of each Radeon, above N·L with no visibility: of one evaluation of a light; of a pixel
under one light and the sky, with all that it fetches, at three corners where a model does not mix; and of a pixel of which the vertices were
lit before</td></tr>
<tr><td>time</td><td>of @DEVICE@, over that of N·L: of an evaluation; of a frame of 960 × 540 pixels of the statue under the light that the charts are of</td></tr>
<tr><td>bake / sh, fits/s</td><td>time to bake a vertex over that of the four numbers, 256 rays; points that are fitted in a second, on one core</td></tr>
</table>
<h2>Which model for which scene</h2>
<p>Light radius @RADIUS@°: the fewest numbers a point within an RMSE of 0.05, and the best of all.</p>
<table><tr><th>scene</th><th>least</th><th>best</th></tr>@ADVICE@</table>
@IMAGES@
<h2>All of it</h2>
<p><label>Only rows that contain <input id="filter" placeholder="for example: mean soft 5"></label></p>
<table id="all"><thead><tr>@HEADS@</tr></thead><tbody>@BODY@</tbody></table>
<script>
const table = document.getElementById("all"), body = table.tBodies[0];
for (const head of table.tHead.rows[0].cells) head.onclick = () => {
  const order = head.dataset.order === "1" ? -1 : 1, column = head.cellIndex;
  for (const other of table.tHead.rows[0].cells) delete other.dataset.order;
  head.dataset.order = order;
  const key = row => { const t = row.cells[column].textContent, n = Number(t); return t === "" ? Infinity : isNaN(n) ? t : n; };
  const rows = [...body.rows].map(row => [key(row), row]);
  rows.sort(([a], [b]) => order * (typeof a === "number" && typeof b === "number" ? a - b : String(a).localeCompare(String(b))));
  body.append(...rows.map(r => r[1]));
};
document.getElementById("filter").oninput = event => {
  const words = event.target.value.toLowerCase().split(/\\s+/).filter(w => w);
  for (const row of body.rows) {
    const text = [...row.cells].slice(0, 3).map(c => c.textContent.toLowerCase());
    row.hidden = !words.every(w => text.some(t => isNaN(Number(w)) ? t.includes(w) : t === w));
  }
};
</script></body></html>
"""


def markdown(rows, table, fronts, folder, radius, about, date):
    """The same for a repository: the means, and what to conclude."""
    radii = sorted({r["light_radius_deg"] for r in rows})
    tables = {r: means(rows, r) for r in radii}
    lines = ["# Error against cost", "",
             f"Made by `apertura chart` {about['version']} on {date}, {about['receivers']} receivers a scene. RMSE of E / (L π sin²r), "
             "mean over the scenes; whole: interpolated between what an asset stores, elsewhere made at the receivers; cycles above N·L as Mesa's compiler states them for one wave.", "",
             "![error against the cycles of a pixel](error-cycles-pixel-navi21.png)", "", "![error by scene](scenes.png)", "", *(["![error from point to point](mottle.png)", ""] if any(row["whole_mottle"] is not None for row in table.values()) else []),
             "| model | numbers | bytes | " + " | ".join(f"{r:g}°" for r in radii) + f" | whole, {radius:g}° | sky | whole sky | mottle, {radii[0]:g}° | mottle, {radius:g}° | edges, {radii[0]:g}° | leak 99 % | a light, {radius:g}° | "
             + " | ".join(f"a pixel, {r:g}°" for r in radii if r != 1 and r < 30) + f" | GCN4, {radius:g}° | frame / N·L | bake / sh |",
             "|---|---|---|" + "---|" * (len(radii) + 11 + sum(r != 1 and r < 30 for r in radii))]
    for model, row in table.items():
        cells = ["" if model == "shadow-map" else cell(row[key], 2).rstrip("0").rstrip(".") for key in ("numbers", "bytes")] + [cell(tables[r][model]["rmse"], 3) for r in radii]
        cells += [cell(row[key], 3) for key in ("whole_rmse", "ambient_rmse", "whole_ambient")]
        cells += [cell(tables[radii[0]][model]["whole_mottle"], 3), cell(row["whole_mottle"], 3), cell(tables[radii[0]][model]["whole_edge"], 0), cell(row["leak_99"], 3)]
        cells += [ cell(row["cycles_navi21"], 0)]
        cells += [cell(tables[r][model]["cycles_pixel_navi21"], 0) for r in radii if r != 1 and r < 30]
        cells += [cell(row["cycles_pixel_polaris10"], 0), cell(row["frame_ratio"], 2), cell(row["bake_ratio"], 2)]
        model += "`, rival" if row["baseline"] else "`"
        lines.append(f"| `{model} | " + " | ".join(cells) + " |")
    lines += ["", f"Cycles of RDNA2 but where GCN4 is said, of one evaluation of a light and of a whole pixel; leaks and frames are those of a light of {radius:g}°. A rival's bytes are what it needs alone. Leak: what one in a hundred lights that truth blocks altogether exceeds, in the worst scene. Mottle: RMS of the error less its own mean within two edges of the mesh or cells of samples, where truth is even. Edges: the width of the shadow edges that are drawn over that of truth's own.", "", f"## Which model for which scene (light radius {radius:g}°)", "",
              "| scene | fewest numbers within 0.05 | best of all |", "|---|---|---|"]
    lines += [f"| {s} | {t} | {b} |" for s, t, b in conclusions(rows, radius)]
    for column, title in (("bytes", "bytes"), ("cycles_pixel_navi21", "RDNA2 cycles a pixel"), ("bake_ratio", "bake time")):
        if fronts.get(column):
            lines += ["", f"Nothing is both cheaper in {title} and better than: " + ", ".join(f"`{p[2]}` ({p[1]:.3f})" for p in fronts[column]) + "."]
    (folder / "models.md").write_text("\n".join(lines) + "\n")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    rows, maps = read(folder / "models.csv"), read(folder / "maps.csv")
    about = json.loads((folder / "about.json").read_text())
    date = datetime.date.today().isoformat()
    radius = about["headline"]
    table, fronts = cost_charts(rows, radius, folder)
    scene_chart(rows, radius, folder)
    radius_chart(rows, folder)
    leak_chart(rows, radius, folder)
    pictures = [("error-cycles-pixel-navi21", "Error against GPU cycles a pixel, RDNA2"), ("error-bytes", "Error against bytes a sample"),
                ("error-bake-ratio", "Error against bake time"), ("error-frame-ratio", "Error against the time of a frame on this machine's device"),
                ("error-cycles-pixel-polaris10", "Error against GPU cycles a pixel, GCN4"), ("error-by-radius", "Error by the size of the light"),
                ("scenes", "Error by scene"), ("leaks", "Light through what blocks all of it")]
    if mottle_chart(rows, folder):
        pictures.append(("mottle", "Error from point to point where truth is even"))
    if bounce_chart(rows, radius, folder):
        pictures.append(("bounces", "The sky's error where light bounces"))
    places = folder / "places.csv"
    if places.exists() and place_chart(read(places), folder):
        pictures.append(("places", "Where visibility is stored: at vertices, on faces too, or in images over texture coordinates"))
    if map_chart(maps, folder):
        pictures.append(("worst-scenes", "Where each model errs, in its worst scene"))
    page(rows, folder, radius, about, date, pictures)
    markdown(rows, table, fronts, folder, radius, about, date)


if __name__ == "__main__":
    main()
