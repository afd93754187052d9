//! The codes of errors of scene files, beside those of their text.

data_file::codes! {
    RANGE = "C001": "A number of a scene is not finite, or out of its range.";
    NAME = "C002": "A scene names a built-in geometry, a file, a light, an object, a material or a texture that is not there.";
    CONFLICT = "C003": "Values of a scene do not go together: an inner cone wider than the outer one, a camera that looks at its own position, keys whose times do not rise.";
    MAP = "C004": "The map of an environment cannot be read, or has pixels that are no radiance: NaN, infinite or negative.";
    FILE = "C005": "A file that a scene of pbrt or Mitsuba names cannot be read: a mesh, a picture, or another part of the scene.";
    FORMAT = "C006": "The text of a scene is not that of its format: pbrt-v4, or Mitsuba 3 in XML.";
    VALUE = "C007": "A value of a scene of pbrt or Mitsuba is of another type than is expected, is no number, or is one of too few or too many.";
}
