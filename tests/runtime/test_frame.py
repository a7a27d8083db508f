# SPDX-License-Identifier: BSD-3-Clause
"""World directions and fibre angles: both ways, at the poles, tilted, and turned."""

import ctypes

import numpy as np
import pytest
from runtime.c_library import MODELS, builtin, core

HALF_PI = np.float32(np.pi / 2)
POINTER = ctypes.POINTER(ctypes.c_float)


class Frame(ctypes.Structure):
    _fields_ = [(name, ctypes.c_float * 3) for name in ("tangent", "normal", "binormal")]


def frame(matrix) -> Frame:
    """A frame whose rows are tangent, normal and binormal."""
    return Frame(*((ctypes.c_float * 3)(*map(float, row)) for row in matrix))


def angles(matrix, direction) -> tuple[float, float]:
    theta, phi = ctypes.c_float(), ctypes.c_float()
    w = (ctypes.c_float * 3)(*map(float, direction))
    core().hairlut_angles(ctypes.byref(frame(matrix)), w, ctypes.byref(theta), ctypes.byref(phi))
    return theta.value, phi.value


def direction(matrix, theta, phi) -> np.ndarray:
    out = (ctypes.c_float * 3)()
    function = core().hairlut_direction
    function.argtypes = [
        ctypes.c_void_p,
        ctypes.c_float,
        ctypes.c_float,
        ctypes.c_void_p,
    ]
    function(ctypes.byref(frame(matrix)), theta, phi, out)
    return np.array(out[:], float)


