#!/bin/sh
# Remakes the pictures of bloom of docs/sequences.md (the quad paper's Figure 16). Run from the repository's root; AUREOLE
# and PYTHON as in sequence_figures.sh.
set -eu
AUREOLE=${AUREOLE:-aureole}
PYTHON=${PYTHON:-python3}
TO=docs/pictures
TEMP=$(mktemp -d)
trap 'rm -rf "$TEMP"' EXIT

$PYTHON docs/sequence_pictures.py shot "$TEMP" 1
for mode in scatter bloom; do
    $AUREOLE glare "$TEMP/shot.1001.exr" -o "$TEMP/$mode.exr" --f-number 22 --blades 6 --dust 15% --seed 7 \
        --mode $mode --preview "$TEMP/$mode.png"
done
$PYTHON docs/sequence_pictures.py stack $TO/sequence-bloom.jpg 900x200+1000+20 "$TEMP/scatter.png" "$TEMP/bloom.png"
