"""Flow charts in the notation of Mermaid, drawn as SVG when the site is built.

Code hosts draw such charts themselves. A page of the site would need a script of 3 MB, so the few
forms that our charts use are drawn here: boxes, rounded boxes, and arrows with or without a label.
"""

from __future__ import annotations

import html
import itertools
import re
from dataclasses import dataclass, field

BLOCK = re.compile(r"^```mermaid\n(.*?)^```$", re.DOTALL | re.MULTILINE)
ARROW = re.compile(r"^\s*(\w+)(?:\(\[(.+?)\]\))? -->(?:\|([^|]+)\|)? (\w+)(?:\(\[(.+?)\]\))?\s*$")
HEIGHT, GAP_X, GAP_Y, MARGIN = 30.0, 26.0, 46.0, 12.0  # [px]
LETTER = 7.9  # width of a letter [px]
SWEEPS = 12


@dataclass
class Chart:
    """Nodes with their texts (None: a box with the name of the node), and labelled arrows."""

    rounded: dict[str, str] = field(default_factory=dict)
    nodes: list[str] = field(default_factory=list)
    arrows: list[tuple[str, str, str]] = field(default_factory=list)

    def text(self, node: str) -> str:
        """What stands in the box of a node."""
        return self.rounded.get(node, node)

    def width(self, node: str) -> float:
        """Width of the box of a node [px]; 0 for the bend of an arrow."""
        return LETTER * len(self.text(node)) + 22.0 if node in self.nodes else 0.0


def parse(source: str) -> Chart:
    """Read a chart; lines other than arrows, such as those of subgraphs, have no part in it."""
    chart = Chart()
    for line in source.splitlines():
        if match := ARROW.match(line):
            first, first_text, label, second, second_text = match.groups()
            for node, text in ((first, first_text), (second, second_text)):
                if node not in chart.nodes:
                    chart.nodes.append(node)
                if text:
                    chart.rounded[node] = text
            chart.arrows.append((first, second, label or ""))
    return chart


def _layers(chart: Chart) -> dict[str, int]:
    """Row of each node: one below the lowest of its sources. Arrows that lead back are left out."""
    layer = dict.fromkeys(chart.nodes, 0)
    forward = _forward(chart)
    for _ in chart.nodes:
        for first, second in forward:
            layer[second] = max(layer[second], layer[first] + 1)
    for node in chart.nodes:  # sources come down to their first reader
        if not any(second == node for _, second in forward):
            below = [layer[second] for first, second in forward if first == node]
            layer[node] = min(below) - 1 if below else 0
    return layer


def _forward(chart: Chart) -> list[tuple[str, str]]:
    """Arrows without those that close a circle, in the order of the text."""
    kept: list[tuple[str, str]] = []
    for first, second, _ in chart.arrows:
        reached, pending = set(), [second]
        while pending:
            node = pending.pop()
            reached.add(node)
            pending += [b for a, b in kept if a == node and b not in reached]
        if first not in reached:
            kept.append((first, second))
    return kept


def _chains(chart: Chart, layer: dict[str, int]) -> list[list[str]]:
    """Nodes of each arrow from row to row; where it passes a row, a bend stands for a node there.

    Adds the bends to `layer`. An arrow that leads back has its two ends only.
    """
    chains = []
    for first, second, _ in chart.arrows:
        bends = [f"{first}>{second}>{row}" for row in range(layer[first] + 1, layer[second])]
        layer |= dict(zip(bends, range(layer[first] + 1, layer[second]), strict=True))
        chains.append([first, *bends, second])
    return chains


def _places(
    chart: Chart, layer: dict[str, int], chains: list[list[str]]
) -> dict[str, tuple[float, float]]:
    """Centre of each box and bend [px]: in rows, ordered by the mean place of their neighbours."""
    rows: dict[int, list[str]] = {}
    for node, row in layer.items():
        rows.setdefault(row, []).append(node)
    x = dict.fromkeys(layer, 0.0)
    near: dict[str, list[str]] = {node: [] for node in layer}
    for chain in chains:
        for above, below in itertools.pairwise(chain):
            near[above].append(below)
            near[below].append(above)
    for sweep in range(SWEEPS):
        for row in sorted(rows, reverse=sweep % 2 == 1):
            wish = {n: sum(x[m] for m in near[n]) / max(len(near[n]), 1) for n in rows[row]}
            rows[row].sort(key=wish.__getitem__)
            _spread(chart, rows[row], wish, x)
    left = min(x[n] - chart.width(n) / 2 for n in layer)
    return {
        n: (x[n] - left + MARGIN, MARGIN + HEIGHT / 2 + layer[n] * (HEIGHT + GAP_Y)) for n in layer
    }


