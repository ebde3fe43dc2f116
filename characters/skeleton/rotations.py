"""Unit quaternions xyzw, as in glTF, over any leading axes; all functions broadcast.

A product is one outer product and one matrix product with a constant table: for the few dozen
joints of a skeleton the number of NumPy calls sets the cost.

Source of the formulas: Shoemake, "Animating rotation with quaternion curves", SIGGRAPH 1985.
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

IDENTITY: Array = np.array([0.0, 0.0, 0.0, 1.0])
"""The rotation by no angle, xyzw."""


def _multiplication_table() -> Array:
    """Return (16, 4): component k of ``a b`` is ``sum(outer(a, b).ravel() * table[:, k])``."""
    x, y, z, w = range(4)
    table = np.zeros((4, 4, 4))
    terms = {
        x: [(w, x, 1), (x, w, 1), (y, z, 1), (z, y, -1)],
        y: [(w, y, 1), (x, z, -1), (y, w, 1), (z, x, 1)],
        z: [(w, z, 1), (x, y, 1), (y, x, -1), (z, w, 1)],
        w: [(w, w, 1), (x, x, -1), (y, y, -1), (z, z, -1)],
    }
    for k, products in terms.items():
        for i, j, sign in products:
            table[i, j, k] = sign
    return table.reshape(16, 4)


def _matrix_table() -> Array:
    """Return (10, 9): the rotation matrix of q, row by row, from the products of `_PAIRS`."""
    x, y, z, w = range(4)
    table = np.zeros((4, 4, 3, 3))
    for row in range(3):
        for i in range(4):
            table[i, i, row, row] = 1.0 if i in (row, w) else -1.0
    # 2(xy − zw) above the diagonal, 2(xy + zw) below it, and in turn for the other two pairs.
    for row, column, i, j, k in [(0, 1, x, y, z), (1, 2, y, z, x), (2, 0, x, z, y)]:
        table[i, j, row, column] = table[i, j, column, row] = 2.0
        table[k, w, row, column], table[k, w, column, row] = -2.0, 2.0
    return table.reshape(4, 4, 9)[_PAIRS]


_PAIRS = np.triu_indices(4)
"""Numbers of the components in the ten different products of two components of one quaternion."""

_FACTORS = np.repeat(np.arange(4), 4), np.tile(np.arange(4), 4)
"""Numbers of the components in the sixteen products of components of two quaternions."""

_PRODUCT_TABLE = _multiplication_table()
_MATRIX_TABLE = _matrix_table()


def multiply(a: ArrayLike, b: ArrayLike) -> Array:
    """Return the product a b: the rotation b followed by a.

    >>> quarter = about("y", np.pi / 2)
    >>> np.allclose(multiply(quarter, quarter), about("y", np.pi))
    True
    """
    left, right = _FACTORS
    products = np.asarray(a, float).take(left, -1) * np.asarray(b, float).take(right, -1)
    product: Array = products @ _PRODUCT_TABLE
    return product


def conjugate(q: ArrayLike) -> Array:
    """Return the inverse rotation of unit quaternions.

    >>> q = about("x", 0.3)
    >>> np.allclose(multiply(q, conjugate(q)), IDENTITY)
    True
    """
    inverse: Array = np.asarray(q, float) * _CONJUGATE_SIGNS
    return inverse


_CONJUGATE_SIGNS = np.array([-1.0, -1.0, -1.0, 1.0])


def normalize(q: ArrayLike) -> Array:
    """Return q at unit length; a zero quaternion becomes the identity.

    >>> normalize([0, 0, 0, 2]).tolist(), normalize([0, 0, 0, 0]).tolist()
    ([0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0])
    """
    q = np.asarray(q, float)
    squared = np.vecdot(q, q)[..., None]
    if squared.min(initial=1.0) < 1e-24:
        return np.where(squared < 1e-24, IDENTITY, q / np.sqrt(np.maximum(squared, 1e-24)))
    unit: Array = q / np.sqrt(squared)
    return unit


def rotate(q: ArrayLike, vectors: ArrayLike) -> Array:
    """Return rotated vectors (…, 3).

    >>> np.allclose(rotate(about("y", np.pi / 2), [0, 0, 1]), [1, 0, 0])
    True
    """
    turned: Array = (to_matrix(q) @ np.asarray(vectors, float)[..., None])[..., 0]
    return turned


def about(axis: str | ArrayLike, angle: ArrayLike) -> Array:
    """Return the rotation about "x", "y", "z" or a direction (…, 3) by an angle [rad].

    >>> about("z", np.pi).round(6).tolist()
    [0.0, 0.0, 1.0, 0.0]
    """
    if isinstance(axis, str):
        axis = np.eye(3)["xyz".index(axis)]
    direction = np.asarray(axis, float)
    direction = direction / np.linalg.norm(direction, axis=-1, keepdims=True)
    half = np.asarray(angle, float)[..., None] / 2
    q = np.empty((*np.broadcast_shapes(direction.shape[:-1], half.shape[:-1]), 4))
    q[..., :3] = direction * np.sin(half)
    q[..., 3:] = np.cos(half)
    return q


def from_euler(order: str, angles: ArrayLike) -> Array:
    """Return the product of rotations about the axes of `order`, (…, n) angles [rad].

    The first axis is applied last, so lower-case "yxz" is yaw, then pitch, then roll of the body.

    >>> a = from_euler("yx", [0.4, 0.2])
    >>> np.allclose(a, multiply(about("y", 0.4), about("x", 0.2)))
    True
    """
    angles = np.asarray(angles, float)
    result = about(order[0], angles[..., 0])
    for number, axis in enumerate(order[1:], start=1):
        result = multiply(result, about(axis, angles[..., number]))
    return result


def between(start: ArrayLike, end: ArrayLike) -> Array:
    """Return the shortest rotation that turns directions `start` to `end`, both (…, 3).

    >>> np.allclose(rotate(between([0, 1, 0], [1, 0, 0]), [0, 2, 0]), [2, 0, 0])
    True
    >>> np.allclose(rotate(between([0, 1, 0], [0, -1, 0]), [0, 1, 0]), [0, -1, 0])
    True
    """
    a, b = np.broadcast_arrays(np.asarray(start, float), np.asarray(end, float))
    a = a / np.linalg.norm(a, axis=-1, keepdims=True)
    b = b / np.linalg.norm(b, axis=-1, keepdims=True)
    half = np.empty((*a.shape[:-1], 4))
    half[..., :3] = cross(a, b)
    # (a × b, 1 + a·b) is twice the wanted rotation times the cosine of half the angle: no
    # trigonometry.
    half[..., 3] = 1 + np.einsum("...i,...i->...", a, b)
    opposite = half[..., 3] < 1e-9
    if opposite.any():  # any perpendicular axis will do
        across = cross(a, np.eye(3)[np.abs(a).argmin(-1)])
        half[..., :3] = np.where(opposite[..., None], across, half[..., :3])
        half[..., 3] = np.where(opposite, 0.0, half[..., 3])
    return normalize(half)


def cross(a: ArrayLike, b: ArrayLike) -> Array:
    """Return cross products of (…, 3); several times as fast as `np.cross` on a few vectors.

    >>> cross([1, 0, 0], [0, 1, 0]).tolist()
    [0.0, 0.0, 1.0]
    """
    a, b = np.asarray(a, float), np.asarray(b, float)
    product: Array = a[..., _YZX] * b[..., _ZXY] - a[..., _ZXY] * b[..., _YZX]
    return product


_YZX, _ZXY = np.array([1, 2, 0]), np.array([2, 0, 1])


def from_rotation_vector(vector: ArrayLike) -> Array:
    """Return the rotation about `vector` (…, 3) by its length [rad]: the exponential map.

    >>> np.allclose(from_rotation_vector([0, 0.3, 0]), about("y", 0.3))
    True
    """
    vector = np.asarray(vector, float)
    halves = 0.5 * vector
    half = np.sqrt(np.vecdot(halves, halves))[..., None]
    # Near zero the sine equals its angle to the last bit.
    safe = np.maximum(half, 1e-9)
    q = np.empty((*vector.shape[:-1], 4))
    np.multiply(halves, np.sin(safe) / safe, out=q[..., :3])
    np.cos(half, out=q[..., 3:])
    return q


def to_rotation_vector(q: ArrayLike) -> Array:
    """Return axis times angle [rad], (…, 3), of the shorter way: the logarithm.

    >>> np.allclose(to_rotation_vector(-about("y", 0.3)), [0, 0.3, 0])
    True
    """
    q = np.asarray(q, float)
    # q and −q are one rotation; that with w ≥ 0 has the angle of at most half a turn.
    q = np.where(q[..., 3:] < 0, -q, q)
    sine = np.sqrt(np.einsum("...i,...i->...", q[..., :3], q[..., :3]))[..., None]
    # Not arccos of w: near the identity it loses half of the digits.
    angle = 2 * np.arctan2(sine, q[..., 3:])
    vector: Array = q[..., :3] * np.where(sine > 1e-9, angle / np.maximum(sine, 1e-9), 2.0)
    return vector


def to_matrix(q: ArrayLike) -> Array:
    """Return rotation matrices (…, 3, 3) of unit quaternions.

    >>> to_matrix(about("z", np.pi / 2)).round(6).tolist()
    [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    """
    q = np.asarray(q, float)
    first, second = _PAIRS
    rows: Array = (q.take(first, -1) * q.take(second, -1)) @ _MATRIX_TABLE
    return rows.reshape((*q.shape[:-1], 3, 3))


def from_matrix(matrix: ArrayLike) -> Array:
    """Return the quaternions of rotation matrices (…, 3, 3), with w ≥ 0.

    The largest of the four components is computed first, so there is no division by a small number
    (Shepperd, "Quaternion from rotation matrix", 1978).

    >>> np.allclose(from_matrix(to_matrix(about("x", 3.0))), about("x", 3.0))
    True
    """
    m = np.asarray(matrix, float)
    diagonal = np.einsum("...ii->...i", m)
    trace = diagonal.sum(-1, keepdims=True)
    skew = np.stack(
        [m[..., 2, 1] - m[..., 1, 2], m[..., 0, 2] - m[..., 2, 0], m[..., 1, 0] - m[..., 0, 1]], -1
    )
    # Row i of `four` is 4 q_i q: any row is the quaternion up to its length.
    four = np.empty((*m.shape[:-2], 4, 4))
    four[..., :3, :3] = m + np.swapaxes(m, -1, -2)
    for i in range(3):
        four[..., i, i] = 1 + 2 * diagonal[..., i] - trace[..., 0]
    four[..., :3, 3] = four[..., 3, :3] = skew
    four[..., 3, 3] = 1 + trace[..., 0]
    best = np.einsum("...ii->...i", four).argmax(-1)
    q = normalize(np.take_along_axis(four, best[..., None, None], -2)[..., 0, :])
    return np.where(q[..., 3:] < 0, -q, q)


def align(q: ArrayLike, reference: ArrayLike) -> Array:
    """Return q or −q, the same rotation, whichever is nearer to `reference`.

    >>> align([0, 0, 0, -1], IDENTITY).tolist()
    [-0.0, -0.0, -0.0, 1.0]
    """
    q = np.asarray(q, float)
    dots = np.vecdot(q, np.asarray(reference, float))[..., None]
    return np.where(dots < 0, -q, q)


def nlerp(a: ArrayLike, b: ArrayLike, u: ArrayLike) -> Array:
    """Return the normalised linear interpolation, the shorter way, from a at u = 0 to b at u = 1.

    >>> np.allclose(nlerp(IDENTITY, about("y", 0.4), 0.5), about("y", 0.2))
    True
    """
    a, b, u = np.asarray(a, float), np.asarray(b, float), np.asarray(u, float)
    # −b is the same rotation as b, and may be nearer to a.
    signed = u * np.copysign(1.0, np.vecdot(a, b))
    return normalize(a * (1.0 - u)[..., None] + b * signed[..., None])


def slerp(a: ArrayLike, b: ArrayLike, u: ArrayLike) -> Array:
    """Return the spherical linear interpolation, the shorter way, from a at u = 0 to b at u = 1.

    >>> np.allclose(slerp(IDENTITY, about("y", 2.0), 0.3), about("y", 0.6))
    True
    """
    a = np.asarray(a, float)
    b = align(b, a)
    u = np.asarray(u, float)[..., None]
    cosine = np.clip((a * b).sum(-1, keepdims=True), -1.0, 1.0)
    angle = np.arccos(cosine)
    sine = np.sin(angle)
    # Nearly the same rotation: the formula divides by the sine, and linear is as exact.
    near = sine < 1e-6
    sine = np.where(near, 1.0, sine)
    mix_a = np.where(near, 1 - u, np.sin((1 - u) * angle) / sine)
    mix_b = np.where(near, u, np.sin(u * angle) / sine)
    return normalize(a * mix_a + b * mix_b)


def continuous(q: ArrayLike) -> Array:
    """Return a track (frames, …, 4) with signs chosen so that it does not jump between q and −q.

    >>> continuous([[0, 0, 0, 1], [0, 0, 0, -1]])[:, 3].tolist()
    [1.0, 1.0]
    """
    q = np.asarray(q, float)
    if len(q) < 2:
        return q.copy()
    flips = np.sign((q[1:] * q[:-1]).sum(-1, keepdims=True))
    # A flip stays for all later frames. At right angles either sign is as near; none flips then.
    signs = np.cumprod(np.where(flips == 0, 1.0, flips), axis=0)
    return np.concatenate([q[:1], q[1:] * signs])


def heading(q: ArrayLike) -> Array:
    """Return the yaw [rad] of a rotation: the angle about +y from +z to where its +z points.

    >>> float(heading(about("y", 0.7)).round(6))
    0.7
    """
    x, y, z, w = np.moveaxis(np.asarray(q, float), -1, 0)
    yaw: Array = np.arctan2(2 * (x * z + w * y), w * w - x * x - y * y + z * z)
    return yaw


def wrap(angle: float) -> float:
    """Return the equivalent angle in −π…π.

    >>> math.isclose(wrap(1.5 * math.pi), -0.5 * math.pi)
    True
    """
    return math.remainder(angle, math.tau)


def nearest_quarter_turns(matrix: Array) -> Array:
    """Return the rotation (3, 3) by quarter turns that is most like a matrix (3, 3).

    >>> nearest_quarter_turns(np.array([[0.2, -0.9, 0.1], [0.8, 0.1, 0.3], [0.1, 0.2, 0.9]]))
    array([[ 0., -1.,  0.],
           [ 1.,  0.,  0.],
           [ 0.,  0.,  1.]])
    """
    left, found = matrix.copy(), np.zeros((3, 3))
    for _ in range(3):  # the greatest entry first, then those of the other rows and columns
        row, column = np.unravel_index(np.abs(left).argmax(), left.shape)
        found[row, column] = np.sign(matrix[row, column]) or 1.0
        left[row], left[:, column] = 0.0, 0.0
    found[row, column] *= np.linalg.det(found)  # no mirror
    return found
