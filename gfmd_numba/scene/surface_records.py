"""Records of a surface file: one rough surface, random or measured. Lengths are in m, or in L_x without a length."""

from typing import Annotated, Literal, Self

from pydantic import BaseModel, Field, model_validator

from gfmd_numba.scene.quantities import RECORD, Dimension, Hurst, RmsGradient, Seed, Size, broken_rule

PositiveHurst = Annotated[float, Field(ge=0.01, le=1, description="Hurst exponent (dimensionless)")]
Length = Annotated[Size, Field(description="Length in m, or in L_x without a length")]


class SelfAffineModel(BaseModel):
    """Power law between two wavelengths, thesis (3.28); a plateau or nothing beyond the longer one."""

    model_config = RECORD
    model: Literal["self_affine"]
    hurst: Hurst
    cut_on: Length
    roll_off: Length
    plateau: bool = Field(True, description="Constant spectrum beyond the roll-off, or none")

    @model_validator(mode="after")
    def _order(self) -> Self:
        if self.cut_on >= self.roll_off:
            raise broken_rule(("cut_on",), f"a wavelength below roll_off = {self.roll_off:g}")
        return self


class _Correlated(BaseModel):
    """Isotropic model with a correlation length, thesis (3.10) or (3.13), and perhaps mounds (3.17)."""

    model_config = RECORD
    hurst: PositiveHurst
    correlation_length: Length
    mound_separation: Length | None = Field(None, description="Mean distance of mounds; None: no mounds")
    cut_on: Length | None = Field(None, description="Shortest wavelength; None: the shortest below Nyquist")

    @model_validator(mode="after")
    def _order(self) -> Self:
        if self.mound_separation is not None and self.correlation_length > self.mound_separation:
            raise broken_rule(
                ("correlation_length",),
                f"at most mound_separation = {self.mound_separation:g}, as mounds are not larger than their distance",
            )
        return self


class ExponentialModel(_Correlated):
    """Exponential correlation model, thesis (3.9) to (3.11)."""

    model: Literal["exponential"]


class KCorrelationModel(_Correlated):
    """K-correlation model, thesis (3.12) to (3.14)."""

    model: Literal["k_correlation"]


class LengthAnisotropyModel(BaseModel):
    """K-correlation model with two correlation lengths, thesis (3.15)."""

    model_config = RECORD
    model: Literal["length_anisotropy"]
    hurst: PositiveHurst
    correlation_length_x: Length
    correlation_length_y: Length
    cut_on: Length | None = Field(None, description="Shortest wavelength; None: the shortest below Nyquist")


class ScalingAnisotropyModel(BaseModel):
    """K-correlation model with two Hurst exponents and correlation lengths, thesis (3.16)."""

    model_config = RECORD
    model: Literal["scaling_anisotropy"]
    hurst_x: PositiveHurst
    hurst_y: PositiveHurst
    correlation_length_x: Length
    correlation_length_y: Length
    cut_on: Length | None = Field(None, description="Shortest wavelength; None: the shortest below Nyquist")


Spectral = Annotated[
    SelfAffineModel | ExponentialModel | KCorrelationModel | LengthAnisotropyModel | ScalingAnisotropyModel,
    Field(discriminator="model", description="Spectrum of the surface"),
]
Correlated = Annotated[
    ExponentialModel | KCorrelationModel | LengthAnisotropyModel | ScalingAnisotropyModel,
    Field(discriminator="model", description="Autocorrelation of the surface"),
]


class _Scaled(BaseModel):
    """Random surface with either an rms height (m or L_x) or an rms gradient."""

    model_config = RECORD
    rms_height: Size | None = Field(None, description="Rms height in m, or in L_x without a length")
    rms_gradient: RmsGradient | None = None

    @model_validator(mode="after")
    def _one_scale(self) -> Self:
        if (self.rms_height is None) == (self.rms_gradient is None):
            raise broken_rule((), "exactly one of rms_height and rms_gradient")
        return self


class SpectralDensity(_Scaled):
    """Power spectral density method, thesis 3.5.2.1."""

    method: Literal["psd"]
    spectrum: Spectral


