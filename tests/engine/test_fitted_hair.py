"""Tables fitted to the engine's own hair: unbiased, and a family of them nearly as good as its sampler."""

import math

import numpy as np
import pytest
from engine.chisquare import cell_masses, direction, interaction, p_value, sample_angles

DRAWS = 20_000
VIEWER = math.radians(30)
ALPHA = 0.01  # of all comparisons with the quadrature below together
KINDS = ("uniform", "built-in tables", "one fitted model", "family over offsets")
LIGHTS = {"constant": 0, "contrasted": 1}
COUNT = 400_000  # draws of a chi-square test
PLACES = [(0, 0), (30, -45), (-30, 45), (60, 10), (-85, 80), (40, 170)]  # theta_r, phi_r in degrees


@pytest.fixture(scope="module")
def rough(mi, tmp_path_factory):
    """The BSDF dictionaries by what proposes directions, for a rough hair on a coarse grid."""
    from hairlut.fit.distribution import of_grid
    from hairlut.fit.model import fit
    from hairlut.fit.offsets import of_grids
    from report import fitted_hair
    from report.hairscene.nearfield import evaluate, midpoints

    nested = {"type": "hair", **fitted_hair.HAIRS["rough"]}
    theta_r = np.radians(np.arange(-80.0, 81, 20))
    theta_i, phi = midpoints(-math.pi / 2, math.pi / 2, 36), midpoints(0, 2 * math.pi, 36)
    gamma = np.linspace(0, math.pi / 2, 7)
    values = evaluate(mi, mi.load_dict(nested), theta_r, theta_i, phi, gamma)
    found = fit(of_grid(theta_r, theta_i, phi, fitted_hair.far_field(values, gamma), per_steradian=True))
    folder = tmp_path_factory.mktemp("fitted")
    tables = fitted_hair.bake(found, "rough", folder)
    data = of_grids(np.sin(gamma), theta_r, theta_i, phi, values, per_steradian=True)
    family, _ = fitted_hair.bake_family(data, "rough", folder)
    return fitted_hair.samplers(nested, tables, found.split.direct_weight, family)


@pytest.fixture(scope="module")
def drawn(mi, rough):
    """Draws by sampler."""
    from report import fitted_hair

    return {
        kind: fitted_hair.draw(mi, mi.load_dict(bsdf), VIEWER, DRAWS, [seed])
        for seed, (kind, bsdf) in enumerate(rough.items())
    }


@pytest.fixture(scope="module")
def exact(mi, rough):
    """(2,) the light by quadrature, and its error."""
    from report.hairscene.nearfield import light

    return light(mi, mi.load_dict(rough["its own"]), VIEWER)


def deviation(drawn, exact, light):
    """Standard errors by which the mean is off."""
    values, (means, errors) = drawn.estimates()[light], exact
    return (values.mean() - means[light]) / np.hypot(values.std() / np.sqrt(DRAWS), errors[light])


def limit(comparisons):
    from scipy.stats import norm

    return norm.isf((1 - (1 - ALPHA) ** (1 / comparisons)) / 2)


def variance(drawn):
    return drawn.weight.var() / drawn.weight.mean() ** 2


COMPARISONS = len(KINDS) * len(LIGHTS) + 2 * len(LIGHTS)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("light", LIGHTS)
def test_what_draws_from_tables_estimates_the_light_of_the_quadrature(drawn, exact, kind, light):
    assert abs(deviation(drawn[kind], exact, LIGHTS[light])) < limit(COMPARISONS)


@pytest.mark.parametrize("kind", ["half tables, half its own", "its own"])
@pytest.mark.parametrize("light", LIGHTS)
def test_the_engines_own_draws_do_with_the_density_that_they_have(mi, drawn, exact, kind, light):
    from report import fitted_hair

    hair = fitted_hair.HAIRS["rough"]
    corrected = fitted_hair.corrected(mi, drawn[kind], hair, VIEWER, fitted_hair.OWN[kind])
    assert abs(deviation(corrected, exact, LIGHTS[light])) < limit(COMPARISONS)


def test_the_engines_own_draws_have_an_atom(drawn):
    from report.hairscene.owndensity import is_atom

    assert is_atom(drawn["its own"].wo).mean() > 1e-3
    assert not is_atom(drawn["family over offsets"].wo).any()


