"""Made-up results of campaigns whose limit is known, with noise and failures."""

import numpy as np
import xarray as xr

from gfmd_numba.campaign.axes import AXES

LEVELS = {
    "eps_c": [1 / 2, 1 / 4, 1 / 8],
    "eps_f": [1 / 256, 1 / 512, 1 / 1024, 1 / 2048, 1 / 4096],
    "eps_t": [1, 1 / 2, 1 / 4, 1 / 8],
}
REFERENCE = {"eps_c": 1 / 2, "eps_f": 1 / 1024, "eps_t": 1 / 2}
C = {"eps_c": 0.4, "eps_f": 6.0, "eps_t": 0.3}
ALPHA = {"eps_c": 1.1, "eps_f": 0.6, "eps_t": 1.0}
TFC = {0.3: 3.0, 0.8: 2.0}
CROSS = (  # for each pair of limits one, by which corrections are known to add up
    {"eps_c": 1 / 4, "eps_f": 1 / 512},
    {"eps_c": 1 / 4, "eps_t": 1},
    {"eps_f": 1 / 512, "eps_t": 1},
)
# a correction in eps_t that wanes with eps_f, as it is expected without cross levels
WANING = {"coefficients": C | {"eps_t": 0.0}, "interactions": {("eps_f", "eps_t"): C["eps_t"] * REFERENCE["eps_t"]}}
WANING_OF_KAPPA = 1.75  # power of the correction in eps_f
NO_INTERACTIONS: dict[tuple[str, str], float] = {}


def with_axes(dataset):
    """Dataset whose coordinates have the attributes of the table of axes."""
    described = dataset.copy()
    for rank, axis in enumerate(AXES):
        if axis.coordinate in described.coords:
            described[axis.coordinate].attrs = {
                "long_name": axis.long_name,
                "units": "1",
                "symbol": axis.symbol,
                "label": axis.label,
                "axis": "physics" if axis.record else "discretisation",
                "rank": rank,
            }
    return described


def campaign(
    hursts=(0.8,),
    levels=LEVELS,
    coefficients=C,
    alpha=ALPHA,
    realisations=4,
    cross=(),
    interactions=NO_INTERACTIONS,
    waning=WANING_OF_KAPPA,
):
    """Noise-free campaign, one at a time but for its cross levels; alpha may be given per Hurst exponent.

    Interactions are what the corrections of a pair of limits together differ by from their sum, at the reference. That
    of eps_f and eps_t falls with a power of the correction in eps_f, `waning`.
    """
    rows = []
    for hurst in hursts:
        rows.append((hurst, "reference", REFERENCE))
        for name, values in levels.items():
            rows += [(hurst, name, REFERENCE | {name: eps}) for eps in values if eps != REFERENCE[name]]
        rows += [(hurst, "cross", REFERENCE | level) for level in cross]
    constants = {"poissons_ratio": 0.33, "aspect_ratio": np.inf, "reduced_pressure": 0.007}
    coords = {name: ("case", np.array([eps[name] for _, _, eps in rows])) for name in LEVELS}
    coords |= {name: ("case", np.full(len(rows), value)) for name, value in constants.items()}
    coords["rms_gradient_target"] = ("case", np.full(len(rows), 0.01))
    coords["hurst"] = ("case", np.array([hurst for hurst, _, _ in rows]))
    coords["limit"] = ("case", [limit for _, limit, _ in rows])
    coords["is_reference"] = ("case", [limit == "reference" for _, limit, _ in rows])
    coords["case_id"] = ("case", [f"case-{index}" for index in range(len(rows))])
    of = alpha if 0.8 in alpha else dict.fromkeys(hursts, alpha)
    means = []
    for hurst, _, eps in rows:
        powers = {name: eps[name] ** of[hurst][name] for name in LEVELS}
        ratio = {name: powers[name] / REFERENCE[name] ** of[hurst][name] for name in LEVELS}
        together = sum(
            size * ratio[first] ** (waning if (first, second) == ("eps_f", "eps_t") else 1.0) * ratio[second]
            for (first, second), size in interactions.items()
        )
        means.append(TFC[hurst] + sum(c * powers[name] for name, c in coefficients.items()) + together)
    kappa = np.repeat(np.array(means)[:, None], realisations, axis=1)
    dims = ("case", "realisation")
    variables = {"kappa": (dims, kappa), "status": (dims, np.zeros(kappa.shape, np.int8))}
    return with_axes(xr.Dataset(variables, coords))


def noisy(dataset, rng, spread=0.2, own=0.01):
    """Paired noise as in real contacts: variance falls with the number of asperities."""
    n_cases, n = dataset["kappa"].shape
    size = spread * (2048 * dataset["eps_t"] * dataset["eps_f"]).values[:, None] ** 0.35
    surfaces = np.stack([dataset["eps_t"], dataset["eps_f"]], axis=-1)
    _, surface = np.unique(surfaces, axis=0, return_inverse=True)
    common, of_surface = rng.standard_normal((1, n)), rng.standard_normal((n_cases, n))[surface.ravel()]
    noise = size * (0.8 * common + 0.6 * of_surface) + own * rng.standard_normal((n_cases, n))
    return dataset.assign(kappa=dataset["kappa"] + noise)


def fails(dataset, **where):
    """Mark results as crashed, their values garbage."""
    broken = dataset.copy(deep=True)
    broken["kappa"][where] = 1e3
    broken["status"][where] = 5
    return broken


def notes(fit, group=0):
    """What a fit says of a group, but for whether corrections add up."""
    lines = str(fit["message"].values[group]).splitlines()
    return [line for line in lines if "corrections" not in line]


def assert_refused(fit, *fragments):
    assert (fit["fit_status"] == "refused").all()
    limit = f"{fit.attrs['variable']}_tfc"
    for name in (limit, f"{limit}_error", f"{limit}_low", "C", "alpha", "correction", "rms_residual"):
        assert np.isnan(fit[name]).all(), name
    for fragment in fragments:
        assert fragment in fit["message"].values[0]


def of_limit(dataset, design, limit):
    """Realisations of the cases of a limit, or of the cross levels, in a design."""
    return design.realisations[dataset["limit"].values == limit]
