# SPDX-License-Identifier: BSD-3-Clause
"""The lobe explorer in a browser: every control moved, the numbers on the page compared with C's."""

import base64
import json
import re
import time
import zlib
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image
from scipy import stats
from shaders.agreement import ROOT, Reference
from shaders.backends import INPUTS, SHADERS, chromium
from shaders.models import strands

from hairlut import exr, size, view
from hairlut.cli import main
from hairlut.lobes import MODELS
from hairlut.measure import measure
from hairlut.mixture import Mixture
from hairlut.model import BakedLobe, BakedModel, assemble
from hairlut.stream import stream
from report.places import PAGES

LUTS = ROOT / "luts"
SIZES = (16, 32)
READ = """
const at = id => document.getElementById(id);
const text = id => at(id).textContent.replaceAll("\u2212", "-");
return {
    trouble: at("trouble").textContent,
    one: ["theta_i", "phi_i", "pdf_angle", "pdf_solid_angle"].map(id => Number(text(id))),
    more: window.explorer.one(),
    degrees: ["theta_i", "phi_i"].map(id => parseFloat(text(id + "_degrees"))),
    sliders: ["theta_r", "phi_r", "offset", "u_theta", "u_phi", "u_lobe"].map(
        id => parseFloat(text(id + "_text"))),
    variance: [...document.querySelectorAll("[id^=variance_]")].map(e => Number(e.textContent)),
    parameters: [...document.querySelectorAll("#parameter_sliders output")].map(e => Number(
        e.textContent.replaceAll("\u2212", "-"))),
    rows: [...document.querySelectorAll("[id^=row_]")].map(e => parseFloat(e.textContent.slice(4))),
    shares: [...document.querySelectorAll("#share_table td[id^=share_]")].map(e => Number(e.textContent)),
    turns: [...document.querySelectorAll("[id^=turn_]")].map(
        e => parseFloat(e.textContent.replaceAll("\u2212", "-"))),
    fits: ["theta_fit", "phi_fit"].map(id => ({value: +at(id).dataset.value, degrees: +at(id).dataset.degrees,
        p: +at(id).dataset.p, text: text(id)})),
    drawn: window.explorer.counted.n,
};
"""
SET = """
for (const [id, value] of Object.entries(arguments[0])) {
    const input = document.getElementById(id);
    input.value = value;
    input.dispatchEvent(new Event("input"));
}
"""


class Page:
    """The explorer in a browser."""

    def __init__(self, driver):
        self.driver = driver

    def read(self) -> dict:
        return self.driver.execute_script(READ)

    def settle(self, act) -> dict:
        """The page's numbers after act and the redrawing that follows it."""
        act()
        self.wait("return window.explorer.idle()")
        return self.read()

    def wait(self, script: str) -> None:
        end = time.monotonic() + 60
        while not self.driver.execute_script(script):
            assert time.monotonic() < end, f"waited 60 s for: {script}"
            time.sleep(0.05)

    def slide(self, **values: float) -> dict:
        return self.settle(lambda: self.driver.execute_script(SET, values))

    def choose(self, name: str, value: str) -> dict:
        return self.settle(self.driver.find_element("css selector", f"#{name} input[value='{value}']").click)

    def again(self) -> dict:
        return self.settle(self.driver.find_element("id", "again").click)


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    path = tmp_path_factory.mktemp("view") / "explorer.html"
    exr.write_model(path.parent / "many", many_lobes())
    exr.write_model(path.parent / "strands", strands())
    models = [LUTS / name for name in ("fitted", "printed", "brown")]
    return view.write_explorer([*models, path.parent / "many", path.parent / "strands"], path, SIZES)


def many_lobes() -> BakedModel:
    """Six lobes on the tables of `brown`, one of them with a uniform azimuth, over signed offsets."""
    brown = exr.read_model(LUTS / "brown")
    tables = {table.name: replace(table, model="many") for table in brown.tables}
    names = tuple(f"part{k}" for k in range(6))
    lobes = [
        BakedLobe(name, tables[lobe.theta.name], tables[lobe.phi.name] if k != 4 else None)
        for k, (name, lobe) in enumerate(zip(names, (brown.lobes * 2)[:6], strict=True))
    ]
    random, shape = np.random.default_rng(5), (6, 3, 5)
    nodes = np.array([-1.0, 0.2, 1.1]), np.linspace(-1, 1, 5)
    return BakedModel(
        "many", tuple(lobes), Mixture(names, *nodes, random.random(shape), random.uniform(-4, 4, shape))
    )