def test_the_density_of_the_engines_draws_integrates_to_what_is_not_the_atom(mi, drawn, rough):
    from report import fitted_hair
    from report.hairscene.owndensity import density, is_atom

    theta, phi = np.meshgrid(
        (np.arange(400) + 0.5) / 400 * np.pi - np.pi / 2, np.arange(200) / 200 * 2 * np.pi, indexing="ij"
    )
    wo = np.stack([np.cos(theta) * np.sin(phi), np.sin(theta), np.cos(theta) * np.cos(phi)], -1).reshape(
        -1, 3
    )
    masses = []
    for gamma in np.arcsin(np.linspace(-0.95, 0.95, 20)):
        of = density(fitted_hair.HAIRS["rough"], VIEWER, np.full(len(wo), gamma), wo)
        masses.append((of * np.cos(theta).ravel()).sum() * (np.pi / 400) * (2 * np.pi / 200))
    atom = is_atom(drawn["its own"].wo).mean()
    assert np.mean(masses) == pytest.approx(1 - atom, abs=5 * np.sqrt(atom / DRAWS) + 2e-4)


def test_a_density_three_percent_off_would_be_seen(drawn, exact):
    family = drawn["family over offsets"]
    wrong = type(family)(1.03 * family.weight, family.density, family.gamma, family.wo, 0.0)
    assert abs(deviation(wrong, exact, 0)) > limit(COMPARISONS)


def test_a_family_samples_nearly_as_well_as_the_bsdfs_own_sampler(drawn):
    family = variance(drawn["family over offsets"])
    assert family < 0.25 * variance(drawn["one fitted model"])
    assert 1 + family < 1.02 * (1 + variance(drawn["its own"]))


def test_a_family_has_no_large_weights(mi, rough):
    from report.hairscene.nearfield import largest_weight

    kinds = ("family over offsets", "one fitted model", "its own")
    family, one, own = (largest_weight(mi, mi.load_dict(rough[kind]), VIEWER) for kind in kinds)
    assert 1 < own < 1.5
    assert family < 4 < one


def test_one_model_comes_between_the_built_in_ones_and_the_bsdfs_own_sampler(drawn):
    fitted = variance(drawn["one fitted model"])
    assert variance(drawn["its own"]) < fitted
    assert fitted < 0.5 * variance(drawn["built-in tables"])
    assert fitted < 0.2 * variance(drawn["uniform"])
    assert variance(drawn["half tables, half its own"]) < 0.5 * fitted


# ---- the family in the plugin


@pytest.fixture(scope="module")
def family(mi, rough):
    return mi.load_dict(rough["family over offsets"])


@pytest.mark.parametrize("place", PLACES, ids=str)
def test_chi_square_accepts_the_family(mi, family, place):
    """On both sides of the fibre, between the offsets, beyond the last theta_r, and from behind."""
    si, context = interaction(mi, *map(math.radians, place)), mi.BSDFContext()
    masses = cell_masses(mi, lambda wo: family.pdf(context, si, wo), 10, 20)
    assert masses.sum() == pytest.approx(1.0, abs=2e-3)
    angles = sample_angles(mi, family, si, COUNT, seed=23)
    assert p_value(mi, angles, masses, COUNT) > ALPHA / len(PLACES)
    assert p_value(mi, angles, np.roll(masses, 1, axis=1), COUNT) < ALPHA / len(PLACES)


def test_the_density_of_a_draw_is_the_density_asked_for(mi, family):
    """To the rounding of a drawn direction, as in runtime/test_components.py."""
    context, off = mi.BSDFContext(), []
    for place in PLACES:
        si = interaction(mi, *map(math.radians, place))
        for u, v, w in np.random.default_rng(3).random((200, 3)).tolist():
            sample, weight = family.sample(context, si, u, mi.Point2f(v, w))
            value, density = family.eval_pdf(context, si, sample.wo)
            assert density == family.pdf(context, si, sample.wo)
            assert np.array(weight) == pytest.approx(np.array(value) / sample.pdf, rel=1e-6)
            off.append(abs(sample.pdf / density - 1))
    assert np.quantile(off, 0.99) < 1e-4
    assert np.median(off) < 1e-6


