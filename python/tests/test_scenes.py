"""Scenes and designs: what they say, and how they are refused."""

import json
import re
import warnings

import afmsweep as afm
import numpy as np
import pytest
import xarray as xr
from conftest import LEVER

# A command, or an option of one.
OF_SHELL = re.compile(r"`afmsweep |(^|\s)--[a-z]| -o\b", re.MULTILINE)


def test_errors_have_a_place_and_a_way_out(tmp_path):
    text = '[sample]\nyoungs_modulus = "2 GPa"\npoisson_ratio = 0.7\n'
    with pytest.raises(afm.SceneError) as refused:
        afm.run(text)
    error = refused.value
    assert isinstance(error, ValueError) and (error.line, error.column) == (3, 17)
    assert "incompressible" in str(error) and "0.45" in error.help and "`sample.poisson_ratio`" in error.title
    with pytest.raises(afm.SceneError) as whole:
        afm.run({"contact": {"law": "jkr"}, "sample": {"viscosity": "1 Pa s"}})
    assert "viscous" in whole.value.title and whole.value.line == 5
    with pytest.raises(FileNotFoundError):
        afm.run(tmp_path / "none.toml")


def test_a_file_may_have_an_equals_sign_in_its_name(tmp_path, scene):
    file = tmp_path / "gap=5nm.toml"
    file.write_text(scene.text, encoding="utf-8")
    assert afm.Scene(str(file)).text == scene.text


def test_no_message_speaks_of_the_command_line(tmp_path, scene):
    for wrong in ({"uncertain": {"instrument.tip.radius": afm.uniform(5e-9, 6e-9)}}, {"design": {"samples": 3}}):
        with pytest.raises(afm.SceneError) as refused:
            afm.run(scene.set(wrong))
        assert not OF_SHELL.search(str(refused.value)), refused.value
    with pytest.raises(FileNotFoundError, match="no such file") as missing:
        afm.open(tmp_path / "none.h5")
    assert not OF_SHELL.search(str(missing.value)), missing.value


@pytest.mark.parametrize(
    "call",
    [
        lambda scene: scene.set({"sample.youngs_modulos": 1e9}),
        lambda scene: afm.run(scene, samples={"sample.youngs_modulos": [1e9]}),
        lambda scene: afm.Design("sobol", samples=4, parameters={"sample.youngs_modulos": afm.uniform(1e9, 2e9)}),
    ],
)
def test_the_nearest_quantity_is_named(scene, call):
    with pytest.raises(KeyError, match="did you mean 'sample.youngs_modulus'"):
        call(scene)


def test_arrays_are_one_row_of_numbers(scene):
    with pytest.raises(ValueError, match="expected one dimension"):
        afm.run(scene, samples={"sample.youngs_modulus": np.ones((4, 2))})
    with pytest.raises(ValueError, match="belongs in the scene"):
        afm.run(scene, samples={"sample.youngs_modulus": 1e9})
    with pytest.raises(TypeError, match="SI units"):
        afm.run(scene, samples={"sample.youngs_modulus": ["1 GPa", "2 GPa"]})
    with pytest.raises(ValueError, match="needs output="):
        afm.run(scene, resume=True)
    curve = scene.force(np.linspace(0.0, 1e-9, 3))["curves"][0]
    assert len(curve["force_n"]) == 3 and curve == scene.force([0.0, 5e-10, 1e-9])["curves"][0]


def test_arrays_are_checked(scene):
    for arrays, why in (
        ({"instrument.tip.radius": [1e-9, -1e-9]}, "row 1 .* impossible"),
        ({"instrument.tip.radius": [1e-9, np.nan]}, "row 1"),
        ({"instrument.tip.radius": [1e-8, 2e-8], "sample.youngs_modulus": [1e9]}, "differ in length"),
        ({"instrument.tip.radius": []}, "no or too many rows"),
    ):
        with pytest.raises(afm.SceneError, match=why):
            afm.run(scene, samples=arrays)
    with pytest.raises(afm.SceneError, match="two ways"):
        afm.run(scene.set({"samples": {"approach.gap": [1e-8]}}), samples={"instrument.tip.radius": [1e-8]})
    for option in ({"backend": "abacus"}, {"precision": "f16"}):
        with pytest.raises(ValueError, match="expected"):
            afm.run(scene, **option)


