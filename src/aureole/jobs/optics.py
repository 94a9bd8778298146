"""Apertures and cameras as people describe them, and the records that they mean.

Whatever is left out is taken from a preset; without a preset the camera is a full-frame one of 50 mm at
f/16 with seven straight blades.
"""

import math
from dataclasses import dataclass

from aureole import aperture as apertures
from aureole import glare, picture, presets, refuse
from aureole.records import Aperture, Camera

DEFAULT_CAMERA = "full-frame-50mm-f16"
SHAPES = ("iris", "circle", "rectangle", "whirl", "picture")


@dataclass(frozen=True)
class Opening:
    """The shape of an opening; None leaves a value to the preset.

    Parameters
    ----------
    shape : str, optional
        One of `SHAPES`.
    blades : int, optional
        Of an iris, or arms of a whirl.
    curvature : float, optional
        Of an iris's blades, 0 straight to 1 circle.
    rotation : float, optional
        Radians, counter-clockwise as seen.
    obstruction : float, optional
        Diameter of a central disc over the opening's own, 0 <= o < 1.
    width, height : float, optional
        Size of a rectangle in metres, or `width` as the diameter of any other shape; the f-number
        sets the size where they are left out.
    picture : str, optional
        File whose white lets light through, for shape "picture".
    """

    shape: str | None = None
    blades: int | None = None
    curvature: float | None = None
    rotation: float | None = None
    obstruction: float | None = None
    width: float | None = None
    height: float | None = None
    picture: str | None = None

    def build(self, iris: str) -> Aperture:
        """Make the aperture; what is left out comes from the iris preset of this name.

        Parameters
        ----------
        iris : str
            Name of an iris preset, or path of its file.

        Returns
        -------
        Aperture
            At its own size where `width` is given, else 1 m wide, to be scaled.

        Raises
        ------
        refuse.Refusal
            Where a value does not fit, or does not go with the shape.
        """
        preset = presets.load("irises", iris)
        shape = self._shape(preset.shape)
        refuse.one_of("aperture", shape, SHAPES)
        self._refuse_strangers(shape)
        rotation = math.radians(preset.rotation_deg) if self.rotation is None else self.rotation
        whole = self._whole(shape, preset, rotation)
        obstruction = preset.obstruction if self.obstruction is None else self.obstruction
        if obstruction:
            refuse.between("obstruction", obstruction, 0, 0.999)
            whole = apertures.subtraction(whole, apertures.circle(obstruction * whole.width))
        return whole

    def _shape(self, preset_shape: str) -> str:
        """Infer the shape from what is given, else from the preset."""
        if self.shape is not None:
            return self.shape
        if self.picture is not None:
            return "picture"
        if self.blades is not None or self.curvature is not None:
            return "iris"
        return preset_shape

    def _refuse_strangers(self, shape: str) -> None:
        """Refuse values that the shape has no use for."""
        uses = {
            "blades": ("iris", "whirl"),
            "curvature": ("iris",),
            "height": ("rectangle",),
            "picture": ("picture",),
        }
        for name, shapes in uses.items():
            if getattr(self, name) is not None and shape not in shapes:
                raise refuse.Refusal(
                    f"'{name}' does not go with aperture '{shape}'; it is for {' or '.join(shapes)}."
                )
        if self.rotation and shape == "picture":
            raise refuse.Refusal("'rotation' does not go with aperture 'picture'; turn the picture itself.")

    def _whole(self, shape: str, preset: presets.IrisPreset, rotation: float) -> Aperture:
        """Make the opening without its obstruction."""
        size = 1.0 if self.width is None else self.width
        if shape == "circle":
            return apertures.circle(size)
        if shape == "rectangle":
            if self.width is None or self.height is None:
                raise refuse.Refusal("aperture 'rectangle' needs 'width' and 'height', such as 2mm and 1mm.")
            return apertures.rotated(apertures.rectangle(self.width, self.height), rotation)
        if shape == "whirl":
            return apertures.whirl(size, 5 if self.blades is None else self.blades, rotation)
        if shape == "picture":
            if self.picture is None:
                raise refuse.Refusal("aperture 'picture' needs the file: --aperture-picture FILE.")
            return apertures.from_picture(picture.read(self.picture), size)
        blades = preset.blades if self.blades is None else self.blades
        curvature = preset.curvature if self.curvature is None else self.curvature
        return apertures.iris(blades, size, curvature, rotation)


@dataclass(frozen=True)
class Optics:
    """A camera as people describe it; None leaves a value to the preset.

    Parameters
    ----------
    opening : Opening
        The iris's shape.
    preset : str, optional
        Name of a camera preset, or path of its file.
    iris : str, optional
        Name of an iris preset, or path of its file.
    focal_length, f_number : float, optional
        Metres, and focal length over diameter.
    sensor_width, sensor_height : float, optional
        Metres.
    """

    opening: Opening = Opening()
    preset: str | None = None
    iris: str | None = None
    focal_length: float | None = None
    f_number: float | None = None
    sensor_width: float | None = None
    sensor_height: float | None = None

    def camera(
        self,
        resolution: tuple[int, int] | None = None,
        pixel_aspect: float = 1.0,
        pixel_pitch: float | None = None,
    ) -> Camera:
        """Make the camera.

        Parameters
        ----------
        resolution : tuple of int, optional
            (rows, columns) of a picture that spans the sensor's width; the preset's own otherwise.
        pixel_aspect : float
            Width of a pixel over its height.
        pixel_pitch : float, optional
            Width of a pixel in metres, in place of the sensor's.

        Returns
        -------
        Camera
            Its iris and f-number as described.

        Raises
        ------
        refuse.Refusal
            Where a value does not fit.
        """
        preset: presets.CameraPreset = presets.load("cameras", self.preset or DEFAULT_CAMERA)
        focal_length = _given("focal_length", self.focal_length, preset.focal_length_mm * 1e-3)
        iris = self.opening.build(self.iris or preset.iris)
        if self.opening.width is None:
            f_number = _given("f_number", self.f_number, preset.f_number)
        elif self.f_number is not None:
            raise refuse.Refusal("'width' and 'f_number' both set the opening's size; give one of them.")
        else:
            f_number = focal_length / iris.width
        width = _given("sensor_width", self.sensor_width, preset.sensor_width_mm * 1e-3)
        height = _given("sensor_height", self.sensor_height, preset.sensor_height_mm * 1e-3)
        rows, columns = resolution or (preset.rows, preset.columns)
        refuse.positive("pixel_aspect", pixel_aspect)
        if pixel_pitch is not None:
            width = refuse.positive("pixel_pitch", pixel_pitch) * columns
        if resolution or pixel_pitch:
            height = width / columns / pixel_aspect * rows
        return glare.camera(focal_length, f_number, iris, width, height, (rows, columns))


def _given(name: str, value: float | None, otherwise: float) -> float:
    return otherwise if value is None else refuse.positive(name, value)