@pytest.fixture(scope="module")
def page(file):
    with chromium(520, 900) as driver:
        driver.get(file.as_uri())
        page = Page(driver)
        page.again()
        assert page.read()["trouble"] == ""
        yield page


def model_of(name: str, chosen: str):
    if name == "many":
        return many_lobes()
    if chosen == "shipped":
        return exr.read_model(LUTS / name)
    tables = {
        lobe.name: size.table_of_size(lobe, int(chosen), int(chosen)).table for lobe in MODELS[name].lobes
    }
    return assemble(MODELS[name], tables)


SLIDERS = ("theta_r", "phi_r", "offset", "u_theta", "u_phi", "u_lobe")
STATES = [  # model, size, lobe; theta_r, phi_r in degrees; offset, u_theta, u_phi, u_lobe
    ("fitted", "shipped", "direct", 20.0, 0.0, 0.0, 0.5, 0.5, 0.25),
    ("printed", "16", "hair", -61.5, 133.0, 0.35, 0.013, 0.871, 0.9),
    ("fitted", "32", "multiple", 90.0, -180.0, 0.0, 0.999, 1.0, 0.0),
    ("printed", "shipped", "hair", -90.0, 180.0, 1.0, 0.0, 0.25, 0.5),
    ("brown", "shipped", "hair", 33.0, -20.0, -0.63, 0.31, 0.42, 0.05),
    ("brown", "shipped", "lobe2", -12.5, 77.0, 0.4, 0.8, 0.15, 0.5),
    ("many", "shipped", "hair", 5.0, 101.0, 0.77, 0.25, 0.66, 0.93),
]


@pytest.mark.parametrize("state", STATES, ids=lambda s: "-".join(map(str, s[:3])))
def test_numbers_on_the_page_are_those_of_c(page, state):
    name, chosen, lobe, *numbers = state
    for control, value in (("model", name), ("size", chosen), ("lobe", lobe)):
        page.choose(control, value)
    shown = page.slide(**dict(zip(SLIDERS, numbers, strict=True)))
    assert shown["sliders"] == pytest.approx(numbers, abs=1e-9)
    theta_r, phi_r, offset, u_theta, u_phi, u_lobe = numbers
    model = model_of(name, chosen)
    names = list(model.mixture.lobes)
    part = 0 if lobe == "hair" else names.index(lobe)
    record = np.zeros(INPUTS)
    record[:8] = [*np.radians([theta_r, phi_r]), offset, part, 0.5, u_lobe, u_theta, u_phi]
    at = 4 if lobe == "hair" else 0
    want = Reference(model)(np.float32([record]))[0, at : at + 4]
    assert shown["one"][0] == pytest.approx(want[0], abs=2e-6)
    assert np.cos(shown["one"][1] - want[1]) == pytest.approx(1, abs=1e-10)
    assert shown["one"][2:] == pytest.approx(want[2:].tolist(), rel=1e-4)
    assert shown["degrees"] == pytest.approx(np.degrees(shown["one"][:2]), abs=1e-3)
    if lobe != "hair":
        assert shown["more"]["inverted"][0] == pytest.approx(u_theta, abs=1e-5)
    share, turn, side = model.mixture.at(np.radians(theta_r), offset)
    assert shown["shares"] == pytest.approx(share.tolist(), abs=1e-4)
    for reported, angle, baked in zip(shown["turns"], side * turn, model.lobes, strict=True):
        if baked.phi:
            assert np.cos(np.radians(reported) - angle) == pytest.approx(1, abs=1e-6)


AT = {"beta_m": 0.41, "beta_n": 0.15, "absorption": 9.5, "tilt": -0.07, "unused": 1e20, "weight": -1.3}


