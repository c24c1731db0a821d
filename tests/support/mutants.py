"""Files altered at random, and what is done with each: it is read and, if it is good and small, solved."""

import random
from dataclasses import replace

import numpy as np
import xarray as xr

import gfmd_numba
from gfmd_numba.campaign.file import load_campaign
from gfmd_numba.campaign.plan import plan
from gfmd_numba.contact import solution
from gfmd_numba.contact.evaluation import measure
from gfmd_numba.scene import load_scene
from gfmd_numba.scene.surface_file import load_surface
from support.alterations import SIZES, changed_bytes, changed_number, changed_text, changed_value

MOST_NODES, MOST_STEPS = 300, 60

_BODY = "body: {youngs_modulus: 70e9, poissons_ratio: 0.33, aspect_ratio: 0.5}\n"
_PSD = "{method: psd, hurst: 0.8, rms_gradient: 0.01}"
_EPS = "discretisation: {eps_c: 1/2, eps_f: 1/8, eps_t: 1}\n"
_PRESSED = f"length: 1e-4\n{_BODY}roughness: {_PSD}\n{_EPS}"
_PUNCHED = "interface: {hard_wall: {}}\nloading: {reduced_pressure: 0.05}\n"
_PATH = "path: [{displacement: 3e-7}, {sliding: 1e-7}, {displacement: 1e-7}]\n"
_LAW = "{work_of_adhesion: 0.05, range: 20 um}"
_COHESIVE = "{work_of_adhesion: 0.05, normal_length: 20 um, tangential_length: 20 um}"
_COUNTER = f"counter_body: {{youngs_modulus: 3e9, poissons_ratio: 0.5, aspect_ratio: 0.1, roughness: {_PSD}}}\n"
_MEASURED = "{method: measured, file: p.%s%s}"
_CAMPAIGN = f"""
name: tiny
seed: 1
realisations: {{reference: 2, eps_c: [1]}}
scene: {{body: {{poissons_ratio: 0.33}}, roughness: {_PSD}, {_PUNCHED.replace(chr(10), ", ").rstrip(", ")}}}
reference: {{eps_c: 1/2, eps_f: 1/4, eps_t: 1}}
limits: {{eps_c: [1]}}
grid: {{hurst: [0.3, 0.8], aspect_ratio: [0.5, .inf], reduced_pressure: [0.01, 0.1]}}
fit: {{variable: kappa, exponents: shared, fixed: {{eps_c: [1, 2]}}}}
target: {{kappa: 10%}}
case_timeout: 100
"""
_MOUNDS = "model: %s, hurst: 0.8, correlation_length: 4e-6, mound_separation: 9e-6, cut_on: 2e-6"
_RANDOM = "surface: {method: %s, %s, rms_height: 3e-7, points: 128}\nlength: 1e-4\n"
_RANGE = "hurst_range: {shortest: 3e-6, longest: 3e-5}\n"
_ANISOTROPIC = "model: length_anisotropy, hurst: 0.8, correlation_length_x: 2e-5, correlation_length_y: 3e-5"
_SELF_AFFINE = "model: self_affine, hurst: 0.8, roll_off: 2e-5, cut_on: 4e-6, plateau: true"
_RECURSIVE = "{method: successive_addition, hurst: 0.8, roll_off: 2e-5, cut_on: 4e-6, rms_gradient: 0.1, points: 100}"

