"""The surface paper's prefiltered reflection map (section 6.2), for comparison.

The light is filtered with the table as if sample and camera both faced the mirror direction r of the
view: P(r) = 4π² ∫ S_d(s) L(s) ds about r, after McAuley et al. 2013; a view then shows P at its mirror
direction. It is exact where the camera looks along the normal, and bends lobes where it does not.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole.surface.environment import Environment, directions_checked, frame_checked, frame_of
from aureole.surface.quadrature import BorderSums, borders
from aureole.surface.table import ScatterTable


def prefiltered(
    table: ScatterTable,
    environment: Environment,
    frame: ArrayLike,
    views: ArrayLike,
) -> NDArray[np.float64]:
    """Look up the paper's prefiltered light at the mirror directions of some views.

    Parameters
    ----------
    table : ScatterTable
        Of the sample.
    environment : Environment
        The light.
    frame : array_like, shape (3, 3)
        Tangent, bitangent and normal of the sample in the world.
    views : array_like, shape (V, 2)
        Direction cosines along tangent and bitangent.

    Returns
    -------
    ndarray of float64, shape (V, 3)
        4π² ∫ S_d L ds, without F² G.
    """
    axes = frame_checked(frame)
    places = directions_checked("views", views).reshape(-1, 2)
    mirrors = np.column_stack([-places, np.sqrt(np.maximum(0.0, 1.0 - (places**2).sum(axis=1)))])
    sums, straight = BorderSums(table, environment.colour_space), np.zeros((1, 2))
    found = []
    for mirror in mirrors:
        # The mirror direction becomes the normal, and the tangent keeps its heading.
        turned = frame_of(mirror @ axes, axes[0] if abs(mirror[0]) < 0.999999 else axes[1])
        found.append(sums(borders(environment, turned), straight)[0])
    return np.asarray(found).reshape(-1, 3)
