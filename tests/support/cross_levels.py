"""Made-up results of campaigns with cross levels."""

from support.synthetic_campaigns import campaign

LEVELS = {"eps_c": [1 / 2, 1 / 4, 1 / 8], "eps_f": [1 / 512, 1 / 1024, 1 / 2048], "eps_t": [1, 1 / 2, 1 / 4]}


def crossed(*levels, n=40, **planted):
    """Noise-free campaign with cross levels, whose corrections add up unless interactions are planted."""
    return campaign(levels=LEVELS, realisations=n, cross=levels, **planted)
