"""Vectors (…, 3, batch) and unit quaternions xyzw (…, 4, batch), with the batch as the last axis.

A component of all chains is one run of memory, so an operation on a batch is a few long loops. With
the components last, as in `characters.skeleton.rotations`, it takes two to four times as long.
"""

import numpy as np

from cubeling.characters.skeleton.pose import Array

TINY = 1e-12
"""A length [m] below which a direction is undefined."""


def to_columns(array: Array) -> Array:
    """Return (batch, …) as (…, batch), contiguous."""
    return np.ascontiguousarray(np.moveaxis(array, 0, -1))


def to_rows(array: Array) -> Array:
    """Return (…, batch) as (batch, …), contiguous."""
    return np.ascontiguousarray(np.moveaxis(array, -1, 0))


def identities(count: int) -> Array:
    """Return as many identity rotations, (4, count)."""
    return np.broadcast_to(_IDENTITY, (4, count))


def dot(a: Array, b: Array) -> Array:
    """Return the dot products of vectors, (…, batch)."""
    product: Array = a[..., 0, :] * b[..., 0, :]
    product += a[..., 1, :] * b[..., 1, :]
    product += a[..., 2, :] * b[..., 2, :]
    return product


def length(a: Array) -> Array:
    """Return the lengths of vectors, (…, batch)."""
    size: Array = np.sqrt(dot(a, a))
    return size


def cross(a: Array, b: Array) -> Array:
    """Return the cross products of vectors."""
    ax, ay, az = a[..., 0, :], a[..., 1, :], a[..., 2, :]
    bx, by, bz = b[..., 0, :], b[..., 1, :], b[..., 2, :]
    product = np.empty(np.broadcast_shapes(a.shape, b.shape))
    np.subtract(ay * bz, az * by, out=product[..., 0, :])
    np.subtract(az * bx, ax * bz, out=product[..., 1, :])
    np.subtract(ax * by, ay * bx, out=product[..., 2, :])
    return product


def running_sum(vectors: Array) -> Array:
    """Return the sums of the first 0, 1, 2 … vectors, (joints + 1, 3, batch).

    `np.cumsum` along the first axis takes five times as long.
    """
    sums = np.zeros((len(vectors) + 1, *vectors.shape[1:]))
    for number, vector in enumerate(vectors):
        np.add(sums[number], vector, out=sums[number + 1])
    return sums


def multiply(a: Array, b: Array) -> Array:
    """Return the products a b: the rotation b followed by a."""
    ax, ay, az, aw = a[..., 0, :], a[..., 1, :], a[..., 2, :], a[..., 3, :]
    bx, by, bz, bw = b[..., 0, :], b[..., 1, :], b[..., 2, :], b[..., 3, :]
    x = aw * bx + ax * bw + ay * bz - az * by
    product = np.empty((*x.shape[:-1], 4, x.shape[-1]))
    product[..., 0, :] = x
    product[..., 1, :] = aw * by - ax * bz + ay * bw + az * bx
    product[..., 2, :] = aw * bz + ax * by - ay * bx + az * bw
    product[..., 3, :] = aw * bw - ax * bx - ay * by - az * bz
    return product


def conjugate(q: Array) -> Array:
    """Return the inverse rotations."""
    inverse = -q
    inverse[..., 3, :] = q[..., 3, :]
    return inverse


def rotate(q: Array, vectors: Array) -> Array:
    """Return vectors (…, 3, n) rotated by unit quaternions (…, 4, n)."""
    axis, w = q[..., :3, :], q[..., 3:, :]
    twice = cross(axis, vectors)
    twice += twice
    turned: Array = cross(axis, twice)
    turned += w * twice
    turned += vectors
    return turned


def normalize(q: Array) -> Array:
    """Return q at unit length; zero becomes the identity."""
    squared = dot(q, q) + q[..., 3, :] ** 2
    if squared.size and squared.min() < TINY**2:
        q = np.where((squared < TINY**2)[..., None, :], _IDENTITY, q)
        squared = np.maximum(squared, TINY**2)
        squared = np.where(squared <= TINY**2, 1.0, squared)
    unit: Array = q / np.sqrt(squared)[..., None, :]
    return unit


def between(start: Array, end: Array) -> Array:
    """Return the shortest rotations of directions `start` to `end`, at any lengths.

    The identity where one of both is zero; half a turn about any axis where they are opposite.
    """
    sizes = np.sqrt(dot(start, start) * dot(end, end))
    axis = cross(start, end)
    q = np.empty((*axis.shape[:-2], 4, axis.shape[-1]))
    q[..., :3, :], q[..., 3, :] = axis, sizes + dot(start, end)
    opposite = (q[..., 3, :] < 1e-9 * sizes) & (sizes > TINY**2)
    if opposite.any():
        least = np.abs(start).argmin(-2)[..., None, :] == np.arange(3)[:, None]
        across = cross(start, least.astype(float))
        q[..., :3, :] = np.where(opposite[..., None, :], across, q[..., :3, :])
        q[..., 3, :] = np.where(opposite, 0.0, q[..., 3, :])
    return normalize(q)


def from_euler(angles: Array) -> Array:
    """Return Rz(ψ) Ry(θ) Rx(φ) of angles (φ, θ, ψ), (…, 3, batch) [rad] (S13, 13.0.11)."""
    sines, cosines = np.sin(angles / 2), np.cos(angles / 2)
    sf, st, sp = sines[..., 0, :], sines[..., 1, :], sines[..., 2, :]
    cf, ct, cp = cosines[..., 0, :], cosines[..., 1, :], cosines[..., 2, :]
    q = np.empty((*angles.shape[:-2], 4, angles.shape[-1]))
    q[..., 0, :] = sf * ct * cp - cf * st * sp
    q[..., 1, :] = cf * st * cp + sf * ct * sp
    q[..., 2, :] = cf * ct * sp - sf * st * cp
    q[..., 3, :] = cf * ct * cp + sf * st * sp
    return q


def to_euler(q: Array) -> Array:
    """Return the angles (φ, θ, ψ) of Rz(ψ) Ry(θ) Rx(φ), (…, 3, batch) [rad] (S13, 13.0.12)."""
    x, y, z, w = q[..., 0, :], q[..., 1, :], q[..., 2, :], q[..., 3, :]
    angles = np.empty((*q.shape[:-2], 3, q.shape[-1]))
    angles[..., 0, :] = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    angles[..., 1, :] = np.arcsin(np.clip(2 * (w * y - z * x), -1.0, 1.0))
    angles[..., 2, :] = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return angles


def share(q: Array, u: Array) -> Array:
    """Return the shares u (…, batch) of rotations: slerp from the identity, the shorter way."""
    axis = np.where(q[..., 3:, :] < 0, -q[..., :3, :], q[..., :3, :])
    sine = length(axis)
    half = np.arctan2(sine, np.abs(q[..., 3, :])) * u
    part = np.empty_like(q)
    part[..., :3, :] = axis * (np.sin(half) / np.maximum(sine, TINY))[..., None, :]
    part[..., 3, :] = np.cos(half)
    return normalize(part)


_IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])[:, None]
