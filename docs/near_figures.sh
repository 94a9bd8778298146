#!/bin/sh
# Remakes the pictures of docs/near-field.md, with commands where there is one. Run it from the repository's root, or
# `make figures`. AUREOLE names the command and PYTHON the interpreter, if they are not on the path.
set -eu
AUREOLE=${AUREOLE:-aureole}
PYTHON=${PYTHON:-python3}
TO=docs/pictures
TEMP=$(mktemp -d)
trap 'rm -rf "$TEMP"' EXIT

near() { # a plane's picture: NAME, then flags
    name=$1; shift
    $AUREOLE nearfield "$@" -o "$TO/$name" --json
}

# A heptagon at four Fresnel numbers, brightest spot white.
for number in 1 5 30 200; do
    near near-$number.jpg --blades 7 --width 2mm --fresnel-number $number --extent 3mm --size 360
done

# An obstacle, and an edge.
near near-spot.jpg --aperture circle --width 2mm --obstacle --fresnel-number 10 --extent 4mm --size 360
near near-edge.jpg --aperture half-plane --distance 1m --extent 8mm --size 360

# The paper's Figure 12: what samples do as the plane comes closer.
$PYTHON docs/aliasing.py $TO/aliasing.jpg

# The paper's Figure 6: a shadowed opening of 1024 x 1024 pixels and of 128 x 128, and five times their difference.
$PYTHON docs/differences.py levels "$TO/near-full.jpg" "$TO/near-eighth.jpg" "$TO/near-difference.jpg"

# The paper's Figure 7: all wavelengths, one pattern scaled a little, and scaled as a far field.
$PYTHON docs/differences.py colours "$TO/near-exact.jpg" "$TO/near-approximate.jpg" "$TO/near-scaled.jpg"

# A strip of planes, and a section along the axis.
$AUREOLE nearfield --blades 7 --width 2mm --sweep 0.01m:2m:8 --extent 4mm --size 200 -o "$TO/near-strip.jpg" --json
$AUREOLE nearfield --aperture circle --width 2mm --sweep 0.1m:2m --extent 3mm --size 720x360 \
    --section "$TO/near-section.jpg" --json

# Ringing textures: an iris, and the same cropped by its housing.
texture() { # a picture: NAME, then flags
    name=$1; shift
    $AUREOLE nearfield --blades 7 --width 2mm --fresnel-number 30 --illuminant D65 --size 360 --texture "$@" \
        -o "$TO/$name" --json
}
texture texture-iris.jpg
texture texture-cats-eye.jpg --housing 0.5,0,1.1
