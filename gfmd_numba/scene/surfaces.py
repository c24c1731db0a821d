"""The one union of rough surfaces: of a punch, of a body, of campaigns and of `gfmd surface`.

Lengths are in m if the file gives a length L_x, and in L_x otherwise.
"""

from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, BeforeValidator, Field, model_validator

from gfmd_numba.scene.quantities import RECORD, Anisotropy, Hurst, Length, RmsGradient, broken_rule

PositiveHurst = Annotated[float, Field(ge=0.01, le=1, description="Hurst exponent (dimensionless)")]
Points = Annotated[int, Field(ge=4, le=2**40)]


class _Random(BaseModel):
    """Random surface with either an rms height or an rms gradient."""

    model_config = RECORD
    rms_height: Length | None = Field(None, description="Rms height in m, or in L_x without a length")
    rms_gradient: RmsGradient | None = Field(None, description="Root-mean-square gradient (dimensionless)")
    points: Points | None = Field(None, description="Grid points over L_x; None: those of the discretisation")
    cut_on: Length | None = Field(
        None, description="Shortest wavelength; None: that of the discretisation, or the shortest below Nyquist"
    )

    @property
    def needs_discretisation(self) -> bool:
        """Whether eps_c, eps_f and eps_t have to tell its grid and wavelengths."""
        return self.points is None

    @model_validator(mode="after")
    def _one_scale(self) -> Self:
        if (self.rms_height is None) == (self.rms_gradient is None):
            raise broken_rule((), "exactly one of rms_height and rms_gradient")
        return self


class SelfAffine(_Random):
    """Power law between two wavelengths, drawn from its spectral density, thesis (3.28)."""

    method: Literal["psd"] = Field(description="How the surface is made")
    model: Literal["self_affine"] = Field("self_affine", description="Spectrum of the surface")
    hurst: Hurst
    roll_off: Length | None = Field(None, description="Longest wavelength of the power law; None: see cut_on")
    plateau: bool = Field(True, description="Constant spectrum beyond the roll-off, or none")
    anisotropy: Anisotropy | None = Field(
        None, description="Correlation length of a map along y over that along x (dimensionless); None: isotropic"
    )

    @model_validator(mode="after")
    def _order(self) -> Self:
        _check_wavelengths(self, 1)
        return self


class _Correlated(_Random):
    """Isotropic model with a correlation length, thesis (3.10) or (3.13), and perhaps mounds (3.17)."""

    method: Literal["psd", "fourier_filter"] = Field(description="How the surface is made")
    hurst: PositiveHurst
    correlation_length: Length
    mound_separation: Length | None = Field(None, description="Mean distance of mounds; None: no mounds")

    @model_validator(mode="after")
    def _order(self) -> Self:
        _check_points(self)
        if self.mound_separation is not None and self.correlation_length > self.mound_separation:
            raise broken_rule(
                ("correlation_length",),
                f"at most mound_separation = {self.mound_separation:g}, as mounds are not larger than their distance",
            )
        return self


class ExponentialCorrelation(_Correlated):
    """Exponential correlation model, thesis (3.9) to (3.11)."""

    model: Literal["exponential"] = Field(description="Spectrum of the surface")


class KCorrelation(_Correlated):
    """K-correlation model, thesis (3.12) to (3.14)."""

    model: Literal["k_correlation"] = Field(description="Spectrum of the surface")


class LengthAnisotropy(_Random):
    """K-correlation model of maps with two correlation lengths, thesis (3.15)."""

    method: Literal["psd", "fourier_filter"] = Field(description="How the surface is made")
    model: Literal["length_anisotropy"] = Field(description="Spectrum of the surface")
    hurst: PositiveHurst
    correlation_length_x: Length
    correlation_length_y: Length

    @model_validator(mode="after")
    def _has_points(self) -> Self:
        _check_points(self)
        return self


class ScalingAnisotropy(_Random):
    """K-correlation model of maps with two Hurst exponents and correlation lengths, thesis (3.16)."""

    method: Literal["psd", "fourier_filter"] = Field(description="How the surface is made")
    model: Literal["scaling_anisotropy"] = Field(description="Spectrum of the surface")
    hurst_x: PositiveHurst
    hurst_y: PositiveHurst
    correlation_length_x: Length
    correlation_length_y: Length

    @model_validator(mode="after")
    def _has_points(self) -> Self:
        _check_points(self)
        return self


class _Recursive(_Random):
    """Recursive method, thesis 3.5.1: self-affine between two wavelengths."""

    hurst: Hurst
    roll_off: Length | None = Field(None, description="Longest wavelength of the power law; None: see cut_on")

    @model_validator(mode="after")
    def _order(self) -> Self:
        _check_wavelengths(self, 2)
        return self