def rotation(random) -> np.ndarray:
    """A random orthonormal, right-handed matrix."""
    q, r = np.linalg.qr(random.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0 else -q


TILTED = np.array(  # tangent leaning by 50 degrees out of the x axis, nothing symmetric about it
    [
        [np.cos(np.radians(50)), np.sin(np.radians(50)), 0],
        [
            -np.sin(np.radians(50)) * np.cos(0.4),
            np.cos(np.radians(50)) * np.cos(0.4),
            np.sin(0.4),
        ],
        [
            np.sin(np.radians(50)) * np.sin(0.4),
            -np.cos(np.radians(50)) * np.sin(0.4),
            np.cos(0.4),
        ],
    ]
)


def test_axes_have_the_angles_of_their_definition():
    tangent, normal, binormal = TILTED
    assert angles(TILTED, normal) == pytest.approx((0, 0), abs=1e-6)
    assert angles(TILTED, binormal) == pytest.approx((0, np.pi / 2), abs=1e-6)
    assert angles(TILTED, -binormal) == pytest.approx((0, -np.pi / 2), abs=1e-6)
    leaning = np.sin(0.3) * tangent + np.cos(0.3) * (np.cos(2) * normal + np.sin(2) * binormal)
    assert angles(TILTED, leaning) == pytest.approx((0.3, 2), abs=1e-6)


def test_there_and_back():
    random = np.random.default_rng(1)
    for _ in range(500):
        matrix = rotation(random)
        theta, phi = (
            random.uniform(-np.pi / 2, np.pi / 2),
            random.uniform(-np.pi, np.pi),
        )
        w = direction(matrix, theta, phi)
        assert np.linalg.norm(w) == pytest.approx(1, abs=1e-6)
        back = angles(matrix, w)
        assert back[0] == pytest.approx(theta, abs=1e-6)
        distance = np.angle(np.exp(1j * (back[1] - phi))) * np.cos(
            theta
        )  # an azimuth counts less near the pole
        assert abs(distance) < 1e-6
        assert -np.pi <= back[1] < np.float32(np.pi)


@pytest.mark.parametrize("sign", [1, -1])
def test_pole(sign):
    exact = np.eye(3)
    assert angles(exact, sign * exact[0]) == (sign * HALF_PI, 0.0)
    assert direction(TILTED, sign * HALF_PI, 2.0) == pytest.approx(sign * TILTED[0], abs=1e-6)
    assert angles(exact, direction(exact, sign * HALF_PI, 2.0))[1] == pytest.approx(2.0, abs=1e-5)
    near = direction(exact, sign * (np.pi / 2 - 1e-5), 1.0)  # asin of the dot product would be off by 3e-4
    assert angles(exact, near) == pytest.approx((sign * (np.pi / 2 - 1e-5), 1.0), abs=2e-7)


@pytest.mark.parametrize("length", [1e-30, 1e-3, 1.0, 7.0, 1e30])
def test_length_of_a_direction_does_not_matter(length):
    w = direction(TILTED, -0.7, 2.5)
    assert angles(TILTED, w * length) == pytest.approx((-0.7, 2.5), abs=1e-6)


@pytest.mark.parametrize("bad", [0.0, np.nan, np.inf, -np.inf])
def test_what_is_no_direction_gives_zeros(bad):
    assert angles(TILTED, [bad, bad, bad]) == (0.0, 0.0)
    assert angles(TILTED, [0.0, bad, 0.0]) == (0.0, 0.0)


@pytest.mark.parametrize("theta", [np.nan, np.inf, -np.inf, 5.0])
@pytest.mark.parametrize("phi", [np.nan, np.inf, 1e30, 1e8])
def test_every_pair_of_angles_gives_a_unit_vector(theta, phi):
    assert np.linalg.norm(direction(TILTED, theta, phi)) == pytest.approx(1, abs=1e-6)


def world_sample(model, lobe, matrix, viewer, u_theta, u_phi) -> np.ndarray:
    theta_r, phi_r = angles(matrix, viewer)
    s = model.sample(lobe, theta_r, phi_r, u_theta, u_phi)[0]
    return direction(matrix, s["theta_i"], s["phi_i"])


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("lobe", ["direct", "multiple"])
def test_turning_fibre_and_viewer_together_turns_the_samples(name, lobe):
    random = np.random.default_rng(2)
    model = builtin(name)
    for _ in range(50):
        turn, u = rotation(random), random.random(2)
        viewer = direction(TILTED, random.uniform(-1.2, 1.2), random.uniform(-3, 3))
        sample = world_sample(model, lobe, TILTED, viewer, *u)
        turned = world_sample(model, lobe, TILTED @ turn.T, turn @ viewer, *u)
        assert turned == pytest.approx(turn @ sample, abs=2e-5)


def test_tilting_the_fibre_is_not_tilting_the_sample():
    """With the viewer fixed, a fibre that tilts by 20 degrees turns its highlight by twice that."""
    model = builtin("fitted")
    viewer = np.array([0.0, 1.0, 0.0])

    def along(degrees):
        a = np.radians(degrees)
        matrix = np.array([[np.cos(a), np.sin(a), 0], [-np.sin(a), np.cos(a), 0], [0, 0, 1]])
        theta_r, phi_r = angles(matrix, viewer)
        assert np.degrees(theta_r) == pytest.approx(degrees, abs=1e-3)
        s = model.sample("direct", theta_r, phi_r, np.float32(0.5), np.float32(0.5))[0]
        return direction(matrix, s["theta_i"], 0.0)  # the plane of fibre and viewer

    turned = np.degrees(np.arctan2(along(20)[0], along(20)[1]) - np.arctan2(along(0)[0], along(0)[1]))
    # theta_i = (3 theta_r - 2) degrees - theta_r: the mirror direction would turn by -40 degrees
    assert turned == pytest.approx(-40 + np.degrees(np.radians(3 * np.radians(20))), abs=0.6)


def test_mirrored_frame_mirrors_the_azimuth():
    """A left-handed frame is another frame: the sign of phi shows it."""
    mirrored = TILTED * np.array([[1], [1], [-1]])
    w = direction(TILTED, 0.4, 1.0)
    assert angles(mirrored, w) == pytest.approx((0.4, -1.0), abs=1e-6)