def test_the_other_half_of_the_fibre_is_the_mirror_image(mi, family):
    context = mi.BSDFContext()
    for theta, phi in [(-0.5, 2.4), (0.1, 0.3), (1.2, -2.0)]:
        here = family.pdf(context, interaction(mi, 0.4, 0.7), direction(mi, theta, phi))
        there = family.pdf(context, interaction(mi, 0.4, -0.7), direction(mi, theta, -phi))
        assert here == pytest.approx(there, rel=1e-5)


def spoilt(rough, folder, change):
    """The family's text with a change, and the rest of it in place."""
    from pathlib import Path

    source = Path(rough["family over offsets"]["family"])
    for model in source.iterdir():
        if model.is_dir():
            (folder / model.name).symlink_to(model)
    (folder / "family.txt").write_text(change((source / "family.txt").read_text()))
    return {**rough["family over offsets"], "family": str(folder)}


def without(key):
    return lambda text: "\n".join(line for line in text.splitlines() if not line.startswith(key))


class Written:
    """The density that a family's files describe (hairlut.familyfiles), read without the plugin."""

    def __init__(self, folder):
        from hairlut import exr

        lines = [line.split() for line in (folder / "family.txt").read_text().splitlines()]
        numbers = {key: [line[1:] for line in lines if line[0] == key] for key in ("offset", "lobe", "turn")}
        self.theta_r = np.array(lines[2][1:], float)
        self.angle = np.arcsin(np.array(numbers["offset"], float)[:, 0])
        shape = (len(self.angle), -1, len(self.theta_r))
        self.names = np.reshape([words[0] for words in numbers["lobe"]], shape[:2])
        self.weight = np.array([words[1:] for words in numbers["lobe"]], float).reshape(shape)
        self.turn = np.array(numbers["turn"], float).reshape(shape)
        self.tables = {
            name: [exr.read(folder / name / f"direct_{angle}.exr")[0] for angle in ("theta", "phi")]
            for name in set(self.names.ravel())
        }

    def pdf(self, theta_r, gamma, theta_i, phi):
        """Per steradian, for a viewer in front of the fibre; phi is measured from the viewer's azimuth."""
        from hairlut import interpolant

        phi, gamma = (phi, gamma) if gamma >= 0 else (-phi, -gamma)
        o = int(abs(self.angle - gamma).argmin())
        sum_ = 0.0
        for k, name in enumerate(self.names[o]):
            weight, turn = (
                np.interp(gamma, self.angle, [np.interp(theta_r, self.theta_r, row) for row in part[:, k]])
                for part in (self.weight, self.turn)
            )
            inclination, azimuth = self.tables[name]
            at = (phi - turn) % (2 * np.pi)
            sum_ += weight * (
                interpolant.pdf(inclination, theta_r, theta_i) * interpolant.pdf(azimuth, theta_r, at)
            )
        return float(sum_[0]) / math.cos(theta_i)


