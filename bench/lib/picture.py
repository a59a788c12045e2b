"""An SVG of histograms: one panel a scenario, one line a histogram, both axes logarithmic."""

import html
import math

WIDTH, HEIGHT, LEFT, TOP, BOTTOM, GAP = 420, 330, 70, 50, 60, 30
BINS_PER_DECADE = 12
COLOURS = ("#1b6ca8", "#d1495b", "#3c8d5a", "#8a6fb0")


def binned(histogram, lowest_ns, highest_ns):
    """[(middle_ns, share of all)] in bins of equal width on the logarithmic axis; empty ones are left out."""
    counts = {}
    for lo, hi, n in histogram.buckets:
        at = min(max((lo + hi) / 2, lowest_ns), highest_ns)
        counts.setdefault(math.floor(math.log10(at) * BINS_PER_DECADE), []).append(n)
    return [(10 ** ((b + 0.5) / BINS_PER_DECADE), sum(counts[b]) / histogram.total) for b in sorted(counts)]


class Panel:
    """Places on the page for lateness (ns) and share, of decades 10^first .. 10^last."""

    def __init__(self, number, first, last, floor):
        self.x0 = LEFT + number * (WIDTH + LEFT + GAP)
        self.first, self.last, self.floor = first, last, floor

    def x(self, ns):
        return self.x0 + (math.log10(ns) - self.first) / (self.last - self.first) * WIDTH

    def y(self, share):
        return TOP + math.log10(max(share, 10**self.floor)) / self.floor * HEIGHT

    def frame(self, title):
        out = [f'<rect x="{self.x0}" y="{TOP}" width="{WIDTH}" height="{HEIGHT}" fill="none" stroke="#444"/>']
        out.append(text(self.x0 + WIDTH / 2, TOP - 14, title, "middle", 15))
        for decade in range(self.first, self.last + 1):
            x = self.x(10**decade)
            out.append(f'<path d="M{x:.1f} {TOP}v{HEIGHT}" stroke="#ddd"/>')
            out.append(text(x, TOP + HEIGHT + 18, duration(10**decade), "middle"))
        for decade in range(self.floor, 1):
            y = self.y(10**decade)
            out.append(f'<path d="M{self.x0} {y:.1f}h{WIDTH}" stroke="#ddd"/>')
            out.append(text(self.x0 - 6, y + 4, f"{10.0 ** decade:g}", "end"))
        out.append(text(self.x0 + WIDTH / 2, TOP + HEIGHT + 42, "lateness of the wake-up", "middle"))
        x, y = self.x0 - 52, TOP + HEIGHT / 2
        out.append(text(x, y, "share of wake-ups", "middle", turn=f"rotate(-90 {x} {y})"))
        return out


def duration(ns):
    for unit, name in ((1e9, "s"), (1e6, "ms"), (1e3, "us")):
        if ns >= unit:
            return f"{ns / unit:g} {name}"
    return f"{ns:g} ns"


def text(x, y, words, anchor, size=12, turn=""):
    turned = f' transform="{turn}"' if turn else ""
    place = f'x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-size="{size}"{turned}'
    return f"<text {place}>{html.escape(words)}</text>"


def line(panel, histogram, colour):
    points = binned(histogram, 10**panel.first, 10**panel.last * 0.999)
    path = "M" + "L".join(f"{panel.x(ns):.1f} {panel.y(share):.1f}" for ns, share in points)
    return f'<path d="{path}" fill="none" stroke="{colour}" stroke-width="1.8"/>'


def svg(panels):
    """`panels`: [(title, [(legend, Histogram)])]."""
    everything = [h for _, lines in panels for _, h in lines if h.total]
    first = math.floor(math.log10(max(min(h.buckets[0][0] for h in everything), 1000)))
    last = max(math.ceil(math.log10(max(h.max_ns for h in everything))), first + 1)
    floor = math.floor(math.log10(1 / max(h.total for h in everything)))
    width = len(panels) * (WIDTH + LEFT + GAP) + GAP
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{TOP + HEIGHT + BOTTOM}" '
        'font-family="sans-serif">',
        '<rect width="100%" height="100%" fill="white"/>',
    ]
    for number, (title, lines) in enumerate(panels):
        panel = Panel(number, first, last, floor)
        out += panel.frame(title)
        for at, (legend, histogram) in enumerate(lines):
            if histogram.total == 0:
                continue
            colour, y = COLOURS[at % len(COLOURS)], TOP + 18 + at * 18
            out.append(line(panel, histogram, colour))
            out.append(f'<path d="M{panel.x0 + WIDTH - 150} {y - 4}h24" stroke="{colour}" stroke-width="2"/>')
            out.append(text(panel.x0 + WIDTH - 120, y, legend, "start"))
    return "\n".join(out + ["</svg>"]) + "\n"
