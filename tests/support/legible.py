"""Whether a picture can be read: contrast, labels and titles that keep apart, and nothing beyond its edges."""

from itertools import pairwise

from matplotlib.legend import Legend
from matplotlib.text import Text

from support.eyes import contrast_to_white


def faults(figure):
    """Return what cannot be read in a picture on white: text below 4.5 : 1, ticks that collide, what is cut off."""
    figure.draw_without_rendering()
    found = [
        f"faint: {each.get_text()}"
        for each in figure.findobj(Text)
        if each.get_text() and each.get_visible() and contrast_to_white(each.get_color()) < 4.5
    ]
    for axis in figure.axes:
        for labels, low, high in ((_shown(axis.xaxis), "x0", "x1"), (_shown(axis.yaxis), "y0", "y1")):
            ordered = sorted(labels, key=lambda each: getattr(each[1], low))
            found += [
                f"collide: {one} and {other}"
                for (one, before), (other, after) in pairwise(ordered)
                if getattr(before, high) >= getattr(after, low)
            ]
    for title in (each.title for each in figure.axes if each.title.get_text()):
        box = title.get_window_extent().padded(-1.0)
        numbers = [each for axes in figure.axes for axis in (axes.xaxis, axes.yaxis) for each in _shown(axis)]
        found += [f"collide: {title.get_text()} and {number}" for number, other in numbers if box.overlaps(other)]
    frame = figure.bbox
    for legend in figure.findobj(Legend):
        box = legend.get_window_extent()
        if box.x0 < frame.x0 or box.y0 < frame.y0 or box.x1 > frame.x1 or box.y1 > frame.y1:
            found.append(f"cut off: {[text.get_text() for text in legend.get_texts()]}")
    titles = [each for axis in figure.axes for each in (axis.title, axis.xaxis.label, axis.yaxis.label)]
    for text in (each for each in titles if each.get_text() and each.get_visible()):
        box = text.get_window_extent()
        if box.x0 < frame.x0 or box.y0 < frame.y0 or box.x1 > frame.x1 or box.y1 > frame.y1:
            found.append(f"cut off: {text.get_text()}")
    return found


def _shown(axis):
    """Labels of the ticks that are drawn, major and minor, with their boxes."""
    low, high = sorted(axis.get_view_interval())
    ticks = [*axis.get_major_ticks(), *axis.get_minor_ticks()]
    labels = [label for tick in ticks if low <= tick.get_loc() <= high for label in (tick.label1, tick.label2)]
    return [(each.get_text(), each.get_window_extent()) for each in labels if each.get_visible() and each.get_text()]