def test_a_scene_changes_by_paths(scene):
    changed = scene.set(
        {"sample.youngs_modulus": 3e9, "contact.law": "hertz", "approach": {"setpoint": 0.8}, "title": None}
    )
    told = changed.to_dict()
    assert told["sample"]["youngs_modulus"] == "3000000000.0 Pa" and told["contact"] == {"law": "hertz"}
    assert "title" not in told and scene.to_dict()["title"] == "lever"
    assert afm.Scene(changed.text).to_dict() == told
    modes = {"modes": [{"stiffness": 2.0, "frequency": 7e4}, {"stiffness": "80 N/m", "frequency": 4e5}]}
    listed = scene.set({"instrument": {"cantilever": modes, "tip": LEVER["instrument"]["tip"]}})
    listed = listed.set({"instrument.cantilever.modes.0.quality_factor": 40})
    first = listed.modes()["modes"][0]
    assert (first["frequency_hz"], first["quality_factor"]) == (7e4, 40.0)


def test_what_is_told_is_what_the_command_tells(scene, tmp_path, command):
    file = tmp_path / "scene.toml"
    file.write_text(scene.text)

    def told(*words):
        return json.loads(command(*words).stdout)

    assert scene.modes() == told("modes", file, "--json")
    assert scene.force() == told("force", file, "--json")
    assert scene.force(["1 nm", 2e-9]) == told(
        "force", file, "--json", "--indentation", "1 nm", "--indentation", "2 nm"
    )
    assert scene.force(lever=True) == told("force", file, "--json", "--lever")
    ours, theirs = scene.plan(forecast=True), told("plan", file, "--json")
    times = ("estimated_time_s", "expected_time_s")
    assert all(ours.pop(key) > 0 and theirs.pop(key) > 0 for key in times) and ours == theirs


def test_designs_are_the_programs(scene, tmp_path, command):
    study = afm.Design(
        "saltelli",
        samples=64,
        replicates=4,
        parameters={
            "sample.youngs_modulus": afm.lognormal("2 GPa", 0.1),
            "instrument.tip.radius": afm.triangular(8e-9, 9e-9, 11e-9),
            "instrument.cantilever.stiffness": afm.normal("10 N/m", "5 %", low=8),
        },
    )
    results, page = tmp_path / "study.h5", tmp_path / "pages"
    data = afm.run(scene.with_design(study), output=results, audit=0)
    points = study.points()
    assert np.array_equal(points["instrument.tip.radius"], data.tip_radius)
    theirs = json.loads(command("stats", results, "--json").stdout)
    assert afm.stats(data, "amplitude") == theirs["observables"]["amplitude"]
    indices = afm.sobol(data, "phase")
    assert list(indices.parameter.values) == theirs["names"]
    assert list(indices.ST.values) == theirs["observables"]["phase"]["ST"]
    problem = study.salib()
    assert problem["names"] == theirs["names"] and len(problem["bounds"]) == problem["num_vars"] == 3
    assert afm.report(data, page).read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    with pytest.raises(KeyError, match="did you mean 'amplitude'"):
        afm.stats(data, "amplitud")
    with pytest.raises(afm.SceneError, match="correlations contradict"):
        pairs = [
            ("sample.youngs_modulus", "instrument.tip.radius", 0.9),
            ("sample.youngs_modulus", "approach.gap", -0.9),
        ]
        pairs.append(("instrument.tip.radius", "approach.gap", 0.9))
        three = {path: afm.uniform(1e-8, 2e-8) for path in ("instrument.tip.radius", "approach.gap")}
        three["sample.youngs_modulus"] = afm.uniform(1e9, 2e9)
        afm.Design("sobol", samples=8, parameters=three, correlation=pairs)