@pytest.mark.parametrize("lobe", ["hair", "tt"])
@pytest.mark.parametrize("at", [AT, {}], ids=["moved", "standard"])
def test_a_slider_moves_each_parameter(page, lobe, at):
    page.choose("model", "fitted")  # and back: the sliders are made anew
    page.choose("model", "strands")
    page.choose("lobe", lobe)
    model = strands()
    values = {each.name: at.get(each.name, each.standard) for each in model.parameters}
    shown = page.slide(theta_r=20, phi_r=40, offset=-0.3, u_theta=0.2, u_phi=0.7, u_lobe=0.4)
    shown = page.slide(**{f"parameter_{k}": value for k, value in enumerate(values.values())})
    assert shown["parameters"] == pytest.approx(list(values.values()), rel=1e-3)
    record = np.zeros(INPUTS)
    record[:8] = [*np.radians([20, 40]), -0.3, 1, 0.5, 0.4, 0.2, 0.7]
    at = 4 if lobe == "hair" else 0
    want = Reference(model.at(values))(np.float32([record]))[0, at : at + 4]
    assert shown["one"][0] == pytest.approx(want[0], abs=2e-6)
    assert np.cos(shown["one"][1] - want[1]) == pytest.approx(1, abs=1e-10)
    assert shown["one"][2:] == pytest.approx(want[2:].tolist(), rel=1e-4)
    share, _, _ = model.mixture.parameters_at(values).at(np.radians(20), -0.3)
    assert shown["shares"] == pytest.approx(share.tolist(), abs=1e-4)


def test_a_model_without_parameters_shows_no_sliders_for_them(page):
    page.choose("model", "brown")
    assert page.read()["parameters"] == []
    assert not page.driver.find_element("id", "parameters").is_displayed()


@pytest.mark.parametrize("state", STATES[:4], ids=lambda s: "-".join(map(str, s[:3])))
def test_error_on_the_page_is_the_measured_one(page, state):
    model, name, _, theta_r, *_ = state
    page.choose("model", model)
    page.choose("size", name)
    shown = page.slide(theta_r=theta_r)
    for k, (table, lobe) in enumerate(zip(model_of(model, name).tables, MODELS[model].lobes, strict=True)):
        errors = measure(table, lobe, quantiles=False)
        row = (np.radians(theta_r) / np.pi + 0.5) * (table.height - 1)
        assert shown["rows"][k] == pytest.approx(row, abs=0.006)
        nearest = np.abs(errors.theta_r - np.radians(theta_r)).argmin()
        around = errors.variance[max(nearest - 1, 0) : nearest + 2]
        assert around.min() * 0.99 <= shown["variance"][k] <= around.max() * 1.01


FITS = [("fitted", "direct", 0), ("fitted", "multiple", 0), ("fitted", "hair", 0)]
FITS += [("brown", "hair", 0.6), ("brown", "hair", -0.6), ("many", "hair", -0.3), ("strands", "hair", 0.3)]


@pytest.mark.parametrize(("model", "lobe", "offset"), FITS)
def test_histogram_fits_the_density(page, model, lobe, offset):
    """Significance 1e-6 for 100,000 samples."""
    page.choose("model", model)
    page.choose("lobe", lobe)
    page.choose("samples", "100000")
    shown = page.slide(theta_r=35.0, offset=offset, phi_r=20)
    assert shown["drawn"] == 100_000
    for fit in shown["fits"]:
        assert fit["degrees"] > 15
        assert fit["p"] > 1e-6, fit
        assert fit["p"] == pytest.approx(stats.chi2.sf(fit["value"], fit["degrees"]), abs=1e-9)
        assert f"{fit['value']:.1f} on {fit['degrees']} degrees" in fit["text"]
    page.choose("samples", "10000")


@pytest.mark.parametrize(
    ("model", "change", "axis"), [("fitted", "theta_r += 2", 0), ("brown", "offset *= -1", 1)]
)
def test_histogram_does_not_fit_a_wrong_density(page, model, change, axis):
    """That of a viewer 2 degrees off, and of the mirrored hair."""
    page.choose("model", model)
    page.choose("lobe", "hair")
    page.choose("samples", "100000")
    page.slide(theta_r=35.0, offset=0.6, phi_r=20)
    repaint = f"window.explorer.state.{change}; document.body.style.width = '97%'"  # draws nothing new
    page.driver.execute_script(repaint)
    time.sleep(0.5)
    wrong = page.settle(lambda: None)
    assert wrong["drawn"] == 100_000
    assert wrong["fits"][axis]["p"] < 1e-6
    page.driver.execute_script("document.body.style.width = ''")
    page.choose("samples", "10000")


def test_keep_drawing_adds_samples_and_draw_again_starts_over(page):
    page.choose("samples", "1000")
    click = "document.getElementById('keep').click()"  # a real click would wait for the drawing to pause
    page.driver.execute_script(click)
    page.wait("return window.explorer.counted.n >= 3000")
    assert page.settle(lambda: page.driver.execute_script(click))["drawn"] % 1000 == 0
    assert page.again()["drawn"] == 1000
    page.choose("samples", "10000")


