"""Maps: kappa against the literature, and time, memory and transforms up to 4096^2. `peers.py` has other codes.

`python benchmarks/maps.py` prints everything, and `python benchmarks/maps.py 2048 0.8 0.007` solves one map of that
size, H and p*, for its time and memory. One thread each.
"""

import resource
import subprocess
import sys
import time

import numpy as np

from gfmd_numba.contact import solution
from gfmd_numba.contact.evaluation import measure
from gfmd_numba.contact.problem import Problem
from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.transform import Transform
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options

SURFACES, RESIDUAL = 6, 1e-8


def problem(hurst, cut_off, nx, load, cut_on=2, anisotropy=1.0):
    surface = RandomSurface(SelfAffineWaves(hurst, cut_on, cut_off, anisotropy=anisotropy), nx, 2018, dimension=2)
    numerics = Options("active_set_newton", residual=RESIDUAL)
    return Problem(surface, ElasticBody(None, None), Interactions(hard_wall=True), load, None, numerics)


def measured(*arguments, **options):
    found = measure(solution.solve(problem(*arguments, **options), range(SURFACES)))
    assert (found["status"] == Status.ok).all()
    return found


def with_error(values):
    return f"{values.mean():7.3f} ({values.std(ddof=1) / np.sqrt(len(values)):.3f})"


def kappa_against_the_literature():
    print(f"kappa of {SURFACES} isotropic maps, L_x/lambda_l = 2, lambda_l/lambda_s = 32, the same on each grid;")
    print("Prodanov, Dapp & Mueser (2014) in the TFC limit: 1.93 to 2.16; theory: Persson 1.60, Bush et al. 2.51")
    print("   H      p*  1/eps_c  kappa (error)   counted   kappa_r    area   Nayak   clusters")
    for hurst in (0.3, 0.5, 0.8):
        for load in (0.007, 0.02, 0.05):
            for nx in (256, 512, 1024):
                found = measured(hurst, 64, nx, load)
                mean = {name: values.mean() for name, values in found.items()}
                print(
                    f"{hurst:4} {load:7} {nx // 128:8} {with_error(found['kappa'])} {mean['kappa_counted']:9.3f} "
                    f"{mean['kappa_r']:9.3f} {mean['contact_area_fraction']:7.4f} {mean['nayak']:7.1f} "
                    f"{mean['n_segments']:9.0f}",
                    flush=True,
                )


def kappa_over_nayaks_parameter(load=0.02):
    """Line kappa = a - b ln(alpha) through maps with and without a plateau and of many breadths, 1/eps_c = 4."""
    print(f"kappa of {SURFACES} isotropic maps at p* = {load} and 1/eps_c = 4 over Nayak's parameter alpha")
    print("   H  L_x/lambda_l  lambda_l/lambda_s      alpha   kappa (error)")
    alphas, kappas, errors = [], [], []
    for cut_on, cut_off in ((8, 16), (8, 64), (4, 128), (2, 128)):
        for hurst in (0.0, 0.3, 0.5, 0.8, 1.0):
            found = measured(hurst, cut_off, 8 * cut_off, load, cut_on)
            alphas.append(found["nayak"].mean())
            kappas.append(found["kappa"].mean())
            errors.append(found["kappa"].std(ddof=1) / np.sqrt(SURFACES))
            print(
                f"{hurst:4} {cut_on:13} {cut_off // cut_on:18} {alphas[-1]:10.2f} {with_error(found['kappa'])}",
                flush=True,
            )
    line, covariance = np.polyfit(np.log(alphas), kappas, 1, w=1.0 / np.array(errors), cov=True)
    deviation = np.sqrt(np.diag(covariance))
    print(f"kappa = {line[1]:.3f} ({deviation[1]:.3f}) - {-line[0]:.4f} ({deviation[0]:.4f}) ln(alpha)")