def _spread(chart: Chart, row: list[str], wish: dict[str, float], x: dict[str, float]) -> None:
    """Place a row near the wishes, without overlap, its middle on the middle of the wishes."""
    end = float("-inf")
    for node in row:
        x[node] = max(wish[node], end + GAP_X + chart.width(node) / 2)
        end = x[node] + chart.width(node) / 2
    shift = sum(wish[node] - x[node] for node in row) / len(row)
    for node in row:
        x[node] += shift


def draw(source: str) -> str:
    """SVG of a chart; its colours are those of the text around it."""
    chart = parse(source)
    layer = _layers(chart)
    chains = _chains(chart, layer)
    place = _places(chart, layer, chains)
    width = max(place[n][0] + chart.width(n) / 2 for n in layer) + MARGIN
    height = max(y for _, y in place.values()) + HEIGHT / 2 + MARGIN
    parts = [
        f'<svg class="flow-chart" viewBox="0 0 {width:.0f} {height:.0f}" role="img" '
        f'aria-label="Flow chart" style="max-width:{width:.0f}px">',
        '<defs><marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" '
        'markerHeight="7" orient="auto"><path d="M0 0L8 4L0 8z"/></marker></defs>',
    ]
    labels = []
    for (first, second, label), chain in zip(chart.arrows, chains, strict=True):
        points = [place[node] for node in chain]
        if layer[second] > layer[first]:
            path = _downward(points)
        else:  # back to an earlier row, from side to side
            points = [(place[n][0] - chart.width(n) / 2, place[n][1]) for n in (first, second)]
            (x0, y0), (x1, y1) = points
            path = f"M{x0:.1f} {y0:.1f}C{x0 - 60:.1f} {y0:.1f} "
            path += f"{x1 - 60:.1f} {y1:.1f} {x1:.1f} {y1:.1f}"
        parts.append(f'<path class="arrow" d="{path}" marker-end="url(#tip)"/>')
        if label:
            (x0, y0), (x1, y1) = points[:2] if len(points) == 2 else [points[len(points) // 2]] * 2
            labels.append(_text((x0 + x1) / 2, (y0 + y1) / 2, label, "label"))
    for node in chart.nodes:
        (x, y), w = place[node], chart.width(node)
        radius = HEIGHT / 2 if node in chart.rounded else 3
        parts.append(
            f'<rect x="{x - w / 2:.1f}" y="{y - HEIGHT / 2:.1f}" width="{w:.1f}" '
            f'height="{HEIGHT}" rx="{radius}"/>'
        )
        parts.append(_text(x, y, chart.text(node), "node"))
    return "".join([*parts, *labels, "</svg>"])


def _downward(points: list[tuple[float, float]]) -> str:
    """Path from the lower edge of the first point's box to the upper edge of the last one's."""
    (x, y), (_, last) = points[0], points[-1]
    path, y = f"M{x:.1f} {y + HEIGHT / 2:.1f}", y + HEIGHT / 2
    for to_x, row in points[1:]:
        to_y = row - HEIGHT / 2
        middle = (y + to_y) / 2
        path += f"C{x:.1f} {middle:.1f} {to_x:.1f} {middle:.1f} {to_x:.1f} {to_y:.1f}"
        x, y = to_x, to_y
        if row != last:
            y += HEIGHT
            path += f"V{y:.1f}"
    return path


def _text(x: float, y: float, text: str, kind: str) -> str:
    return f'<text class="{kind}" x="{x:.1f}" y="{y:.1f}">{html.escape(text)}</text>'


def with_charts(text: str) -> str:
    """Markdown in which every chart is an SVG."""
    return BLOCK.sub(lambda match: draw(match[1]), text)
