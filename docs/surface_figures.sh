#!/bin/sh
# Remakes the pictures of docs/surface.md. Run it from the repository's root, or `make figures`. PYTHON names the
# interpreter, if it is not on the path. It takes some minutes; nothing is downloaded.
set -eu
PYTHON=${PYTHON:-python3}
TO=docs/pictures

# The README's picture.
$PYTHON docs/surface_lights.py hero $TO/surface-hero.jpg

# Gratings under lamps.
$PYTHON docs/surface_pictures.py disc $TO/surface-disc.jpg
$PYTHON docs/surface_pictures.py discs $TO/surface-discs.jpg
$PYTHON docs/surface_pictures.py blazed $TO/surface-blazed.jpg
$PYTHON docs/surface_pictures.py mask $TO/surface-mask.jpg
$PYTHON docs/surface_pictures.py cylinder $TO/surface-cylinder.jpg
$PYTHON docs/surface_pictures.py spectra $TO/surface-spectra.jpg
$PYTHON docs/surface_pictures.py focus $TO/surface-focus.jpg
$PYTHON docs/surface_pictures.py regions $TO/surface-regions.jpg

# Measured on a simulated bench.
$PYTHON docs/surface_measured.py bench $TO/surface-bench.png
$PYTHON docs/surface_measured.py table $TO/surface-table.jpg
$PYTHON docs/surface_measured.py screens $TO/surface-screens.jpg
$PYTHON docs/surface_measured.py channels $TO/surface-channels.jpg
$PYTHON docs/surface_measured.py taylor $TO/surface-taylor.jpg
$PYTHON docs/surface_measured.py bokeh $TO/surface-bokeh.png

# Lamps that are no points, and light from all around.
$PYTHON docs/surface_lights.py lamps $TO/surface-lamps.jpg
$PYTHON docs/surface_lights.py rooms $TO/surface-rooms.jpg
$PYTHON docs/surface_lights.py turned $TO/surface-turned.jpg
$PYTHON docs/surface_lights.py prefilter $TO/surface-prefilter.png