def several_shapes(text):
    """The family's text with other models from half of the offsets on."""
    lines = text.splitlines()
    for k in range(len(lines) // 2, len(lines)):
        lines[k] = (
            lines[k].replace("lobe_0", "lobe_x").replace("lobe_1", "lobe_0").replace("lobe_x", "lobe_1")
        )
    return "\n".join(lines)


@pytest.mark.parametrize("change", [str, several_shapes], ids=["one-shape", "several-shapes"])
def test_the_plugin_draws_what_the_files_say(mi, rough, tmp_path, change):
    """On and between the offsets, on both sides of the fibre and beyond the last theta_r."""
    spoilt(rough, tmp_path, change)
    family = mi.load_dict({**rough["family over offsets"], "family": str(tmp_path)})
    context, written = mi.BSDFContext(), Written(tmp_path)
    random = np.random.default_rng(5)
    places = [(0.3, 0.0), (0.3, 0.7), (-0.2, -1.1), (1.5, 1.5), (-1.0, 0.13), (0.9, -1.57)]
    for theta_r, gamma in [*places, *random.uniform(-1.5, 1.5, (20, 2)).tolist()]:
        for theta_i, phi in random.uniform((-1.5, 0), (1.5, 2 * math.pi), (20, 2)).tolist():
            found = family.pdf(context, interaction(mi, theta_r, gamma), direction(mi, theta_i, phi + gamma))
            assert found == pytest.approx(written.pdf(theta_r, gamma, theta_i, phi), rel=2e-3)


def test_a_viewer_behind_the_surface_is_one_in_front_of_it_mirrored(mi, family):
    context = mi.BSDFContext()
    for phi_r, front in [(2.5, math.pi - 2.5), (-1.8, 1.8 - math.pi)]:
        here = family.pdf(context, interaction(mi, 0.4, phi_r), direction(mi, 0.2, phi_r + 1.0))
        there = family.pdf(context, interaction(mi, 0.4, front), direction(mi, 0.2, front + 1.0))
        assert here == pytest.approx(there, rel=1e-4)


MISTAKES = {
    "not a family": (lambda text: "hello", "line 1: expected .hairlut-family 2. first"),
    "newer": (lambda text: text.replace("family 2", "family 3"), "line 1: expected version 2"),
    "empty": (lambda text: "", "ends too early"),
    "no theta_r": (without("theta_r"), "line 3: expected a line theta_r before"),
    "no lobes": (without("lobe"), "line 5: expected a line lobe before each line turn"),
    "no turns": (without("turn"), "line 6: expected a line turn after each line lobe"),
    "only offsets": (
        lambda text: without("lobe")(without("turn")(text)),
        "line 5: expected offsets to increase, with a line lobe and a line turn for each",
    ),
    "a lobe less": (
        lambda text: "\n".join(text.splitlines()[:12]),
        "ends too early: expected .* as many pairs of lines .* as the first",
    ),
    "a lobe less at an offset": (
        lambda text: "\n".join(text.splitlines()[:12] + text.splitlines()[17:]),
        "line 13: expected offsets to increase, with a line lobe and a line turn",
    ),
    "too many lobes": (
        lambda text: "\n".join(text.splitlines()[:4] + 9 * text.splitlines()[4:6]),
        "line 21: expected at most 8 lobes",
    ),
    "no offsets": (without("offset"), "line 4: expected a line offset before the first lobe"),
    "few turns": (lambda text: text.rstrip().rpartition(" ")[0], "expected 9 angles in radians"),
    "few weights": (
        lambda text: text.replace("turn", "0.5\nturn", 1).replace("\n0.5", " 0.5", 1),
        "line 5: expected a model's name and 9 weights",
    ),
    "negative": (
        lambda text: text.replace("lobe_0 0.", "lobe_0 -0.", 1),
        r"expected a model's name and 9 weights",
    ),
    "words": (
        lambda text: text.replace("lobe_0 0.", "lobe_0 zero.", 1),
        r"expected a model's name and 9 weights",
    ),
    "unknown key": (lambda text: text + "colour brown\n", "found .colour."),
    "no weight": (
        lambda text: "\n".join(
            line if not line.startswith("lobe") else " ".join([*line.split()[:2], *["0"] * 9])
            for line in text.splitlines()
        ),
        "at offset 0.* no lobe has a weight above 0 at theta_r number 1",
    ),
    "missing model": (lambda text: text.replace("shape_0_lobe_1", "none"), "none.*directory of tables"),
    "offset of two": (lambda text: text.replace("offset 1\n", "offset 2\n"), "expected an offset in"),
}


@pytest.mark.parametrize("mistake", MISTAKES, ids=lambda name: name.replace(" ", "-"))
def test_a_mistake_in_a_family_is_named(mi, rough, tmp_path, mistake):
    change, said = MISTAKES[mistake]
    with pytest.raises(RuntimeError, match=said):
        mi.load_dict(spoilt(rough, tmp_path, change))


def test_a_family_that_is_not_there_is_named(mi, rough):
    with pytest.raises(RuntimeError, match=r"none/family\.txt cannot be read"):
        mi.load_dict({**rough["family over offsets"], "family": "none"})


@pytest.mark.parametrize("other", [{"model": "fitted"}, {"direct_weight": 0.3}], ids=str)
def test_a_family_beside_a_model_is_refused(mi, rough, other):
    with pytest.raises(RuntimeError, match="beside family"):
        mi.load_dict({**rough["family over offsets"], **other})