def test_a_study_with_a_sweep_has_indices_at_each_point(scene):
    study = afm.Design("sobol", samples=64, parameters={"sample.youngs_modulus": afm.uniform("1 GPa", "3 GPa")})
    data = afm.run(scene.set({"sweep": {"approach.gap": {"values": [12e-9, 15e-9]}}}).with_design(study), audit=0)
    indices = afm.sobol(data, "amplitude")
    assert dict(indices.sizes) == {"approach_gap": 2, "parameter": 1} and "approach_gap" in indices.coords
    assert [point["at"]["approach_gap"] for point in afm.stats(data, "amplitude")] == [12e-9, 15e-9]


def test_inference_is_the_commands(scene, tmp_path, command):
    study = afm.Design("sobol", samples=256, parameters={"sample.youngs_modulus": afm.uniform("1 GPa", "3 GPa")})
    results = tmp_path / "study.h5"
    data = afm.run(scene.with_design(study), output=results, audit=0)
    seen = float(data.amplitude[100])
    ours = afm.infer(data, {"amplitude": (seen, "0.05 nm")})
    theirs = command("infer", results, "--json", "--observed", f"amplitude={seen!r} m +- 0.05 nm")
    assert ours == json.loads(theirs.stdout)
    modulus = ours["parameters"]["sample_youngs_modulus"]
    assert modulus["quantiles"]["0.025"] < float(data.sample_youngs_modulus[100]) < modulus["quantiles"]["0.975"]
    with pytest.raises(KeyError, match="did you mean"):
        afm.infer(data, {"amplitud": (seen, 1e-10)})
    with pytest.raises(ValueError) as refused:
        afm.infer(data, {"amplitude": (seen, 1e-10)}, at={"approach.gap": 1e-8})
    assert not OF_SHELL.search(str(refused.value)), refused.value


def test_a_measured_curve_tells_the_modulus(scene):
    study = afm.Design("sobol", samples=256, parameters={"sample.youngs_modulus": afm.uniform("1 GPa", "3 GPa")})
    curve = {"curve": {"quantity": "approach.gap", "from": "20 nm", "to": "12 nm", "points": 9}}
    data = afm.run(scene.set(curve).with_design(study), audit=0)
    one = data.isel(sample=37)
    columns = {
        "gap [m]": data.approach_gap.values,
        "amplitude [m]": one.amplitude.values,
        "amplitude_sd [m]": np.full(9, 2e-10),
    }
    told = afm.infer(data, columns)["parameters"]["sample_youngs_modulus"]
    assert told["mean"] == pytest.approx(float(one.sample_youngs_modulus), abs=3 * told["sd"])