def kappa_over_anisotropy():
    """Paired: the random numbers of each wave are the same for every anisotropy."""
    print(f"kappa of {SURFACES} maps, L_x/lambda_l = 8, lambda_l/lambda_s = 16; differences are paired")
    print("   H      p*  anisotropy  1/eps_c   kappa (error)   counted   more than isotropic   clusters")
    for hurst in (0.3, 0.8):
        for load in (0.007, 0.05):
            for nx in (512, 1024):
                isotropic = None
                for anisotropy in (1.0, 2.0, 4.0, 8.0):
                    found = measured(hurst, 128, nx, load, 8, anisotropy)
                    isotropic = found["kappa"] if isotropic is None else isotropic
                    print(
                        f"{hurst:4} {load:7} {anisotropy:11} {nx // 256:8} {with_error(found['kappa'])} "
                        f"{found['kappa_counted'].mean():9.3f} {with_error(found['kappa'] - isotropic)} "
                        f"{found['n_segments'].mean():9.0f}",
                        flush=True,
                    )
                profiles = line_contact(hurst, nx, load)
                print(f"{hurst:4} {load:7}     profiles {nx // 256:8} {with_error(profiles)}", flush=True)


def line_contact(hurst, nx, load, profiles=600):
    """Kappa of profiles of the same waves, to which maps tend that are ever longer along y."""
    surface = RandomSurface(SelfAffineWaves(hurst, 8, 128), nx, 2018)
    numerics = Options("active_set_newton", residual=RESIDUAL)
    asked = Problem(surface, ElasticBody(None, None), Interactions(hard_wall=True), load, None, numerics)
    found = measure(solution.solve(asked, range(profiles)))
    assert (found["status"] == Status.ok).all()
    return found["kappa"]


def one_pair(nx):
    """Processor seconds of a planned transform and its inverse, in two buffers and in one, all padded; medians of 7."""
    two, one, row = Transform(1, nx, nx), Transform(1, nx, nx, in_place=True), np.arange(1)

    def both():
        two.forward(row)
        two.inverse(row)

    def in_place():
        one.forward(row)
        one.inverse(row)

    return tuple(float(np.median([seconds(transform)[0] for _ in range(7)])) for transform in (both, in_place))


def seconds(action, *arguments):
    """Processor time, of which others on the machine take less than of the clock, and the result."""
    begun = time.process_time()
    result = action(*arguments)
    return time.process_time() - begun, result


def one_map(nx, hurst, load):
    """Time and memory of one map, in a process that has compiled its kernels."""
    for small in (64, 256):
        solution.solve(problem(hurst, 8, small, load), range(1))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    made = solution.solve(problem(hurst, nx // 4, nx, load), range(1))
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    body = SpectralResponse.of_normal(stiffness.half_space(grid.magnitudes((nx, nx))))
    numerics = Options("active_set_newton", residual=RESIDUAL)
    taken, solved = seconds(equilibrate, made.punch, body, load, numerics)
    two, one = one_pair(nx)
    print(
        f"{nx}^2, H = {hurst}, p* = {load}: {taken:.2f} s, {taken / two:.0f} pairs of transforms ({taken / one:.0f} of "
        f"those in place), {solved.n_transforms[0]} transforms, {solved.n_iterations[0]} steps, residual "
        f"{solved.residual[0]:.0e}, {Status(solved.status[0]).name}; at most {memory / 1024:.0f} MB, "
        f"{memory * 1024 / nx**2:.0f} B a node, surface and result included",
        flush=True,
    )


def main():
    if len(sys.argv) > 1:
        return one_map(int(sys.argv[1]), float(sys.argv[2]), float(sys.argv[3]))
    for load in ("0.007", "0.2"):
        for hurst in ("0.8", "0.3"):
            for size in ("512", "1024", "2048", "4096"):
                subprocess.run([sys.executable, __file__, size, hurst, load], check=True)
    kappa_against_the_literature()
    kappa_over_nayaks_parameter()
    kappa_over_anisotropy()


if __name__ == "__main__":
    main()