def test_keyboard_alone_reaches_and_moves_the_controls(page):
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.keys import Keys

    driver = page.driver
    page.choose("model", "fitted")
    page.choose("lobe", "hair")
    driver.execute_script(
        "document.activeElement.blur(); window.getSelection().removeAllRanges(); scrollTo(0, 0)"
    )
    reached = []
    for _ in range(20):
        ActionChains(driver).send_keys(Keys.TAB).perform()
        reached.append(driver.execute_script("const e = document.activeElement; return e.name || e.id"))
    assert {"lobe", "size", "samples", "again", "keep", "sphere", *SLIDERS} <= set(reached)
    slider = driver.find_element("id", "theta_r")
    page.slide(theta_r=10)
    assert page.settle(lambda: slider.send_keys(Keys.ARROW_RIGHT))["sliders"][0] == 10.5
    radio = driver.find_element("css selector", "#model input[value='fitted']")
    page.settle(lambda: radio.send_keys(Keys.ARROW_RIGHT))
    assert driver.execute_script("return window.explorer.state.model") == "printed"
    before = driver.execute_script("return window.explorer.state.yaw")
    page.settle(lambda: driver.find_element("id", "sphere").send_keys(Keys.ARROW_LEFT))
    assert driver.execute_script("return window.explorer.state.yaw") != before


@pytest.mark.parametrize("width", [360, 900, 1440])
def test_page_fits_narrow_and_wide_screens(page, width, tmp_path):
    """No sideways scrolling; on the screenshot the sphere and every chart show more than one colour."""
    driver = page.driver
    page.choose("model", "brown")
    metrics = {"width": width, "height": 1000, "deviceScaleFactor": 1, "mobile": False}
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
    try:
        page.again()
        assert driver.execute_script("return document.documentElement.scrollWidth <= window.innerWidth")
        for name in ("sphere", "ramp", "theta_chart", "phi_chart", "texture_0", "share_chart"):
            picture = tmp_path / f"{name}.png"
            driver.find_element("id", name).screenshot(str(picture))
            colours = Image.open(picture).convert("RGB").getcolors(1 << 24)
            assert len(colours) > 12, name
    finally:
        driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def test_page_needs_no_network(page, file):
    text = file.read_text()
    assert re.findall(r"""(?:src|href)\s*=|url\(|@import|fetch\(|XMLHttpRequest|https?://""", text) == []
    assert page.driver.execute_script("return performance.getEntriesByType('resource').length") == 0


def data_of(text: str) -> dict:
    return json.loads(re.search(r'id="data">(.*?)</script>', text)[1])


def test_page_contains_the_shipped_shader_and_tables(file):
    text = file.read_text()
    assert (SHADERS / "hairlut.glsl").read_text() in text
    data = data_of(text)
    assert set(data["models"]) == {"fitted", "printed", "brown", "many", "strands"}
    assert set(data["models"]["brown"]["sizes"]) == {"shipped"}
    assert set(data["models"]["fitted"]["sizes"]) == {"shipped", *map(str, SIZES)}


def test_shipped_page_is_made_of_what_is_shipped():
    """The page of the report is generated: run `make report` when shader, viewer or table change."""
    text = (PAGES / "explorer.html").read_text()
    assert (SHADERS / "hairlut.glsl").read_text() in text
    assert (view.VIEWER / "explorer.js").read_text() in text
    assert (view.VIEWER / "style.css").read_text() in text
    models = data_of(text)["models"]
    assert list(models) == ["brown", "fitted", "printed"]
    for name, model in models.items():
        want = stream(exr.read_model(LUTS / name)).tobytes()
        assert zlib.decompress(base64.b64decode(model["sizes"]["shipped"]["stream"])) == want


def test_command_writes_the_page_and_names_what_is_missing(tmp_path, capsys):
    assert main(["view", str(tmp_path / "absent")]) == 2
    assert "expected a directory with mixture.exr" in capsys.readouterr().err
    out = tmp_path / "page.html"
    assert main(["view", str(LUTS / "fitted"), "--out", str(out)]) == 0
    assert str(out) in capsys.readouterr().out
    assert set(data_of(out.read_text())["models"]) == {"fitted"}


def test_a_model_without_formulas_is_shown_as_it_is(tmp_path):
    """Only its own tables, and no error: the exact lobe is not in the file."""
    exr.write_model(tmp_path / "many", many_lobes())
    model = data_of(view.page([tmp_path / "many"]))["models"]["many"]
    assert set(model["sizes"]) == {"shipped"}
    assert all(table["variance"] is None for table in model["sizes"]["shipped"]["tables"])