def told(scene, **options):
    """The warnings of a run."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        afm.run(scene, audit=0, **options)
    return [str(one.message) for one in caught if one.category is afm.SceneWarning]


@pytest.mark.parametrize(
    ("nickname", "path"),
    [
        ("Q", "instrument.cantilever.quality_factor"),
        ("k", "instrument.cantilever.stiffness"),
        ("tip.radius", "instrument.tip.radius"),
        ("sample.E", "sample.youngs_modulus"),
        ("gap", "approach.gap"),
    ],
)
def test_usual_names_are_understood(scene, nickname, path):
    for call in (lambda: scene.set({nickname: 3.0}), lambda: afm.run(scene, samples={nickname: [3.0]})):
        with pytest.raises(KeyError, match=f"did you mean '{re.escape(path)}'"):
            call()


def test_usual_names_of_observables_are_understood(scene):
    with pytest.raises(KeyError, match="did you mean 'force_max'"):
        afm.stats(afm.run(scene, audit=0), "peak force")


def test_a_dictionary_has_keys_in_place_of_lines(scene, tmp_path):
    odd = scene.set({"sample.youngs_modulus": 1e13})
    (line,) = (one for one in told(odd) if "usual" in one)
    assert line.startswith("sample.youngs_modulus = 10 TPa")
    assert line in odd.plan()["warnings"]
    with pytest.raises(afm.SceneError, match=r"--> sample.poisson_ratio\n"):
        afm.run(scene.set({"sample.poisson_ratio": 0.7}))
    with pytest.raises(afm.SceneError, match=r"--> uncertain.instrument.tip.radius\n"):
        afm.Design("sobol", samples=4, parameters={"instrument.tip.radius": afm.uniform(9e-9, 5e-9)})
    with pytest.raises(afm.SceneError, match=r"--> samples\n"):
        afm.run(scene, samples={"instrument.tip.radius": [-1.0]})
    # A text and a file have lines; a changed one has them no more.
    file = tmp_path / "odd.toml"
    file.write_text(odd.text, encoding="utf-8")
    assert any("odd.toml:" in one for one in told(file)) and any("text:" in one for one in told(odd.text))
    assert not any("odd.toml:" in one for one in told(afm.Scene(file).set({"approach.gap": 1.4e-8})))


def test_messages_have_few_digits(scene):
    cone = {"instrument.tip": {"shape": "cone", "half_angle": float(np.radians(20)), "youngs_modulus": "inf Pa"}}
    lines = told(scene.set({**cone, "contact.law": "hertz", "sample": {"youngs_modulus": 2.5e9}}))
    assert any("half_angle = 0.349066 degree" in one and "not in radians" in one for one in lines), lines
    assert any("the sample has 2.5 GPa" in one for one in lines), lines


def test_words_of_python_stand_in_messages_on_distributions(scene):
    def study(**wide):
        uncertain = {"instrument.cantilever.stiffness": afm.normal("10 N/m", **wide)}
        return scene.with_design(afm.Design("sobol", samples=16, parameters=uncertain))

    assert any("low= or high=" in one for one in told(study(sd="30 %")))
    with pytest.raises(afm.SceneError, match="larger than its mean, 10 N/m: a share is written"):
        afm.run(study(sd=12.0))
    assert any("larger than its mean" in one for one in told(study(sd=12.0, low="1 N/m")))


def test_the_presets_gap_is_told(scene):
    assert any("approach.gap = 300 pm" in one for one in told(scene.set({"approach.gap": None})))
    assert not any("preset" in one for one in told(scene))


def test_a_page_needs_a_results_file(scene):
    with pytest.raises(ValueError, match="output="):
        afm.report(afm.run(scene, audit=0))
    with pytest.raises(ValueError, match="output="):
        afm.report(afm.run_tree(scene, audit=0))


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
def test_a_page_of_results_in_memory_is_that_of_the_file(scene, tmp_path, engine):
    swept = scene.set({"sweep": {"approach.gap": {"from": "10 nm", "to": "18 nm", "points": 5}}})
    whole = afm.run_tree(swept, audit=2)
    afm.run(swept, audit=2, output=tmp_path / "results.h5")
    with xr.set_options(netcdf_engine_order=[engine, "h5netcdf", "netcdf4", "scipy"]):
        ours = afm.report(whole, tmp_path / "ours")
    theirs = afm.report(tmp_path / "results.h5", tmp_path / "theirs")
    assert "checksums" in whole.attrs
    names = sorted(path.name for path in theirs.parent.iterdir())
    assert names == sorted(path.name for path in ours.parent.iterdir()) and "amplitude.svg" in names
    for name in names:
        if name.endswith((".csv", ".svg")):
            assert (ours.parent / name).read_bytes() == (theirs.parent / name).read_bytes(), name


def test_few_rows_are_doubted(scene):
    def study(samples):
        one = {"sample.youngs_modulus": afm.uniform("1 GPa", "3 GPa")}
        return afm.run(scene.with_design(afm.Design("monte-carlo", samples=samples, parameters=one)), audit=0)

    few, many = study(16), study(256)
    with pytest.warns(afm.SceneWarning, match="256 rows or more") as caught:
        indices = afm.sobol(few, "amplitude")
    assert caught[0].filename == __file__
    assert abs(1 - indices.S1[0]) <= indices.S1_conf[0]
    with warnings.catch_warnings():
        warnings.simplefilter("error", afm.SceneWarning)
        assert float(afm.sobol(many, "amplitude").S1_conf[0]) < 0.2