class FourierFilter(_Scaled):
    """Fourier filtering method, thesis 3.5.2."""

    method: Literal["fourier_filter"]
    spectrum: Correlated


class _Recursive(_Scaled):
    """Recursive method, thesis 3.5.1: self-affine between two wavelengths."""

    hurst: Hurst
    cut_on: Length
    roll_off: Length

    @model_validator(mode="after")
    def _order(self) -> Self:
        if 2 * self.cut_on > self.roll_off:
            raise broken_rule(("cut_on",), f"at most half of roll_off = {self.roll_off:g}")
        return self


class MidpointDisplacement(_Recursive):
    """Random midpoint displacement, thesis 3.5.1."""

    method: Literal["midpoint_displacement"]


class SuccessiveAddition(_Recursive):
    """Successive random addition, thesis 3.5.1.1."""

    method: Literal["successive_addition"]


class MeasuredField(BaseModel):
    """The user's own profile or map, made periodic."""

    model_config = RECORD
    method: Literal["measured"]
    file: str = Field(min_length=1, description="Profile or map, relative to the surface file's folder")
    detrend: Literal["none", "mean", "tilt", "curvature"] = Field("tilt", description="What is subtracted first")
    periodic: Literal["none", "mirror", "window"] = Field("none", description="How the ends are made to meet")


Texture = Annotated[
    SpectralDensity | FourierFilter | MidpointDisplacement | SuccessiveAddition | MeasuredField,
    Field(discriminator="method", description="How the surface is made"),
]


class HurstRange(BaseModel):
    """Wavelengths between which the Hurst exponent is fitted."""

    model_config = RECORD
    shortest: Length
    longest: Length

    @model_validator(mode="after")
    def _order(self) -> Self:
        if self.shortest >= self.longest:
            raise broken_rule(("shortest",), f"a wavelength below longest = {self.longest:g}")
        return self


class SurfaceFile(BaseModel):
    """One rough surface: how it is made, its period L_x and its grid."""

    model_config = RECORD
    surface: Texture
    length: Size | None = Field(
        None, description="Period L_x in m, of a measured field its size along x; None: lengths are in L_x"
    )
    dimension: Dimension | None = Field(None, description="1: a profile, 2: a map; a measured field has its own")
    points: int | None = Field(
        None, ge=4, le=2**40, description="Grid points over L_x; None: those of a measured field"
    )
    seed: Seed = 0
    realisation: int = Field(0, ge=0, lt=2**63, description="Which realisation of the random surface")
    hurst_range: HurstRange | None = Field(None, description="Where the Hurst exponent is fitted; None: nowhere")

    @model_validator(mode="after")
    def _parts_agree(self) -> Self:
        surface = self.surface
        if isinstance(surface, MeasuredField):
            if self.dimension is not None:
                raise broken_rule(("dimension",), "nothing, as a measured field has its own")
            return self
        if self.points is None:
            raise broken_rule(("points",), "a whole number at least 4, which a random surface needs")
        one_direction = SelfAffineModel | ExponentialModel | KCorrelationModel
        if isinstance(surface, SpectralDensity | FourierFilter):
            if self.dimension != 2 and not isinstance(surface.spectrum, one_direction):
                raise broken_rule(("dimension",), f"2, which model {surface.spectrum.model} needs")
            roll_off = surface.spectrum.roll_off if isinstance(surface.spectrum, SelfAffineModel) else None
            self._check_wavelengths(("surface", "spectrum"), surface.spectrum.cut_on, roll_off)
        else:
            self._check_wavelengths(("surface",), surface.cut_on, surface.roll_off)
        return self

    def _check_wavelengths(self, location: tuple[str, ...], cut_on: float | None, roll_off: float | None) -> None:
        period = self.length or 1.0
        assert self.points is not None
        finest = period / ((self.points - 1) // 2)
        if cut_on is not None and cut_on < finest * (1 - 1e-9):
            raise broken_rule(
                (*location, "cut_on"),
                f"at least {finest:.6g}, the shortest wavelength below Nyquist of {self.points} points",
            )
        if roll_off is not None and roll_off > period * (1 + 1e-9):
            raise broken_rule((*location, "roll_off"), f"at most the period {period:g}")