TEXTS = {
    "scene": [
        _PRESSED + _PUNCHED + "numerics: {solver: verlet, residual: 1e-8, damping: 0.5, time_step: 0.9}\n",
        _PRESSED + "interface: {hard_wall: {}}\nloading: {displacement: 2e-7}\nboundary: {normal_traction: 3.0}\n",
        _PRESSED + f"interface: {{hard_wall: {{}}, exponential: {_LAW}}}\nloading: {{displacement: 2e-7}}\n",
        _PRESSED + f"interface: {{cohesive: {_COHESIVE}}}\nloading: {{displacement: 2e-7}}\n" + _PATH,
        _PRESSED + "interface: {hard_wall: {}, friction: {coefficient: 0.3}}\nloading: {displacement: 2e-7}\n" + _PATH,
        _PRESSED.replace("0.5}", f"0.5, roughness: {_PSD}}}") + _PUNCHED + "numerics: {topography_order: 2}\n",
        _BODY + _COUNTER + _PUNCHED + _EPS,
        _PRESSED.replace("1/8", "1/4") + _PUNCHED + "dimension: 2\n",
        _BODY + f"roughness: {_MEASURED % ('csv', ', units: {z: L_x}')}\n" + _PUNCHED,
        "scene:\n  body: {poissons_ratio: 0.3}\n  boundary: {normal_traction: 0.0, tangential_displacement: p.npy}\n",
    ],
    "campaign": [
        _CAMPAIGN,
        _CAMPAIGN.replace("scene: {", "scene: {dimension: 2, ").replace("aspect_ratio: [0.5, .inf], ", ""),
    ],
    "surface": [
        _RANDOM % ("psd", _MOUNDS % "exponential") + _RANGE,
        _RANDOM % ("fourier_filter", _MOUNDS % "k_correlation"),
        (_RANDOM % ("psd", _ANISOTROPIC)).replace("128", "24") + "dimension: 2\n",
        _RANDOM % ("psd", _SELF_AFFINE),
        f"surface: {_RECURSIVE}\nlength: 1e-4\n",
        "surface: {method: measured, file: p.csv, units: {z: um}, detrend: tilt, periodic: mirror, points: 100,\n"
        "  spacing: 3e-6}\n",
    ],
}
KINDS = (*TEXTS, "npy", "csv", "nc", "table")


def _heights(pick):
    heights = 1e-3 * np.sin(np.arange(32.0)).reshape(pick.choice([(32,), (32,), (32,), (4, 8), (32, 1), (2, 4, 4)]))
    for _ in range(pick.choice([0, 0, 1, 2])):
        heights.flat[pick.randrange(32)] = pick.choice(SIZES)
    if pick.random() < 0.1:
        heights *= pick.choice(SIZES)
    return heights


def _write_numbers(path, pick):
    """One file of numbers with extreme values, of an odd shape or type, or with damaged bytes."""
    with np.errstate(all="ignore"):
        heights = _heights(pick)
    damage = pick.random() < (0.4 if path.suffix == ".nc" else 0.6)
    if path.suffix == ".npy":
        kind = pick.choice(["f8", "f8", "f8", ">f8", "f2", "i8", "u1", "c16", "?", "S3", "M8[s]", "f16"])
        with np.errstate(all="ignore"):
            np.save(path, heights.astype(kind))
    elif path.suffix == ".csv":
        table = heights.reshape(len(heights), -1)
        if pick.random() < 0.2:
            table = np.column_stack([np.arange(len(table)) * pick.choice([1e-6, 1.0, *SIZES]), table])
        header = pick.choice(["", "", "x [m], z [m]", "[um]", "\x1b[2J"])
        np.savetxt(path, table, delimiter=pick.choice([",", ",", ";"]), header=header)
        if pick.random() < 0.4:
            path.write_text(changed_text(path.read_text(), pick), encoding="utf-8")
    else:
        dims = ("x",) if heights.ndim == 1 else ("z", "y", "x")[-heights.ndim :]
        attributes = {
            pick.choice(["units", "scale_factor", "_FillValue", "add_offset", "calendar"]): pick.choice(SIZES)
        }
        if pick.random() < 0.8:
            attributes = {"units": pick.choice(["m", "m", "m", "1", "um", "\x1b", "days since 1"])}
        dataset = xr.Dataset({pick.choice(["height", "height", "height", "h", "x", "é"]): (dims, heights)})
        if pick.random() < 0.7 and "x" not in dataset:
            dataset["x"] = ("x", np.arange(heights.shape[-1]) * pick.choice([*5 * [1 / 32], *SIZES]), {"units": "m"})
        next(iter(dataset.data_vars.values()), dataset.get("x", dataset)).attrs.update(attributes)
        dataset.to_netcdf(path, engine="netcdf4", format=pick.choice(["NETCDF4", "NETCDF4", "NETCDF3_CLASSIC"]))
    if damage:
        path.write_bytes(changed_bytes(path.read_bytes(), pick))


