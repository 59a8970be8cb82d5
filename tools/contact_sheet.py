#!/usr/bin/env python3
"""Pictures of one size in a labelled grid.

contact_sheet.py -o SHEET.png [--title TEXT] --columns a,b [--rows x,y] PICTURE...   (row by row)
"""
import argparse

from PIL import Image, ImageDraw, ImageFont

MARGIN, LABEL, TITLE = 8, 22, 34


def font(size):
    try:
        return ImageFont.truetype("DejaVuSans.ttf", size)
    except OSError:
        return ImageFont.load_default()


def sheet(title, columns, rows, pictures):
    width, height = pictures[0].size
    left = 64 if any(rows) else MARGIN
    head = LABEL + (TITLE if title else MARGIN)
    out = Image.new("RGB", (left + len(columns) * (width + MARGIN), head + len(rows) * (height + MARGIN)), "white")
    draw = ImageDraw.Draw(out)
    draw.text((MARGIN, MARGIN), title, fill="black", font=font(18))
    for c, column in enumerate(columns):
        draw.text((left + c * (width + MARGIN), head - LABEL), column, fill="black", font=font(15))
    for r, row in enumerate(rows):
        top = head + r * (height + MARGIN)
        draw.text((MARGIN, top + height // 2 - 10), row, fill="black", font=font(15))
        for c in range(len(columns)):
            out.paste(pictures[r * len(columns) + c], (left + c * (width + MARGIN), top))
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", required=True)
    parser.add_argument("--title", default="")
    parser.add_argument("--columns", required=True)
    parser.add_argument("--rows", default="")
    parser.add_argument("pictures", nargs="+")
    a = parser.parse_args()
    columns, rows = a.columns.split(","), a.rows.split(",")
    if len(a.pictures) != len(columns) * len(rows):
        parser.error(f"{len(columns)} x {len(rows)} pictures are needed, not {len(a.pictures)}")
    sheet(a.title, columns, rows, [Image.open(p).convert("RGB") for p in a.pictures]).save(a.o)


if __name__ == "__main__":
    main()