class MidpointDisplacement(_Recursive):
    """Random midpoint displacement, thesis 3.5.1."""

    method: Literal["midpoint_displacement"] = Field(description="How the surface is made")


class SuccessiveAddition(_Recursive):
    """Successive random addition, thesis 3.5.1.1."""

    method: Literal["successive_addition"] = Field(description="How the surface is made")


class Measured(BaseModel):
    """Measured profile or map, read from a file of the user's."""

    model_config = RECORD
    method: Literal["measured"] = Field(description="How the surface is made")
    file: str = Field(min_length=1, description="Profile or map, relative to the folder of the file that names it")
    detrend: Literal["none", "mean", "tilt", "curvature"] = Field("none", description="What is subtracted first")
    periodic: Literal["none", "mirror", "window"] = Field("none", description="How the ends are made to meet")
    points: Points | None = Field(None, description="Grid points over L_x after resampling; None: as many as measured")

    @property
    def needs_discretisation(self) -> bool:
        """Never: a measured surface has its own grid."""
        return False


def _self_affine_by_default(given: Any) -> Any:
    return {"model": "self_affine", **given} if isinstance(given, dict) else given


Spectral = Annotated[
    Annotated[
        SelfAffine | ExponentialCorrelation | KCorrelation | LengthAnisotropy | ScalingAnisotropy,
        Field(discriminator="model", description="Spectrum of the surface"),
    ],
    BeforeValidator(_self_affine_by_default),
]
Surface = Annotated[
    Spectral | MidpointDisplacement | SuccessiveAddition | Measured,
    Field(discriminator="method", description="Roughness of a surface"),
]
Random = (
    SelfAffine
    | ExponentialCorrelation
    | KCorrelation
    | LengthAnisotropy
    | ScalingAnisotropy
    | MidpointDisplacement
    | SuccessiveAddition
)
OF_MAPS = (LengthAnisotropy, ScalingAnisotropy)  # whose two directions differ
OF_WAVELENGTHS = (SelfAffine, MidpointDisplacement, SuccessiveAddition)  # with a cut-on and a roll-off


def _check_wavelengths(surface: SelfAffine | _Recursive, least_ratio: float) -> None:
    """Raise a located error unless points and both wavelengths, with at least this ratio, are given or none is."""
    given = {name: getattr(surface, name) is not None for name in ("points", "cut_on", "roll_off")}
    if len(set(given.values())) > 1:
        missing = next(name for name, there in given.items() if not there)
        raise broken_rule((missing,), "points, cut_on and roll_off together, or none of them and a discretisation")
    if surface.cut_on is None or surface.roll_off is None:
        return
    if surface.cut_on >= surface.roll_off or least_ratio * surface.cut_on > surface.roll_off:
        limit = f"a wavelength below roll_off = {surface.roll_off:g}"
        raise broken_rule(
            ("cut_on",), limit if least_ratio == 1 else f"at most half of roll_off = {surface.roll_off:g}"
        )


def _check_points(surface: _Correlated | LengthAnisotropy | ScalingAnisotropy) -> None:
    """Raise a located error unless a model with lengths of its own says on how many points it is drawn."""
    if surface.points is None:
        raise broken_rule(("points",), "the number of grid points over L_x, as the model has lengths of its own")


def misfit(surface: Surface, period: float) -> tuple[str, str] | None:
    """Key of the wavelength that does not fit its grid or period, and what is allowed there; None if all fit."""
    if isinstance(surface, Measured) or surface.points is None:
        return None
    finest = period / ((surface.points - 1) // 2)
    if surface.cut_on is not None and surface.cut_on < finest * (1 - 1e-9):
        return "cut_on", f"at least {finest:.6g}, the shortest wavelength below Nyquist of {surface.points} points"
    roll_off = surface.roll_off if isinstance(surface, OF_WAVELENGTHS) else None
    if roll_off is not None and roll_off > period * (1 + 1e-9):
        return "roll_off", f"at most the period {period:g}"
    if surface.cut_on is not None and int(period / surface.cut_on * (1 + 1e-9)) < period / (roll_off or period) * (
        1 - 1e-9
    ):
        return (
            "cut_on",
            f"a wavelength so short that a whole number of waves fits the period {period:g} with it or less",
        )
    anisotropy = surface.anisotropy if isinstance(surface, SelfAffine) else None
    if anisotropy is not None and roll_off is not None and anisotropy > period / roll_off * (1 + 1e-9):
        most = f"at most the period over roll_off = {period / roll_off:.6g}"
        return "anisotropy", f"{most}, so that the longest wavelength along y fits the period"
    return None