def write_mutant(folder, kind, seed):
    """File of a kind, altered as the seed says, in a folder with sound files it may name."""
    pick = random.Random(seed)
    np.save(folder / "p.npy", 1e-3 * np.sin(np.arange(32.0)))
    np.savetxt(folder / "p.csv", 1e-3 * np.sin(np.arange(32.0)))
    path = folder / "mutant.yaml"
    if kind in TEXTS:
        text = pick.choice(TEXTS[kind])
        how = pick.choice([changed_text, changed_number, changed_number, changed_number, changed_value, changed_bytes])
        content = how(text.encode(), pick) if how is changed_bytes else how(text, pick).encode("utf-8", "surrogatepass")
        path.write_bytes(content)
        return path
    numbers = folder / f"p.{'csv' if kind == 'table' else kind}"
    for _ in range(20):  # some attributes cannot be written
        numbers.unlink(missing_ok=True)
        try:
            _write_numbers(numbers, pick)
            break
        except (ValueError, TypeError, AttributeError, OverflowError, RuntimeError, KeyError):
            continue
    boundary = numbers.suffix in (".npy", ".csv") and pick.random() < 0.3
    length = pick.choice(["", "length: 1.0\n", "length: 1.0\n", "length: 32e-6\n"])
    if kind == "table" or pick.random() < 0.4:
        more = pick.choice(["", ", periodic: mirror", ", periodic: window, detrend: curvature", ", fill: interpolate"])
        more += pick.choice(["", ", units: {z: um}", ", units: {x: mm, z: um}", ", points: 50", ", cutoff: 0.1"])
        text = f"surface: {{method: measured, file: {numbers.name}{more}}}\n{length}"
    elif boundary:
        name = pick.choice(["normal_traction", "tangential_displacement"])
        text = f"scene:\n  body: {{poissons_ratio: 0.3, aspect_ratio: 1}}\n  boundary: {{{name}: {numbers.name}}}\n"
    else:
        rough = _MEASURED % (kind, pick.choice(["", "", ", units: {z: m}"]))
        own = pick.choice(["", f", roughness: {rough}"])
        body = f"body: {{poissons_ratio: 0.33{own}}}\n"
        text = f"{length}{body}{'' if 'file' in body else f'roughness: {rough}' + chr(10)}{_PUNCHED}"
    path.write_text(text, encoding="utf-8")
    return path


def use(kind, path):
    """Read a file as a command of its kind does, and solve what is small; raises InputError if it is not good."""
    is_surface = kind == "surface" or (kind not in TEXTS and path.read_text(encoding="utf-8").startswith("surface:"))
    if is_surface:
        file = load_surface(path)[0]
        if (file.surface.points or 1) ** (file.dimension or 1) <= 32 * MOST_NODES:
            gfmd_numba.make_surface(path)
    elif kind == "campaign":
        campaign = load_campaign(path)[0]
        if campaign.n_cases <= 50:
            problem = plan(path).problems[-1]
            if problem.surface.nodes <= MOST_NODES:
                numerics = replace(problem.numerics, max_iterations=MOST_STEPS)
                measure(solution.solve(replace(problem, numerics=numerics), range(1)))
    else:
        file = load_scene(path)[0]
        if not file.scene.has_punch:
            if (file.points or 1) <= MOST_NODES:
                gfmd_numba.solve(_quick(file))
        elif _nodes(file) <= MOST_NODES and len(file.path) < 5:
            assert_honest(gfmd_numba.solve(_quick(file)))


def _nodes(file):
    return 1 if file.discretisation is None else file.discretisation.nx**file.scene.dimension


def assert_honest(found):
    """Assert that results that are ok are finite, but for what is undefined without contact."""
    fine = found.isel(step=np.flatnonzero(found["status"] == 0)) if "step" in found.dims else found
    if "step" in found.dims or int(found["status"]) == 0:
        for name in (
            "height",
            "pressure",
            "displacement",
            "gap",
            "mean_pressure",
            "mean_gap",
            "rms_gradient",
            "residual",
        ):
            assert np.isfinite(fine[name]).all(), name


def _quick(file):
    steps = min(MOST_STEPS, file.numerics.max_iterations)
    return file.model_copy(update={"numerics": file.numerics.model_copy(update={"max_iterations": steps})})
