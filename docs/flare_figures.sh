#!/bin/sh
# Remakes the pictures of docs/flare.md, with commands where there is one. Run it from the repository's root, or
# `make figures`. AUREOLE names the command and PYTHON the interpreter, if they are not on the path.
set -eu
AUREOLE=${AUREOLE:-aureole}
PYTHON=${PYTHON:-python3}
TO=docs/pictures
TEMP=$(mktemp -d)
trap 'rm -rf "$TEMP"' EXIT

ghosts() { # the preview of a flare: NAME, then flags
    name=$1; shift
    $AUREOLE flare --illuminant D65 "$@" -o "$TEMP/flare.exr" --preview "$TO/$name" --json
}

ghosts flare-heliar.jpg --lens heliar_tronnier_100mm --light 5deg,3deg --f-number 16 --blades 6 --size 960x540
ghosts flare-biotar.jpg --lens zeiss_biotar_50mm --light 12deg,-6deg --ghosts all --size 640x360
ghosts flare-anamorphic.jpg --lens schneider_anamorphic_31mm --light 10deg,5deg --f-number 4 --ghosts all --size 640x360

# The paper's Figure 3: a zoom in section, with two ghosts' ways.
$AUREOLE lens show nikon_tele_zoom_140mm_seed --ghost 2,5 --ghost 10,14 --angle 3deg -o "$TO/flare-paths.jpg" --json

# The paper's Figure 8: a ghost as quads of rays, unmerged and merged.
$PYTHON docs/ghosts.py levels $TO/flare-merge-none.png $TO/flare-merge-light.png $TO/flare-merge-heavy.png

# The paper's Figure 12: one light and two, and insets beside the reference.
$PYTHON docs/ghosts.py insets $TO/flare-insets.jpg

# A ghost's edge in three colours, filtered, and in bands of colour.
$PYTHON docs/ghosts.py filters $TO/flare-flat.jpg $TO/flare-spectral.jpg $TO/flare-bands.jpg
