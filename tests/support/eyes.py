"""How colours look: their contrast, their lightness in grey, and what dichromats see."""

import numpy as np
from matplotlib.colors import to_rgb, to_rgba

# linear RGB that dichromats see: Vienot, Brettel & Mollon (Color Res. Appl. 24:243, 1999)
DICHROMATS = {
    "protanopia": [[0.11238, 0.88762, 0.0], [0.11238, 0.88762, 0.0], [0.00401, -0.00401, 1.0]],
    "deuteranopia": [[0.29275, 0.70725, 0.0], [0.29275, 0.70725, 0.0], [-0.02234, 0.02234, 1.0]],
}
_TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])


def contrast_to_white(colour):
    """Return the contrast of WCAG 2, from 1 to 21; a transparent colour lies on white."""
    *rgb, alpha = to_rgba(colour)
    return 1.05 / (_TO_XYZ[1] @ _linear(alpha * np.array(rgb) + 1.0 - alpha) + 0.05)


def lightness(colour):
    """Return CIE L*, from 0 to 100: all that is left in grey."""
    return _lab(_linear(to_rgb(colour)))[0]


def difference(first, second, seen_by=None):
    """Return the distance of two colours in CIE L*a*b*, as seen by all or by a dichromat."""
    seen = np.eye(3) if seen_by is None else np.array(DICHROMATS[seen_by])
    return float(np.linalg.norm(np.subtract(*(_lab(seen @ _linear(to_rgb(each))) for each in (first, second)))))


def _linear(rgb):
    rgb = np.asarray(rgb)
    return np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)


def _lab(linear):
    ratio = _TO_XYZ @ linear / _TO_XYZ.sum(axis=1)
    x, y, z = np.where(ratio > (6 / 29) ** 3, np.cbrt(ratio), ratio / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])
